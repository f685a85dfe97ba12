from mesoscale.uncertainty.chunks import MOST_REPEATED, full_chunks

DIRECT_CHUNKS = full_chunks(SCENE.uncertainty.direct_runs)
# more runs add files and leave these as they are
DIRECT = [f"{RESULTS}/uncertainty/direct/chunk_{chunk}.csv" for chunk in DIRECT_CHUNKS]
# the first ones once more on other surfaces: scatter between surfaces is no effect of the inputs
AGAIN = (0, min(MOST_REPEATED, SCENE.uncertainty.direct_runs))


rule compute_direct_runs:
    input:
        **SURFACE,
        inputs=f"{RESULTS}/inputs.csv",
    output:
        f"{RESULTS}/uncertainty/direct/chunk_{{chunk}}.csv",
    log:
        f"{RESULTS}/logs/compute_direct_runs_{{chunk}}.log",
    priority: 1  # a chain of jobs waits for them
    resources:
        mem_mb=CONTACT_MB,
    params:
        contact=settings("contact"),
        bounds=lambda wildcards: {**DIRECT_CHUNKS, "again": AGAIN}[wildcards.chunk],
    message:
        f"compute direct contact cycles, chunk {{wildcards.chunk}} of {len(DIRECT_CHUNKS)}"
    script:
        "../scripts/compute_direct_runs.py"


PAPER_TABLES = {name: str(CONFIG / "paper" / f"{name}.csv") for name in ("table2", "table3")}


rule uncertainty:
    """what uncertain inputs do to the law, and which cause the spread"""
    input:
        **PAPER_TABLES,
        inputs=f"{RESULTS}/inputs.csv",
        parameters=f"{RESULTS}/law/parameters.csv",
        direct=DIRECT,
        again=[f"{RESULTS}/uncertainty/direct/chunk_again.csv"] if DIRECT else [],
    output:
        outputs=captioned(f"{RESULTS}/uncertainty/outputs.csv"),
        sensitivity=captioned(f"{RESULTS}/uncertainty/sensitivity.csv"),
        surrogate=f"{RESULTS}/uncertainty/surrogate.json",
        samples=f"{RESULTS}/uncertainty/samples.csv",
        validation=f"{RESULTS}/uncertainty/validation.csv",
        law=f"{RESULTS}/uncertainty/law.csv",
    log:
        f"{RESULTS}/logs/uncertainty.log",
    resources:
        mem_mb=PROPAGATION_MB,
    params:
        contents=contents(*PAPER_TABLES.values()),
        settings=settings("uncertainty"),
        max_force_nN=SCENE.contact.max_force_nN,
        length_nm=SCENE.contact.length_nm,
    message:
        "propagate the uncertainty of the inputs, and rank them"
    script:
        "../scripts/propagate_uncertainty.py"


rule sensitivity:
    """the same as uncertainty: which input matters, and how much"""
    input:
        rules.uncertainty.output,


if "law" in SCENE.tails:
    SHOWN += rules.uncertainty.output
    KEPT += [*rules.uncertainty.input.direct, *rules.uncertainty.input.again]
