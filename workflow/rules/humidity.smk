# The switch against humidity; only in scenes with inputs.humidity or contact.air


rule humidity:
    """the switch from dry to humid air"""
    input:
        required(SCENE.humid, "the air is dry; give inputs.humidity or contact.air"),
        **PRESSED,
    output:
        captioned(f"{RESULTS}/humidity/humidity.csv"),
    log:
        f"{RESULTS}/logs/humidity.log",
    resources:
        mem_mb=contact_MB(SCENE.contact, PILOTS),
    params:
        **ON_PADS,
    message:
        "press pads and solve the switch from dry to humid air"
    script:
        "../scripts/sweep_humidity.py"


if SCENE.humid and "switch" in SCENE.tails:
    SHOWN += rules.humidity.output
