STAGE_RESULT = {
    "hardness": f"{RESULTS}/hardness/fit.json",
    "elastic": f"{RESULTS}/elastic/e_star.json",
    "topography": f"{RESULTS}/topography/parameters.json",
    "calibration": f"{RESULTS}/calibration/posterior.json",
}
INPUT_STAGES = {
    stage: path for stage, path in STAGE_RESULT.items() if stage in SCENE.inputs.origins()
}
SAMPLES = {
    f"samples_{name}": named_files(f"inputs.{name}.values", row.values)[0]
    for name, row in SCENE.inputs.rows().items()
    if isinstance(row.values, str)
}
if IS_CHECKED_HERE:
    from workflow.scene.checks import mistakes  # takes half a second: not in every job

    found = {name.removeprefix("samples_"): path for name, path in SAMPLES.items()}
    if lines := mistakes(SCENE, found):
        refuse("\n".join(f"{SCENE_GIVEN}: {line}" for line in lines))


rule inputs:
    """table of the uncertain inputs"""
    input:
        **INPUT_STAGES,
        **SAMPLES,
    output:
        captioned(f"{RESULTS}/inputs.csv"),
    log:
        f"{RESULTS}/logs/inputs.log",
    params:
        contents=contents(*SAMPLES.values()),
        settings=settings("inputs"),
        contact=settings("contact"),
    message:
        "collect the uncertain inputs"
    script:
        "../scripts/collect_inputs.py"


if SCENE.tails:  # else no contact has them, and a slope that no run had refuses nothing
    SHOWN += rules.inputs.output
