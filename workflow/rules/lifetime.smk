# The life of a switch that is held; only in scenes with lifetime.years

AGEING = {}
if SCENE.lifetime.ageing is not None:
    AGEING["ageing"] = f"{RESULTS}/lifetime/ageing.csv"


rule lifetime:
    """release and sticking over years of hold, by charge"""
    input:
        required(
            SCENE.lifetime.years is not None,
            "lifetime.years = null: give the life that is asked for, such as 10",
        ),
        **PRESSED,
    output:
        **AGEING,
        life=captioned(f"{RESULTS}/lifetime/lifetime.csv"),
        holds=f"{RESULTS}/lifetime/holds.csv",
        summary=f"{RESULTS}/lifetime/lifetime.json",
    log:
        f"{RESULTS}/logs/lifetime.log",
    resources:
        mem_mb=contact_MB(SCENE.contact, PILOTS),
    params:
        **ON_PADS,
        lifetime=RESOLVED.get("lifetime"),
    message:
        "hold the switches for a life"
    script:
        "../scripts/hold_switches.py"


if SCENE.lifetime.years is not None and "switch" in SCENE.tails:
    SHOWN += rules.lifetime.output
