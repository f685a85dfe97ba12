from mesoscale.uncertainty.chunks import chunk_bounds, collocation_run_count

RUN_CHUNKS = chunk_bounds(collocation_run_count(len(SCENE.inputs.rows()), SCENE.uncertainty))


rule compute_runs:
    input:
        **SURFACE,
        inputs=f"{RESULTS}/inputs.csv",
    output:
        f"{RESULTS}/law/runs/chunk_{{chunk}}.h5",
    log:
        f"{RESULTS}/logs/compute_runs_{{chunk}}.log",
    priority: 1  # a chain of jobs waits for them
    resources:
        mem_mb=CONTACT_MB,
    params:
        contact=settings("contact"),
        bounds=lambda wildcards: RUN_CHUNKS[wildcards.chunk],
    message:
        f"compute contact cycles, chunk {{wildcards.chunk}} of {len(RUN_CHUNKS)}"
    script:
        "../scripts/compute_runs.py"


rule law:
    """compact law of one cell"""
    input:
        inputs=f"{RESULTS}/inputs.csv",
        chunks=[f"{RESULTS}/law/runs/chunk_{chunk}.h5" for chunk in RUN_CHUNKS],
        nominal=f"{RESULTS}/contact/nominal.h5",
    output:
        parameters=captioned(f"{RESULTS}/law/parameters.csv"),
        nominal=f"{RESULTS}/law/nominal.csv",
    log:
        f"{RESULTS}/logs/law.log",
    message:
        "fit the force-separation law"
    script:
        "../scripts/fit_law.py"


if "law" in SCENE.tails:
    SHOWN += rules.law.output
    KEPT += rules.law.input.chunks
