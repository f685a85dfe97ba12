from mesoscale.uncertainty.chunks import chunk_bounds

CELL_CHUNKS = chunk_bounds(SCENE.pad.cells, SCENE.pad.chunk_cells)
# what a chunk of cells depends on: not on how many chunks there are, so that adding cells keeps the old ones
GRID_SETTINGS = {
    key: value
    for key, value in settings("pad").items()
    if key in ("pilot_cells", "max_pressure_MPa", "step_nm", "depths", "first_seed")
}
# which of the switch's settings say how hard it presses; none where the scene says it
GRID_DEVICE = {
    key: value
    for key, value in settings("device").items()
    if SCENE.pad.max_pressure_MPa is None
    and key not in ("bow_deviation_nm", "tilt_nm", "tilt_deviation_nm", "adhesion_scale", "samples")
}
DRAW_CHUNKS = chunk_bounds(SCENE.pad.draws, SCENE.pad.chunk_draws)
DRAW_SETTINGS = {key: settings("pad")[key] for key in ("draws", "draw_cells", "gap_cutoff_high_nm", "first_seed")}


rule pad:
    input:
        f"{RESULTS}/pad/curves.h5",
        f"{RESULTS}/device/pad_switch.json",


rule plan_pad:
    input:
        **SURFACE,
        inputs=f"{RESULTS}/inputs.csv",
    output:
        f"{RESULTS}/pad/grid.csv",
    log:
        f"{RESULTS}/logs/plan_pad.log",
    priority: 2  # first of all: the rest then fills the other cores while the pad is assembled
    threads: 1
    resources:
        mem_mb=contact_MB(SCENE.contact, SCENE.pad.pilot_cells),
    params:
        contact=settings("contact"),
        pad=GRID_SETTINGS,
        device=GRID_DEVICE,
    message:
        "choose the separations that the cells of the pad share"
    script:
        "../scripts/plan_pad.py"


rule close_cells:
    input:
        **SURFACE,
        inputs=f"{RESULTS}/inputs.csv",
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
        seeds=lambda wildcards: [SCENE.pad.first_seed + run for run in CELL_CHUNKS[wildcards.chunk]],
    message:
        f"close and open the cells of the pad, chunk {{wildcards.chunk}} of {len(CELL_CHUNKS)}"
    script:
        "../scripts/close_cells.py"


rule close_draws:
    input:
        **SURFACE,
        inputs=f"{RESULTS}/inputs.csv",
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
        pad=DRAW_SETTINGS,
        device=settings("device"),
        bounds=lambda wildcards: DRAW_CHUNKS[wildcards.chunk],
    message:
        f"close and open pads at other inputs, chunk {{wildcards.chunk}} of {len(DRAW_CHUNKS)}"
    script:
        "../scripts/close_draws.py"


rule assemble_pad:
    input:
        **SURFACE,
        inputs=f"{RESULTS}/inputs.csv",
        grid=f"{RESULTS}/pad/grid.csv",
        chunks=[f"{RESULTS}/pad/cells/chunk_{chunk}.h5" for chunk in CELL_CHUNKS],
        draws=[f"{RESULTS}/pad/draws/chunk_{chunk}.csv" for chunk in DRAW_CHUNKS],
    output:
        curves=f"{RESULTS}/pad/curves.h5",
        table=f"{RESULTS}/pad/curves.csv",
        adhesion=f"{RESULTS}/pad/adhesion.csv",
        tail=f"{RESULTS}/pad/tail.json",
        compact=f"{RESULTS}/pad/compact.json",
        switch=f"{RESULTS}/device/pad_switch.json",
        verilog=f"{RESULTS}/device/rough_pad.va",
        spice=f"{RESULTS}/device/rough_pad.sub",
    log:
        f"{RESULTS}/logs/assemble_pad.log",
    priority: 2
    threads: 1
    params:
        contact=settings("contact"),
        pad=DRAW_SETTINGS,
        device=settings("device"),
    message:
        "assemble the pad and drive the switch with it"
    script:
        "../scripts/assemble_pad.py"


rule measure_pad_accuracy:
    input:
        **SURFACE,
        inputs=f"{RESULTS}/inputs.csv",
        grid=f"{RESULTS}/pad/grid.csv",
        chunks=[f"{RESULTS}/pad/cells/chunk_{chunk}.h5" for chunk in CELL_CHUNKS],
        draws=[f"{RESULTS}/pad/draws/chunk_{chunk}.csv" for chunk in DRAW_CHUNKS],
    output:
        f"{RESULTS}/accuracy/pad.csv",
    log:
        f"{RESULTS}/logs/measure_pad_accuracy.log",
    threads: 1
    resources:
        mem_mb=CONTACT_MB,
    params:
        contact=settings("contact"),
        pad=DRAW_SETTINGS,
        device=settings("device"),
        cells=SCENE.pad.cells,
    message:
        "study the error of the release on the pad against run time"
    script:
        "../scripts/measure_pad_accuracy.py"


ACCURACY.append(f"{RESULTS}/accuracy/pad.csv")
