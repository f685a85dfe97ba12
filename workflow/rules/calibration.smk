# Measurements in, posterior of the inputs out; only in scenes with measurements.tables
from mesoscale.uncertainty.chunks import chunk_bounds

TABLE_FILES = {
    table.kind: named_files(f"measurements.tables.{k}.file", table.file)[0]
    for k, table in enumerate(SCENE.measurements.tables)
}
MEASUREMENT_FILES = {table.kind: TABLE_FILES[table.kind] for table in SCENE.measurements.of_inputs}
MEASUREMENT_CHUNKS = chunk_bounds(SCENE.measurements.runs)
PRIOR_PADS = {}
if {"release", "pull_in", "sticking"} & set(MEASUREMENT_FILES):
    PRIOR_PADS = {
        "inputs": f"{RESULTS}/calibration/priors.csv",
        "pads": [f"{RESULTS}/calibration/pads/chunk_{chunk}.h5" for chunk in POINT_CHUNKS],
    }
PRIORS = SCENE.inputs.priors()
if IS_CHECKED_HERE and TABLE_FILES:  # a table that cannot be used is told before the first cycle
    from mesoscale.calibration.measurements import load_measurements
    from mesoscale.calibration.surfaces import check_points
    from mesoscale.errors import InputError as BadTable

    try:
        for table in SCENE.measurements.tables:
            check_points(
                load_measurements(table, TABLE_FILES[table.kind]), SCENE.contact.max_force_nN
            )
    except BadTable as error:
        refuse(error)


rule collect_priors:
    input:
        **{stage: path for stage, path in STAGE_RESULT.items() if stage in PRIORS.origins()},
        **SAMPLES,
    output:
        f"{RESULTS}/calibration/priors.csv",
    log:
        f"{RESULTS}/logs/collect_priors.log",
    params:
        contents=contents(*SAMPLES.values()),
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
    resources:
        mem_mb=CONTACT_MB,
    params:
        contact=settings("contact"),
        bounds=lambda wildcards: MEASUREMENT_CHUNKS[wildcards.chunk],
    message:
        f"observe contact cycles, chunk {{wildcards.chunk}} of {len(MEASUREMENT_CHUNKS)}"
    script:
        "../scripts/observe_cycles.py"


# voltages of switches are compared with switches on pads that are pressed over the prior
use rule press_pads as press_prior_pads with:
    input:
        **SURFACE,
        inputs=f"{RESULTS}/calibration/priors.csv",
    output:
        f"{RESULTS}/calibration/pads/chunk_{{chunk}}.h5",
    log:
        f"{RESULTS}/logs/press_prior_pads_{{chunk}}.log",
    message:
        f"press pads {{wildcards.chunk}} over the prior ({ALL_CHUNKS})"


rule calibration:
    """inputs narrowed by your measurements of contacts"""
    input:
        required(
            MEASUREMENT_FILES,
            "measurements.tables: none; name the tables of measurements (docs/calibration.md)",
        ),
        **MEASUREMENT_FILES,
        **SURFACE,
        **PRIOR_PADS,
        priors=f"{RESULTS}/calibration/priors.csv",
        cycles=[f"{RESULTS}/calibration/cycles/chunk_{chunk}.csv" for chunk in MEASUREMENT_CHUNKS],
    output:
        samples=f"{RESULTS}/calibration/samples.csv",
        summary=captioned(f"{RESULTS}/calibration/summary.csv"),
        predictive=f"{RESULTS}/calibration/predictive.csv",
        posterior=f"{RESULTS}/calibration/posterior.json",
    log:
        f"{RESULTS}/logs/calibration.log",
    resources:
        mem_mb=CONTACT_MB,
    params:
        **ON_PADS,
        contents=contents(*MEASUREMENT_FILES.values()),
        settings=settings("measurements"),
    message:
        "sample the posterior of the inputs"
    script:
        "../scripts/sample_posterior.py"


if MEASUREMENT_FILES:
    SHOWN += rules.calibration.output
    KEPT += rules.calibration.input.cycles
