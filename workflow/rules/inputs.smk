import math

from mesoscale.errors import InputError as MesoscaleInputError
from mesoscale.inputs.definitions import BY_NAME

STAGE_RESULT = {
    "hardness": f"{RESULTS}/hardness/fit.json",
    "elastic": f"{RESULTS}/elastic/e_star.json",
    "topography": f"{RESULTS}/topography/parameters.json",
    "calibration": f"{RESULTS}/calibration/posterior.json",
}
INPUT_STAGES = {stage: path for stage, path in STAGE_RESULT.items() if stage in SCENE.inputs.origins()}
SAMPLES = {
    f"samples_{name}": named_files(f"inputs.{name}.file", row.file)[0]
    for name, row in SCENE.inputs.rows().items()
    if row.prior_origin == "literature" and row.distribution == "samples"
}
for name, row in SCENE.inputs.rows().items():
    if BY_NAME[name].setting in SCENE.contact.model_fields_set:
        refuse(f"{SCENE_GIVEN}: contact.{BY_NAME[name].setting} and inputs.{name} give the same number; leave one out")
if workflow.is_main_process:
    from mesoscale.inputs.table import check_literature  # takes half a second: not in every job

    found = {
        name: row.model_copy(update={"file": SAMPLES.get(f"samples_{name}")})
        for name, row in SCENE.inputs.rows().items()
    }
    try:
        check_literature(SCENE.inputs.model_copy(update=found), SCENE.uncertainty.central_share)
    except MesoscaleInputError as error:
        refuse(f"{SCENE_GIVEN}: {error}")
    q0, nyquist = SCENE.inputs.q0, math.pi * SCENE.contact.pixels / SCENE.contact.length_nm
    if q0.distribution == "uniform" and q0.b is not None and q0.b > nyquist:
        refuse(
            f"{SCENE_GIVEN}: inputs.q0.b = {q0.b:g} 1/nm lies beyond what the grid resolves ({nyquist:.3g} 1/nm: pi "
            "contact.pixels / contact.length_nm); take more pixels, a smaller side or a smaller q0"
        )


rule inputs:
    input:
        f"{RESULTS}/inputs.csv",


rule collect_inputs:
    input:
        **INPUT_STAGES,
        **SAMPLES,
    output:
        report(f"{RESULTS}/inputs.csv", caption="../captions/inputs.rst", category="Inputs"),
    log:
        f"{RESULTS}/logs/collect_inputs.log",
    params:
        settings=settings("inputs"),
        central_share=SCENE.uncertainty.central_share,
    message:
        "collect the uncertain inputs"
    script:
        "../scripts/collect_inputs.py"
