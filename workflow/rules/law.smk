from mesoscale.uncertainty.chunks import chunk_bounds, collocation_run_count

RUN_CHUNKS = chunk_bounds(
    collocation_run_count(len(SCENE.inputs.rows()), SCENE.uncertainty), SCENE.uncertainty.chunk_runs
)
# what a chunk of runs depends on: not on how many chunks there are, so that adding runs keeps the old ones
RUN_SETTINGS = {
    key: settings("uncertainty")[key] for key in ("surrogate", "first_seed", "central_share", "sample_seed")
}


rule law:
    input:
        f"{RESULTS}/law/parameters.csv",
        f"{RESULTS}/law/wells.csv",
        f"{RESULTS}/law/nominal.csv",


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
        uncertainty=RUN_SETTINGS,
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
        parameters=report(f"{RESULTS}/law/parameters.csv", caption="../captions/law.rst", category="Law"),
        wells=f"{RESULTS}/law/wells.csv",
    log:
        f"{RESULTS}/logs/fit_law.log",
    threads: 1
    params:
        settings=settings("law"),
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
    params:
        settings=settings("law"),
    message:
        "fit the law to the nominal curves"
    script:
        "../scripts/fit_nominal_law.py"
