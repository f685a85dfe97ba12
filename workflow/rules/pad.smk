from mesoscale.settings.pad import PILOTS, POINTS_PER_JOB
from mesoscale.uncertainty.chunks import chunk_bounds

# number 0 is the point at central inputs
POINT_CHUNKS = {"central": (0, 1)} | {
    name: (first + 1, last + 1)
    for name, (first, last) in chunk_bounds(
        SCENE.pad.points, POINTS_PER_JOB[SCENE.contact.mechanics]
    ).items()
}
ALL_CHUNKS = "central"
if SCENE.pad.points:
    ALL_CHUNKS += f", 000 to {len(POINT_CHUNKS) - 2:03}"


# the posterior of a measured device, made once
MEASURED = {"measured": f"{RESULTS}/pad/measured.h5"} if SCENE.device.measured else {}
# what jobs that use the pad read, and the settings that they have
PRESSED = {
    **SURFACE,
    **MEASURED,
    "inputs": f"{RESULTS}/inputs.csv",
    "model": f"{RESULTS}/pad/model.h5",
}
ON_PADS = {section: settings(section) for section in ("contact", "device", "pad")}
if SPREAD_FILES:
    ON_PADS["departures"] = contents(*SPREAD_FILES)


if MEASURED:

    rule narrow_device:
        output:
            MEASURED["measured"],
        log:
            f"{RESULTS}/logs/narrow_device.log",
        priority: 3
        params:
            **{name: of for name, of in ON_PADS.items() if name in ("device", "departures")},
        message:
            "narrow the device by what was measured"
        script:
            "../scripts/narrow_device.py"


rule press_pads:
    input:
        **SURFACE,
        **MEASURED,
        inputs=f"{RESULTS}/inputs.csv",
    output:
        f"{RESULTS}/pad/points/chunk_{{chunk}}.h5",
    log:
        f"{RESULTS}/logs/press_pads_{{chunk}}.log",
    # first of all: the rest then fills the other cores while the pad is assembled;
    # the central point has the first answer
    priority: lambda wildcards: 3 if wildcards.chunk == "central" else 2
    resources:
        mem_mb=contact_MB(SCENE.contact, PILOTS),
    params:
        **ON_PADS,
        bounds=lambda wildcards: POINT_CHUNKS[wildcards.chunk],
    message:
        f"press pads {{wildcards.chunk}} ({ALL_CHUNKS})"
    script:
        "../scripts/press_pads.py"


rule pad:
    """pads at points of all that is uncertain"""
    input:
        **SURFACE,
        **MEASURED,
        inputs=f"{RESULTS}/inputs.csv",
        chunks=[f"{RESULTS}/pad/points/chunk_{chunk}.h5" for chunk in POINT_CHUNKS],
    output:
        model=f"{RESULTS}/pad/model.h5",
        inputs=f"{RESULTS}/pad/inputs.csv",
        table=f"{RESULTS}/pad/curves.csv",
    log:
        f"{RESULTS}/logs/pad.log",
    priority: 2
    params:
        **ON_PADS,
    message:
        "assemble the pad"
    script:
        "../scripts/assemble_pad.py"


if "switch" in SCENE.tails:
    SHOWN += rules.pad.output
    SHOWN += MEASURED.values()
    KEPT += rules.pad.input.chunks
