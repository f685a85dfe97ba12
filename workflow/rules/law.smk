from mesoscale.uncertainty.chunks import chunk_bounds, collocation_run_count

RUN_CHUNKS = chunk_bounds(collocation_run_count(len(SCENE.inputs.rows()), SCENE.uncertainty))


rule law:
    input:
        in_tail("law", f"{RESULTS}/law/parameters.csv", f"{RESULTS}/law/wells.csv", f"{RESULTS}/law/nominal.csv"),


rule compute_runs:
    input:
        **SURFACE,
        inputs=f"{RESULTS}/inputs.csv",
    output:
        f"{RESULTS}/curves/runs/chunk_{{chunk}}.h5",
    log:
        f"{RESULTS}/logs/compute_runs_{{chunk}}.log",
    priority: 1  # a chain of jobs waits for them
    threads: 1
    resources:
        mem_mb=CONTACT_MB,
    params:
        contact=settings("contact"),
        bounds=lambda wildcards: RUN_CHUNKS[wildcards.chunk],
    message:
        f"compute contact cycles, chunk {{wildcards.chunk}} of {len(RUN_CHUNKS)}"
    script:
        "../scripts/compute_runs.py"


rule fit_law:
    input:
        inputs=f"{RESULTS}/inputs.csv",
        chunks=[f"{RESULTS}/curves/runs/chunk_{chunk}.h5" for chunk in RUN_CHUNKS],
    output:
        parameters=f"{RESULTS}/law/parameters.csv",
        wells=f"{RESULTS}/law/wells.csv",
    log:
        f"{RESULTS}/logs/fit_law.log",
    threads: 1
    message:
        "fit the force-separation law"
    script:
        "../scripts/fit_law.py"


rule fit_nominal_law:
    input:
        nominal=f"{RESULTS}/curves/nominal.h5",
    output:
        f"{RESULTS}/law/nominal.csv",
    log:
        f"{RESULTS}/logs/fit_nominal_law.log",
    message:
        "fit the law to the nominal curves"
    script:
        "../scripts/fit_nominal_law.py"
