# Failure rate of the switch, and its circuit; on the page only in scenes with failure.probability


rule failure:
    input:
        in_tail("pad", f"{RESULTS}/device/failure.json"),


rule find_failure_rate:
    input:
        **SURFACE,
        inputs=f"{RESULTS}/pad/inputs.csv",
        model=f"{RESULTS}/pad/model.h5",
    output:
        rate=f"{RESULTS}/device/failure.json",
        table=f"{RESULTS}/device/failure.csv",
    log:
        f"{RESULTS}/logs/find_failure_rate.log",
    threads: 1
    params:
        contact=settings("contact"),
        device=settings("device"),
        pad=settings("pad"),
        failure=settings("failure"),
    message:
        "find how often the switch fails"
    script:
        "../scripts/find_failure_rate.py"


if SCENE.failure.probability is not None and "pad" in SCENE.tails:
    ACCURACY.append(f"{RESULTS}/accuracy/failure.csv")


rule measure_failure_accuracy:
    input:
        **rules.find_failure_rate.input,
    output:
        f"{RESULTS}/accuracy/failure.csv",
    log:
        f"{RESULTS}/logs/measure_failure_accuracy.log",
    threads: 1
    params:
        contact=settings("contact"),
        device=settings("device"),
        pad=settings("pad"),
        failure=settings("failure"),
    message:
        "study the error of the failure rate against run time"
    script:
        "../scripts/measure_failure_accuracy.py"


rule circuit:
    input:
        in_tail("pad", f"{RESULTS}/device/circuit.json"),


rule make_circuit:
    input:
        **rules.find_failure_rate.input,
    output:
        models=directory(f"{RESULTS}/device/circuit"),
        summary=f"{RESULTS}/device/circuit.json",
        table=f"{RESULTS}/device/circuit.csv",
        loop=f"{RESULTS}/device/loop.csv",
    log:
        f"{RESULTS}/logs/make_circuit.log",
    threads: 1
    params:
        contact=settings("contact"),
        device=settings("device"),
        pad=settings("pad"),
    message:
        "make the switch for circuit simulators"
    script:
        "../scripts/make_circuit.py"
