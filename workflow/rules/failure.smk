# Failure rate of the switch, and its circuit; on the page only in scenes with failure.probability


rule failure:
    """how often the switch fails, down to one in a million"""
    input:
        required(
            SCENE.failure.probability is not None,
            "failure.probability = null: give the share of the switches that may fail, such as 1e-6",
        ),
        **PRESSED,
    output:
        rate=f"{RESULTS}/device/failure.json",
        table=f"{RESULTS}/device/failure.csv",
    log:
        f"{RESULTS}/logs/failure.log",
    params:
        **ON_PADS,
        failure=settings("failure"),
    message:
        "find how often the switch fails"
    script:
        "../scripts/find_failure_rate.py"


rule circuit:
    """the switch for simulators: corners, draws, C-V loop"""
    input:
        **PRESSED,
    output:
        models=directory(f"{RESULTS}/device/circuit"),
        summary=f"{RESULTS}/device/circuit.json",
        table=f"{RESULTS}/device/circuit.csv",
        loop=f"{RESULTS}/device/loop.csv",
    log:
        f"{RESULTS}/logs/circuit.log",
    params:
        **ON_PADS,
    message:
        "make the switch for circuit simulators"
    script:
        "../scripts/make_circuit.py"


if SCENE.failure.probability is not None and "pad" in SCENE.tails:
    SHOWN += [*rules.failure.output, *rules.circuit.output[1:]]
