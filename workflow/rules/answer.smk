EFFECTS = str(CONFIG / "effects.yaml")
STATED_OF_SWITCH = [
    f"{section}.{name}"
    for section in ("contact", "device")
    for name in sorted(getattr(SCENE, section).model_fields_set)
    if getattr(getattr(SCENE, section), name) is not None
]
if "material" in SCENE.hardness.model_fields_set:
    STATED_OF_SWITCH.append("hardness.material")


rule answer:
    """the switch on the pads: release, sticking and what they hang on"""
    input:
        **PRESSED,
        hardness=INPUT_STAGES.get("hardness", []),
        effects=EFFECTS,
    output:
        switch=f"{RESULTS}/answer/pad_switch.json",
        budget=captioned(f"{RESULTS}/answer/budget.csv"),
        errors=f"{RESULTS}/answer/errors.csv",
        verilog=f"{RESULTS}/answer/rough_pad.va",
        spice=f"{RESULTS}/answer/rough_pad.sub",
    log:
        f"{RESULTS}/logs/answer.log",
    priority: 2
    params:
        **ON_PADS,
        contents=contents(EFFECTS),
        stated=STATED_OF_SWITCH,
    message:
        "say what the switch does"
    script:
        "../scripts/answer_switch.py"


if "switch" in SCENE.tails:
    SHOWN += rules.answer.output
