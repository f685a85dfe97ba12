from mesoscale.uncertainty.chunks import full_chunks
from mesoscale.uncertainty.studies.readings import audited_readings


def direct_files(design, runs, name="chunk"):
    """Result files of the first `runs` runs of a design; more runs add files and leave these as they are."""
    return [f"{RESULTS}/uq/{design}/{name}_{chunk}.csv" for chunk in full_chunks(runs, SCENE.uncertainty.chunk_runs)]


PAIR_CHUNKS = full_chunks(SCENE.uncertainty.model_form_pairs, 20)
AUDITED = audited_readings(SCENE.uncertainty.audit_readings)


rule uq:
    input:
        f"{RESULTS}/uq/outputs.csv",
        f"{RESULTS}/uq/surrogate.json",
        f"{RESULTS}/uq/validation.csv",


rule sensitivity:
    input:
        f"{RESULTS}/uq/sensitivity.csv",


rule compute_direct_runs:
    input:
        **SURFACE,
        inputs=f"{RESULTS}/inputs.csv",
    output:
        runs=f"{RESULTS}/uq/{{design}}/chunk_{{chunk}}.csv",
        timing=f"{RESULTS}/uq/{{design}}/timing_{{chunk}}.csv",
    log:
        f"{RESULTS}/logs/compute_direct_runs_{{design}}_{{chunk}}.log",
    wildcard_constraints:
        design="direct|replicate|morris",
    priority: 1  # a chain of jobs waits for them
    threads: 1
    resources:
        mem_mb=CONTACT_MB,
    params:
        contact=settings("contact"),
        law=settings("law"),
        uncertainty=RUN_SETTINGS,
        bounds=lambda wildcards: [(int(wildcards.chunk) + shift) * SCENE.uncertainty.chunk_runs for shift in (0, 1)],
    message:
        "compute contact cycles of design {wildcards.design}, chunk {wildcards.chunk}"
    script:
        "../scripts/compute_direct_runs.py"


rule propagate_uncertainty:
    input:
        inputs=f"{RESULTS}/inputs.csv",
        parameters=f"{RESULTS}/law/parameters.csv",
        direct=direct_files("direct", SCENE.uncertainty.direct_runs),
        table2=str(CONFIG / "paper" / "table2.csv"),
        table3=str(CONFIG / "paper" / "table3.csv"),
    output:
        outputs=report(f"{RESULTS}/uq/outputs.csv", caption="../captions/outputs.rst", category="Uncertainty"),
        ratios=f"{RESULTS}/uq/ratios.csv",
        surrogate=f"{RESULTS}/uq/surrogate.json",
        samples=f"{RESULTS}/uq/samples.csv",
        validation=f"{RESULTS}/uq/validation.csv",
    log:
        f"{RESULTS}/logs/propagate_uncertainty.log",
    resources:
        mem_mb=PROPAGATION_MB,
    params:
        settings=settings("uncertainty"),
        law=settings("law"),
    message:
        "propagate the uncertainty of the inputs"
    script:
        "../scripts/propagate_uncertainty.py"


rule rank_sensitivity:
    input:
        inputs=f"{RESULTS}/inputs.csv",
        parameters=f"{RESULTS}/law/parameters.csv",
        outputs=f"{RESULTS}/uq/outputs.csv",
        direct=direct_files("direct", SCENE.uncertainty.direct_runs),
        table3=str(CONFIG / "paper" / "table3.csv"),
    output:
        report(f"{RESULTS}/uq/sensitivity.csv", caption="../captions/sensitivity.rst", category="Uncertainty"),
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


rule audit:
    input:
        f"{RESULTS}/audit/ranking.csv",


rule compute_audit:
    input:
        **SURFACE,
        inputs=f"{RESULTS}/inputs.csv",
    output:
        f"{RESULTS}/audit/runs/{{reading}}_{{seed}}.csv",
    log:
        f"{RESULTS}/logs/compute_audit_{{reading}}_{{seed}}.log",
    wildcard_constraints:
        seed=r"\d+",
    params:
        contact=settings("contact"),
        law=settings("law"),
        uncertainty={**RUN_SETTINGS, "surrogate": "level1"},
    message:
        "audit reading {wildcards.reading}, surface {wildcards.seed}"
    script:
        "../scripts/compute_audit.py"


