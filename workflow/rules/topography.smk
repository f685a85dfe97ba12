# AFM scans → spectra → q0, Hurst exponent and RMS with ranges (docs/topography.md)

TOPOGRAPHY = SCENE.topography
SCAN_FOLDER = f"{RESULTS}/topography/scans"


SCAN_FILES = (
    scan_files() if needed("topography") or not TOPOGRAPHY.scans else list(TOPOGRAPHY.scans)
)
SCANS_PER_JOB = 6  # a start takes as long as the analysis of two
SCAN_CHUNKS = [SCAN_FILES[k : k + SCANS_PER_JOB] for k in range(0, len(SCAN_FILES), SCANS_PER_JOB)]

# what jobs that make random surfaces need where the surface is measured: its description
SURFACE = (
    {"topography": f"{RESULTS}/topography/parameters.json"}
    if "topography" in SCENE.inputs.origins()
    else {}
)


# measured scans judge their description by pressing, where the contact uses it
JUDGED = [f"{RESULTS}/topography/judged.csv"] if TOPOGRAPHY.scans and SURFACE else []


if not TOPOGRAPHY.scans:

    rule write_synthetic_scans:
        output:
            scans=SCAN_FILES,
            truth=f"{RESULTS}/topography/truth.json",
        log:
            f"{RESULTS}/logs/write_synthetic_scans.log",
        params:
            settings=settings("topography")["synthetic"],
        message:
            "write synthetic AFM scans with known truth"
        script:
            "../scripts/write_synthetic_scans.py"


rule analyse_scans:
    input:
        scans=lambda wildcards: SCAN_CHUNKS[int(wildcards.chunk)],
    output:
        f"{RESULTS}/topography/spectra/chunk_{{chunk}}.h5",
    log:
        f"{RESULTS}/logs/analyse_scans_{{chunk}}.log",
    params:
        contents=lambda wildcards: contents(*measured(*SCAN_CHUNKS[int(wildcards.chunk)])),
        settings=settings("topography"),
        first=lambda wildcards: int(wildcards.chunk) * SCANS_PER_JOB,
    message:
        "read AFM scans and compute their spectra (part {wildcards.chunk})"
    script:
        "../scripts/analyse_scans.py"


rule pool_spectra:
    input:
        chunks=expand(
            f"{RESULTS}/topography/spectra/chunk_{{chunk}}.h5",
            chunk=[f"{k:03d}" for k in range(len(SCAN_CHUNKS))],
        ),
        truth=[] if TOPOGRAPHY.scans else f"{RESULTS}/topography/truth.json",
    output:
        spectra=f"{RESULTS}/topography/spectra.h5",
        parameters=f"{RESULTS}/topography/parameters.json",
    log:
        f"{RESULTS}/logs/pool_spectra.log",
    params:
        settings=settings("topography"),
        cell_nm=None if SCENE.cell_follows_film else SCENE.contact.length_nm,
        electrode_nm=1000 * SCENE.device.area_um2**0.5 if SCENE.cell_follows_film else None,
        cut_off=SCENE.inputs.prior_origins().get("q1") == "topography",
        pixels=SCENE.contact.pixels,
    message:
        "describe the surface behind the spectra"
    script:
        "../scripts/pool_spectra.py"


rule topography:
    """what the measurements show, and the surface behind them"""
    input:
        JUDGED,
        rules.pool_spectra.output,


rule judge_scans:
    input:
        chunks=rules.pool_spectra.input.chunks,
        scans=SCAN_FILES,
        parameters=f"{RESULTS}/topography/parameters.json",
        inputs=f"{RESULTS}/inputs.csv",
    output:
        f"{RESULTS}/topography/judged.csv",
    log:
        f"{RESULTS}/logs/judge_scans.log",
    params:
        contents=lambda wildcards: contents(*measured(*SCAN_FILES)),
        settings=settings("topography"),
        contact=settings("contact"),
    message:
        "press the scans beside surfaces made from the others' description"
    script:
        "../scripts/judge_scans.py"


if needed("topography"):
    SHOWN += [*JUDGED, *rules.pool_spectra.output]
    KEPT += rules.pool_spectra.input.chunks
    KEPT += [] if TOPOGRAPHY.scans else rules.write_synthetic_scans.output
