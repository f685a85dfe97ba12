# Failure rate of the switch; on the page only in scenes with failure.probability


rule failure:
    """how often the switch fails, down to one in a million"""
    input:
        required(
            SCENE.failure.probability is not None,
            "failure.probability = null: give the share of the switches that may fail,"
            " such as 1e-6",
        ),
        **PRESSED,
    output:
        rate=f"{RESULTS}/failure/failure.json",
        table=captioned(f"{RESULTS}/failure/failure.csv"),
    log:
        f"{RESULTS}/logs/failure.log",
    params:
        **ON_PADS,
        failure=settings("failure"),
    message:
        "find how often the switch fails"
    script:
        "../scripts/find_failure_rate.py"


if SCENE.failure.probability is not None and "switch" in SCENE.tails:
    SHOWN += rules.failure.output