rule rank_readings:
    input:
        inputs=f"{RESULTS}/inputs.csv",
        table2=str(CONFIG / "paper" / "table2.csv"),
        table3=str(CONFIG / "paper" / "table3.csv"),
        runs=[
            f"{RESULTS}/audit/runs/{reading}_{seed}.csv"
            for reading in AUDITED
            for seed in range(SCENE.uncertainty.audit_seeds)
        ],
    output:
        f"{RESULTS}/audit/ranking.csv",
    log:
        f"{RESULTS}/logs/rank_readings.log",
    params:
        central_share=SCENE.uncertainty.central_share,
    message:
        "rank the readings by their distance to the paper's tables"
    script:
        "../scripts/rank_readings.py"


rule brute_force:
    input:
        f"{RESULTS}/uq/overhead.csv",


rule measure_overhead:
    input:
        runs=direct_files("direct", SCENE.uncertainty.study_runs),
        timing=direct_files("direct", SCENE.uncertainty.study_runs, "timing"),
    output:
        f"{RESULTS}/uq/overhead.csv",
    log:
        f"{RESULTS}/logs/measure_overhead.log",
    params:
        cores=lambda wildcards: workflow.cores,  # known only where there is no cluster
    message:
        "compare the time of the engine with the time of the jobs"
    script:
        "../scripts/measure_overhead.py"


rule work_precision:
    input:
        f"{RESULTS}/accuracy/uncertainty.csv",


rule study_responses:
    input:
        inputs=f"{RESULTS}/inputs.csv",
        parameters=f"{RESULTS}/law/parameters.csv",
        direct=direct_files("direct", SCENE.uncertainty.study_runs),
        timing=direct_files("direct", SCENE.uncertainty.study_runs, "timing"),
        replicate=direct_files("replicate", SCENE.uncertainty.study_replicates),
        morris=direct_files("morris", SCENE.uncertainty.morris_trajectories * (len(SCENE.inputs.rows()) + 1)),
        table3=str(CONFIG / "paper" / "table3.csv"),
    output:
        precision=f"{RESULTS}/uq/work_precision.csv",
        bias=f"{RESULTS}/uq/bias.csv",
        indices=f"{RESULTS}/uq/indices.csv",
        morris=f"{RESULTS}/uq/morris.csv",
        accuracy=f"{RESULTS}/accuracy/uncertainty.csv",
    log:
        f"{RESULTS}/logs/study_responses.log",
    params:
        settings=settings("uncertainty"),
    message:
        "set the responses against direct runs"
    script:
        "../scripts/study_responses.py"


ACCURACY.append(f"{RESULTS}/accuracy/uncertainty.csv")


rule study_uncertainty_stability:
    output:
        f"{RESULTS}/stability/uncertainty.csv",
    log:
        f"{RESULTS}/logs/study_uncertainty_stability.log",
    message:
        "study the propagation in unusual cases"
    script:
        "../scripts/study_uncertainty_stability.py"


STABILITY.append(f"{RESULTS}/stability/uncertainty.csv")


# Asperities on their own and coupled, side by side
rule model_form:
    input:
        f"{RESULTS}/uq/model_form.csv",


rule compute_pairs:
    input:
        inputs=f"{RESULTS}/inputs.csv",
    output:
        f"{RESULTS}/uq/model_form/pairs_{{chunk}}.csv",
    log:
        f"{RESULTS}/logs/compute_pairs_{{chunk}}.log",
    wildcard_constraints:
        chunk=r"\d+",
    threads: 1
    params:
        contact=settings("contact"),
        law=settings("law"),
        uncertainty=RUN_SETTINGS,
        bounds=lambda wildcards: PAIR_CHUNKS[wildcards.chunk],
    message:
        "compute contact cycles with both mechanics, chunk {wildcards.chunk}"
    script:
        "../scripts/compute_pairs.py"


rule compare_mechanics:
    input:
        expand(rules.compute_pairs.output[0], chunk=PAIR_CHUNKS),
    output:
        f"{RESULTS}/uq/model_form.csv",
    log:
        f"{RESULTS}/logs/compare_mechanics.log",
    params:
        seed=SCENE.uncertainty.sample_seed,
    message:
        "compare the mechanics of the contact"
    script:
        "../scripts/compare_mechanics.py"


rule extremes:
    input:
        f"{RESULTS}/uq/extremes.csv",


rule study_extremes:
    input:
        **SURFACE,
        inputs=f"{RESULTS}/inputs.csv",
    output:
        f"{RESULTS}/uq/extremes.csv",
    log:
        f"{RESULTS}/logs/study_extremes.log",
    params:
        contact=settings("contact"),
        law=settings("law"),
        central_share=SCENE.uncertainty.central_share,
    message:
        "study first contact and d_c on larger samples"
    script:
        "../scripts/study_extremes.py"
