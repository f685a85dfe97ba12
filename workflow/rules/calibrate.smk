# Measurements in, posterior of the inputs out; only in scenes with measurements.tables
from mesoscale.uncertainty.chunks import chunk_bounds

MEASUREMENT_FILES = {
    table.kind: named_files(f"measurements.tables.{k}.file", table.file)[0]
    for k, table in enumerate(SCENE.measurements.tables)
}
MEASUREMENT_CHUNKS = chunk_bounds(SCENE.measurements.runs)
PRIORS = SCENE.inputs.priors()
if workflow.is_main_process and MEASUREMENT_FILES:  # a table that cannot be used is told before the first cycle
    from mesoscale.calibration.measurements import load_measurements
    from mesoscale.calibration.surfaces import check_points
    from mesoscale.errors import InputError as BadTable

    try:
        for table in SCENE.measurements.tables:
            check_points(load_measurements(table, MEASUREMENT_FILES[table.kind]), SCENE.contact.max_force_nN)
    except BadTable as error:
        refuse(error)


rule calibrate:
    """inputs narrowed by your measurements of contacts"""
    input:
        f"{RESULTS}/calibration/posterior.json",


rule collect_priors:
    input:
        **{stage: path for stage, path in STAGE_RESULT.items() if stage in PRIORS.origins()},
        **SAMPLES,
    output:
        f"{RESULTS}/calibration/priors.csv",
    log:
        f"{RESULTS}/logs/collect_priors.log",
    params:
        settings=PRIORS.model_dump(mode="json"),
        contact=settings("contact"),
    message:
        "collect what is known of the inputs before the measurements"
    script:
        "../scripts/collect_inputs.py"


rule observe_cycles:
    input:
        **SURFACE,
        inputs=f"{RESULTS}/calibration/priors.csv",
    output:
        f"{RESULTS}/calibration/cycles/chunk_{{chunk}}.csv",
    log:
        f"{RESULTS}/logs/observe_cycles_{{chunk}}.log",
    threads: 1
    resources:
        mem_mb=CONTACT_MB,
    params:
        contact=settings("contact"),
        law=settings("law"),
        bounds=lambda wildcards: MEASUREMENT_CHUNKS[wildcards.chunk],
    message:
        f"compute what can be measured of contact cycles, chunk {{wildcards.chunk}} of {len(MEASUREMENT_CHUNKS)}"
    script:
        "../scripts/observe_cycles.py"


rule sample_posterior:
    input:
        **MEASUREMENT_FILES,
        **SURFACE,
        priors=f"{RESULTS}/calibration/priors.csv",
        cycles=[f"{RESULTS}/calibration/cycles/chunk_{chunk}.csv" for chunk in MEASUREMENT_CHUNKS],
    output:
        samples=f"{RESULTS}/calibration/samples.csv",
        summary=f"{RESULTS}/calibration/summary.csv",
        learned=f"{RESULTS}/calibration/learned.csv",
        next=f"{RESULTS}/calibration/next.csv",
        predictive=f"{RESULTS}/calibration/predictive.csv",
        responses=f"{RESULTS}/calibration/responses.csv",
        local_cycles=f"{RESULTS}/calibration/local_cycles.csv",
        posterior=f"{RESULTS}/calibration/posterior.json",
    log:
        f"{RESULTS}/logs/sample_posterior.log",
    threads: 1
    resources:
        mem_mb=CONTACT_MB,
    params:
        settings=settings("measurements"),
        contact=settings("contact"),
        law=settings("law"),
        device=settings("device"),
    message:
        "sample the posterior of the inputs"
    script:
        "../scripts/sample_posterior.py"


rule rank_next_on_pad:
    input:
        **SURFACE,
        priors=f"{RESULTS}/calibration/priors.csv",
        inputs=f"{RESULTS}/inputs.csv",
        cycles=[f"{RESULTS}/calibration/cycles/chunk_{chunk}.csv" for chunk in MEASUREMENT_CHUNKS],
        local_cycles=f"{RESULTS}/calibration/local_cycles.csv",
        model=f"{RESULTS}/pad/model.h5",
    output:
        f"{RESULTS}/calibration/next_on_pad.csv",
    log:
        f"{RESULTS}/logs/rank_next_on_pad.log",
    threads: 1
    params:
        contact=settings("contact"),
        law=settings("law"),
        device=settings("device"),
        pad=settings("pad"),
    message:
        "rank what to measure next for the switch on the pad"
    script:
        "../scripts/rank_next_on_pad.py"
