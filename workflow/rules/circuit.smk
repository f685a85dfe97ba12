# The switch for circuit simulators; on the page beside the failure rate


rule circuit:
    """the switch for simulators: corners, draws, C-V loop"""
    input:
        required(not SCENE.device.without_circuit, SCENE.device.without_circuit),
        **PRESSED,
    output:
        models=directory(f"{RESULTS}/circuit/models"),
        summary=f"{RESULTS}/circuit/circuit.json",
        table=captioned(f"{RESULTS}/circuit/circuit.csv"),
        loop=f"{RESULTS}/circuit/loop.csv",
    log:
        f"{RESULTS}/logs/circuit.log",
    params:
        **ON_PADS,
    message:
        "make the switch for circuit simulators"
    script:
        "../scripts/make_circuit.py"


FAILURE_IS_SHOWN = SCENE.failure.probability is not None and "switch" in SCENE.tails
if FAILURE_IS_SHOWN and not SCENE.device.without_circuit:
    SHOWN += rules.circuit.output[1:]
