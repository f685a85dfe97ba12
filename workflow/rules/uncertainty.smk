from mesoscale.uncertainty.chunks import chunk_bounds, default_readings

DIRECT_CHUNKS = chunk_bounds(SCENE.uncertainty.direct_runs, SCENE.uncertainty.chunk_runs)


rule uq:
    input:
        f"{RESULTS}/uq/outputs.csv",
        f"{RESULTS}/uq/surrogate.json",
        f"{RESULTS}/uq/validation.csv",


rule sensitivity:
    input:
        f"{RESULTS}/uq/sensitivity.csv",


rule compute_direct_runs:
    message:
        "compute direct contact cycles, chunk {wildcards.chunk}" + f" of {len(DIRECT_CHUNKS)}"
    input:
        inputs=f"{RESULTS}/inputs.csv",
    output:
        f"{RESULTS}/uq/direct/chunk_{{chunk}}.csv",
    log:
        f"{RESULTS}/logs/compute_direct_runs_{{chunk}}.log",
    params:
        contact=settings("contact"),
        law=settings("law"),
        uncertainty=RUN_SETTINGS,
        bounds=lambda wildcards: DIRECT_CHUNKS[wildcards.chunk],
    threads: 1
    script:
        "../scripts/compute_direct_runs.py"


rule propagate_uncertainty:
    message:
        "propagate the uncertainty of the inputs"
    input:
        inputs=f"{RESULTS}/inputs.csv",
        parameters=f"{RESULTS}/law/parameters.csv",
        direct=[f"{RESULTS}/uq/direct/chunk_{chunk}.csv" for chunk in DIRECT_CHUNKS],
        table1=str(CONFIG / "paper" / "table1.csv"),
        table2=str(CONFIG / "paper" / "table2.csv"),
    output:
        outputs=f"{RESULTS}/uq/outputs.csv",
        surrogate=f"{RESULTS}/uq/surrogate.json",
        samples=f"{RESULTS}/uq/samples.csv",
        validation=f"{RESULTS}/uq/validation.csv",
    log:
        f"{RESULTS}/logs/propagate_uncertainty.log",
    params:
        settings=settings("uncertainty"),
        law=settings("law"),
    script:
        "../scripts/propagate_uncertainty.py"


rule rank_sensitivity:
    message:
        "rank the inputs by sensitivity"
    input:
        inputs=f"{RESULTS}/inputs.csv",
        parameters=f"{RESULTS}/law/parameters.csv",
        outputs=f"{RESULTS}/uq/outputs.csv",
        direct=[f"{RESULTS}/uq/direct/chunk_{chunk}.csv" for chunk in DIRECT_CHUNKS],
        table3=str(CONFIG / "paper" / "table3.csv"),
    output:
        f"{RESULTS}/uq/sensitivity.csv",
    log:
        f"{RESULTS}/logs/rank_sensitivity.log",
    params:
        settings=settings("uncertainty"),
    script:
        "../scripts/rank_sensitivity.py"


rule audit:
    input:
        f"{RESULTS}/audit/ranking.csv",


rule compute_audit:
    message:
        "audit reading {wildcards.reading}, surface {wildcards.seed}"
    input:
        inputs=f"{RESULTS}/inputs.csv",
    output:
        f"{RESULTS}/audit/runs/{{reading}}_{{seed}}.csv",
    log:
        f"{RESULTS}/logs/compute_audit_{{reading}}_{{seed}}.log",
    params:
        contact=settings("contact"),
        law=settings("law"),
        uncertainty={**RUN_SETTINGS, "surrogate": "level1"},
    wildcard_constraints:
        seed=r"\d+",
    script:
        "../scripts/compute_audit.py"


rule rank_readings:
    message:
        "rank the readings by their distance to the paper's tables"
    input:
        inputs=f"{RESULTS}/inputs.csv",
        table2=str(CONFIG / "paper" / "table2.csv"),
        table3=str(CONFIG / "paper" / "table3.csv"),
        runs=[
            f"{RESULTS}/audit/runs/{reading}_{seed}.csv"
            for reading in SCENE.uncertainty.audit_readings or default_readings()
            for seed in range(SCENE.uncertainty.audit_seeds)
        ],
    output:
        f"{RESULTS}/audit/ranking.csv",
    log:
        f"{RESULTS}/logs/rank_readings.log",
    params:
        central_share=SCENE.uncertainty.central_share,
    script:
        "../scripts/rank_readings.py"
