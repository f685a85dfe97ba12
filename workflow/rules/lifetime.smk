# The life of a switch that is held; only in scenes with lifetime.years

AGEING = {}
if SCENE.lifetime.ageing is not None:
    AGEING["ageing"] = f"{RESULTS}/lifetime/ageing.csv"
NARROWED = {}
DRIFT = {kind: path for kind, path in TABLE_FILES.items() if kind == "drift"}
if DRIFT:
    NARROWED["rates"] = f"{RESULTS}/lifetime/rates.json"


rule narrow_rates:
    input:
        required(DRIFT, "measurements.tables: no table of kind drift (docs/lifetime.md)"),
        **DRIFT,
        **PRESSED,
    output:
        draws=f"{RESULTS}/lifetime/rates.csv",
        rates=f"{RESULTS}/lifetime/rates.json",
    log:
        f"{RESULTS}/logs/narrow_rates.log",
    resources:
        mem_mb=contact_MB(SCENE.contact, PILOTS),
    params:
        **ON_PADS,
        contents=contents(*DRIFT.values()),
        measurements=settings("measurements"),
        lifetime=RESOLVED.get("lifetime"),
    message:
        "narrow the rates of charging by the measured drift"
    script:
        "../scripts/narrow_rates.py"


rule lifetime:
    """release and sticking over years of hold, by charge"""
    input:
        required(
            SCENE.lifetime.years is not None,
            "lifetime.years = null: give the life that is asked for, such as 10",
        ),
        **PRESSED,
        **NARROWED,
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
    SHOWN += [*rules.lifetime.output, *NARROWED.values()]
    if NARROWED:
        KEPT += [rules.narrow_rates.output.draws]
