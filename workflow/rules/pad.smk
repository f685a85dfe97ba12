from mesoscale.settings.pad import PILOTS, POINTS_PER_JOB
from mesoscale.uncertainty.chunks import chunk_bounds

# number 0 is the point at central inputs
POINT_CHUNKS = {"central": (0, 1)} | {
    name: (first + 1, last + 1)
    for name, (first, last) in chunk_bounds(SCENE.pad.points, POINTS_PER_JOB[SCENE.contact.mechanics]).items()
}


rule pad:
    input:
        in_tail("pad", f"{RESULTS}/pad/model.h5"),


rule device:
    input:
        in_tail("pad", f"{RESULTS}/device/pad_switch.json"),


rule collect_pad_inputs:
    input:
        **SURFACE,
        inputs=f"{RESULTS}/inputs.csv",
    output:
        f"{RESULTS}/pad/inputs.csv",
    log:
        f"{RESULTS}/logs/collect_pad_inputs.log",
    priority: 2
    params:
        rms_scatter=settings("pad")["rms_scatter"],
    message:
        "collect the uncertain inputs of the pad, which holds all places of the film"
    script:
        "../scripts/collect_pad_inputs.py"


rule press_pads:
    input:
        **SURFACE,
        inputs=f"{RESULTS}/pad/inputs.csv",
    output:
        f"{RESULTS}/pad/points/chunk_{{chunk}}.h5",
    log:
        f"{RESULTS}/logs/press_pads_{{chunk}}.log",
    priority: 2  # first of all: the rest then fills the other cores while the pad is assembled
    threads: 1
    resources:
        mem_mb=contact_MB(SCENE.contact, PILOTS),
    params:
        contact=settings("contact"),
        device=settings("device"),
        pad=settings("pad"),
        bounds=lambda wildcards: POINT_CHUNKS[wildcards.chunk],
    message:
        f"press pads and solve the switch on them, chunk {{wildcards.chunk}} of {len(POINT_CHUNKS) - 1} and central"
    script:
        "../scripts/press_pads.py"


rule assemble_pad:
    input:
        **SURFACE,
        inputs=f"{RESULTS}/pad/inputs.csv",
        chunks=[f"{RESULTS}/pad/points/chunk_{chunk}.h5" for chunk in POINT_CHUNKS],
    output:
        model=f"{RESULTS}/pad/model.h5",
        table=f"{RESULTS}/pad/curves.csv",
        switch=f"{RESULTS}/device/pad_switch.json",
        verilog=f"{RESULTS}/device/rough_pad.va",
        spice=f"{RESULTS}/device/rough_pad.sub",
    log:
        f"{RESULTS}/logs/assemble_pad.log",
    priority: 2
    threads: 1
    params:
        contact=settings("contact"),
        device=settings("device"),
        pad=settings("pad"),
    message:
        "assemble the pad, and say what the switch does"
    script:
        "../scripts/assemble_pad.py"


rule measure_pad_accuracy:
    input:
        **SURFACE,
        inputs=f"{RESULTS}/pad/inputs.csv",
        model=f"{RESULTS}/pad/model.h5",
    output:
        f"{RESULTS}/accuracy/pad.csv",
    log:
        f"{RESULTS}/logs/measure_pad_accuracy.log",
    threads: 1
    resources:
        mem_mb=contact_MB(SCENE.contact, PILOTS),
    params:
        contact=settings("contact"),
        device=settings("device"),
        pad=settings("pad"),
    message:
        "study the error of the release on the pad against run time"
    script:
        "../scripts/measure_pad_accuracy.py"


if "pad" in SCENE.tails:
    ACCURACY.append(f"{RESULTS}/accuracy/pad.csv")
