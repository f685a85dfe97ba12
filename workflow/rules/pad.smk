from mesoscale.device.pressing import pressing
from mesoscale.settings.pad import CELLS_PER_JOB, DRAWS_PER_JOB
from mesoscale.uncertainty.chunks import chunk_bounds

CELL_CHUNKS = chunk_bounds(SCENE.pad.cells, CELLS_PER_JOB[SCENE.contact.mechanics])
DRAW_CHUNKS = chunk_bounds(SCENE.pad.draws, DRAWS_PER_JOB)
PAD_GRID = SCENE.pad.piloted(SCENE.unequal_places)
DRAW_DESIGN = (SCENE.pad.draws, SCENE.pad.draw_cells)


rule pad:
    input:
        f"{RESULTS}/pad/curves.h5",
        f"{RESULTS}/device/pad_switch.json",


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


rule plan_pad:
    input:
        **SURFACE,
        inputs=f"{RESULTS}/pad/inputs.csv",
    output:
        f"{RESULTS}/pad/grid.csv",
    log:
        f"{RESULTS}/logs/plan_pad.log",
    priority: 2  # first of all: the rest then fills the other cores while the pad is assembled
    threads: 1
    resources:
        mem_mb=contact_MB(SCENE.contact, PAD_GRID.pilot_cells),
    params:
        contact=settings("contact"),
        grid=PAD_GRID.model_dump(mode="json"),
        device=pressing(SCENE.device).model_dump(mode="json"),
    message:
        "choose the separations that the cells of the pad share"
    script:
        "../scripts/plan_pad.py"


rule close_cells:
    input:
        **SURFACE,
        inputs=f"{RESULTS}/pad/inputs.csv",
        grid=f"{RESULTS}/pad/grid.csv",
    output:
        f"{RESULTS}/pad/cells/chunk_{{chunk}}.h5",
    log:
        f"{RESULTS}/logs/close_cells_{{chunk}}.log",
    priority: 2
    threads: 1
    resources:
        mem_mb=CONTACT_MB,
    params:
        contact=settings("contact"),
        bounds=lambda wildcards: CELL_CHUNKS[wildcards.chunk],
    message:
        f"close and open the cells of the pad, chunk {{wildcards.chunk}} of {len(CELL_CHUNKS)}"
    script:
        "../scripts/close_cells.py"


rule close_draws:
    input:
        **SURFACE,
        inputs=f"{RESULTS}/pad/inputs.csv",
    output:
        f"{RESULTS}/pad/draws/chunk_{{chunk}}.csv",
    log:
        f"{RESULTS}/logs/close_draws_{{chunk}}.log",
    priority: 2
    threads: 1
    resources:
        mem_mb=CONTACT_MB,
    params:
        contact=settings("contact"),
        design=DRAW_DESIGN,
        device=pressing(SCENE.device, spread=True).model_dump(mode="json"),
        bounds=lambda wildcards: DRAW_CHUNKS[wildcards.chunk],
    message:
        f"close and open pads at other inputs, chunk {{wildcards.chunk}} of {len(DRAW_CHUNKS)}"
    script:
        "../scripts/close_draws.py"


rule assemble_pad:
    input:
        **SURFACE,
        inputs=f"{RESULTS}/pad/inputs.csv",
        grid=f"{RESULTS}/pad/grid.csv",
        chunks=[f"{RESULTS}/pad/cells/chunk_{chunk}.h5" for chunk in CELL_CHUNKS],
        draws=[f"{RESULTS}/pad/draws/chunk_{chunk}.csv" for chunk in DRAW_CHUNKS],
    output:
        curves=f"{RESULTS}/pad/curves.h5",
        table=f"{RESULTS}/pad/curves.csv",
        adhesion=f"{RESULTS}/pad/adhesion.csv",
        compact=f"{RESULTS}/pad/compact.json",
        switch=f"{RESULTS}/device/pad_switch.json",
        verilog=f"{RESULTS}/device/rough_pad.va",
        spice=f"{RESULTS}/device/rough_pad.sub",
    log:
        f"{RESULTS}/logs/assemble_pad.log",
    priority: 2
    threads: 2  # its switches are solved side by side
    params:
        contact=settings("contact"),
        design=DRAW_DESIGN,
        device=settings("device"),
    message:
        "assemble the pad and drive the switch with it"
    script:
        "../scripts/assemble_pad.py"


rule measure_pad_accuracy:
    input:
        **SURFACE,
        inputs=f"{RESULTS}/pad/inputs.csv",
        grid=f"{RESULTS}/pad/grid.csv",
        chunks=[f"{RESULTS}/pad/cells/chunk_{chunk}.h5" for chunk in CELL_CHUNKS],
    output:
        f"{RESULTS}/accuracy/pad.csv",
    log:
        f"{RESULTS}/logs/measure_pad_accuracy.log",
    threads: 1
    resources:
        mem_mb=CONTACT_MB,
    params:
        contact=settings("contact"),
        device=settings("device"),
    message:
        "study the error of the release on the pad against run time"
    script:
        "../scripts/measure_pad_accuracy.py"


ACCURACY.append(f"{RESULTS}/accuracy/pad.csv")
