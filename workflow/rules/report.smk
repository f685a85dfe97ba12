from workflow.checksums import file_checksum


def report_inputs():
    """Result files of exactly the stages that the scene needs; each has its section in the page."""
    files = ["scene.yaml", "inputs.csv", "curves/nominal.h5", "curves/spots.h5"]
    if "law" in SCENE.tails:
        files += ["law/parameters.csv", "law/wells.csv", "law/nominal.csv"]
        names = ("outputs.csv", "samples.csv", "surrogate.json", "validation.csv", "sensitivity.csv", "law.csv")
        files += [f"uq/{name}" for name in names]
    if "pad" in SCENE.tails:
        files += ["pad/inputs.csv", "pad/curves.csv", "device/pad_switch.json"]
    if needed("hardness"):
        files += ["hardness/points.csv", "hardness/fit.json"]
        files += [f"hardness/{part}/{run}.csv" for part in ("closing", "witness") for run in CLOSINGS]
    if needed("elastic"):
        files += [f"elastic/{name}" for name in ("points.csv", "bulk_moduli.csv", "e_star.json", "e_star.h5")]
    if needed("topography"):
        files += ["topography/spectra.h5", "topography/parameters.json"]
        files += [str(Path(path).relative_to(RESULTS)) for path in JUDGED]
    if SCENE.failure.probability is not None and "pad" in SCENE.tails:
        files += ["device/failure.json", "device/failure.csv"]
        files += [f"device/{name}" for name in ("circuit.json", "circuit.csv", "loop.csv")]
    if SCENE.resistance.resistivities_nOhm_m is not None:
        files += ["device/resistance.csv"]
    if SCENE.history.cycles > 0:
        files += [f"history/{name}" for name in ("cycles.csv", "dwell.csv", "curves.h5")]
    if SCENE.measurements.tables:
        files += [f"calibration/{name}" for name in ("posterior.json", "samples.csv", "summary.csv", "predictive.csv")]
    studies = [*ACCURACY, *STABILITY] if SCENE.report.studies else []
    return [f"{RESULTS}/{name}" for name in files] + studies


def kept_files():
    """What jobs of the scene leave beside the files of the report."""
    parts, files = [], []
    if "law" in SCENE.tails:
        parts += [rules.fit_law, rules.fit_nominal_law, rules.propagate_uncertainty]
        files += DIRECT
    if "pad" in SCENE.tails:
        parts += [rules.assemble_pad]
    if needed("hardness"):
        parts += [rules.fit_hardness]
        files += expand(rules.make_glass.output, glass=SCENE.hardness.seeds)
        files += expand(rules.run_closing.output, run=CLOSINGS)
    if needed("elastic"):
        parts += [rules.combine_e_star]
        files += expand([*rules.make_amorphous.output, *rules.scan_glass.output], amorphous=GLASSES)
    if needed("topography"):
        parts += [rules.pool_spectra] if TOPOGRAPHY.scans else [rules.write_synthetic_scans, rules.pool_spectra]
    files += [file for part in parts for file in (*part.input, *part.output)]
    return sorted({file for file in files if file.startswith(RESULTS)})


def studies_at_hand():
    """Tables of studies already present, with their checksums.

    As parameters, not inputs: they are shown without being scheduled, and a new one renews the page.
    """
    found = [] if SCENE.report.studies else [*ACCURACY, *STABILITY]
    return {name: file_checksum(name) for name in found if Path(name).is_file()}


def page_parts():
    """What the page is made of beside results."""
    room = ROOT / "workflow" / "report"
    return [str(room / name) for name in ("template.html.j2", "style.css")]


rule report:
    input:
        f"{RESULTS}/report.html",


rule render_report:
    input:
        report_inputs(),
        style=page_parts(),
    output:
        f"{RESULTS}/report.html",
    log:
        f"{RESULTS}/logs/render_report.log",
    params:
        root=RESULTS,
        scene=SCENE.name,
        studies=lambda wildcards: studies_at_hand(),
    message:
        "write the report"
    script:
        "../scripts/render_report.py"
