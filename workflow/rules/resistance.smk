# Electrical resistance of metal on metal; only in scenes with resistance.resistivities_nOhm_m


rule resistance:
    """electrical resistance of metal on metal against force"""
    input:
        **SURFACE,
        inputs=f"{RESULTS}/inputs.csv",
    output:
        f"{RESULTS}/device/resistance.csv",
    log:
        f"{RESULTS}/logs/resistance.log",
    resources:
        mem_mb=CONTACT_MB,
    params:
        contact=settings("contact"),
        resistance=settings("resistance"),
    message:
        "measure the resistance of closing and opening contacts"
    script:
        "../scripts/measure_resistance.py"


if SCENE.resistance.resistivities_nOhm_m is not None:
    SHOWN += rules.resistance.output
