from mesoscale.uncertainty.chunks import MOST_REPEATED, full_chunks

DIRECT_CHUNKS = full_chunks(SCENE.uncertainty.direct_runs)
# more runs add files and leave these as they are
DIRECT = [f"{RESULTS}/uq/direct/chunk_{chunk}.csv" for chunk in DIRECT_CHUNKS]


rule uq:
    input:
        in_tail("law", *(f"{RESULTS}/uq/{name}" for name in ("outputs.csv", "surrogate.json", "validation.csv"))),


rule sensitivity:
    input:
        in_tail("law", f"{RESULTS}/uq/sensitivity.csv"),


rule compute_direct_runs:
    input:
        **SURFACE,
        inputs=f"{RESULTS}/inputs.csv",
    output:
        f"{RESULTS}/uq/direct/chunk_{{chunk}}.csv",
    log:
        f"{RESULTS}/logs/compute_direct_runs_{{chunk}}.log",
    priority: 1  # a chain of jobs waits for them
    threads: 1
    resources:
        mem_mb=CONTACT_MB,
    params:
        contact=settings("contact"),
        bounds=lambda wildcards: DIRECT_CHUNKS[wildcards.chunk],
    message:
        f"compute direct contact cycles, chunk {{wildcards.chunk}} of {len(DIRECT_CHUNKS)}"
    script:
        "../scripts/compute_direct_runs.py"


# Scatter between surfaces, apart from what the inputs explain
rule repeat_direct_runs:
    input:
        **SURFACE,
        inputs=f"{RESULTS}/inputs.csv",
    output:
        f"{RESULTS}/uq/again.csv",
    log:
        f"{RESULTS}/logs/repeat_direct_runs.log",
    priority: 1
    threads: 1
    resources:
        mem_mb=CONTACT_MB,
    params:
        contact=settings("contact"),
        bounds=(0, min(MOST_REPEATED, SCENE.uncertainty.direct_runs)),
    message:
        "repeat direct contact cycles on other surfaces"
    script:
        "../scripts/compute_direct_runs.py"


rule propagate_uncertainty:
    input:
        inputs=f"{RESULTS}/inputs.csv",
        parameters=f"{RESULTS}/law/parameters.csv",
        direct=DIRECT,
        again=rules.repeat_direct_runs.output if DIRECT else [],
        table2=str(CONFIG / "paper" / "table2.csv"),
    output:
        outputs=f"{RESULTS}/uq/outputs.csv",
        surrogate=f"{RESULTS}/uq/surrogate.json",
        samples=f"{RESULTS}/uq/samples.csv",
        validation=f"{RESULTS}/uq/validation.csv",
        law=f"{RESULTS}/uq/law.csv",
    log:
        f"{RESULTS}/logs/propagate_uncertainty.log",
    resources:
        mem_mb=PROPAGATION_MB,
    params:
        settings=settings("uncertainty"),
        max_force_nN=SCENE.contact.max_force_nN,
        length_nm=SCENE.contact.length_nm,
    message:
        "propagate the uncertainty of the inputs"
    script:
        "../scripts/propagate_uncertainty.py"


rule rank_sensitivity:
    input:
        inputs=f"{RESULTS}/inputs.csv",
        parameters=f"{RESULTS}/law/parameters.csv",
        outputs=f"{RESULTS}/uq/outputs.csv",
        direct=DIRECT,
        table3=str(CONFIG / "paper" / "table3.csv"),
    output:
        f"{RESULTS}/uq/sensitivity.csv",
    log:
        f"{RESULTS}/logs/rank_sensitivity.log",
    resources:
        mem_mb=PROPAGATION_MB,
    params:
        settings=settings("uncertainty"),
    message:
        "rank the inputs by sensitivity"
    script:
        "../scripts/rank_sensitivity.py"


rule measure_uncertainty_accuracy:
    input:
        **SURFACE,
        inputs=f"{RESULTS}/inputs.csv",
        direct=DIRECT,
    output:
        f"{RESULTS}/accuracy/uncertainty.csv",
    log:
        f"{RESULTS}/logs/measure_uncertainty_accuracy.log",
    threads: 1
    params:
        contact=settings("contact"),
        settings=settings("uncertainty"),
    message:
        "measure the error of the regression against the number of direct runs"
    script:
        "../scripts/measure_uncertainty_accuracy.py"


if "law" in SCENE.tails:
    ACCURACY.append(f"{RESULTS}/accuracy/uncertainty.csv")
