rule curves:
    """force against separation at central inputs"""
    input:
        **SURFACE,
        inputs=f"{RESULTS}/inputs.csv",
    output:
        curves=f"{RESULTS}/curves/nominal.h5",
        spots=f"{RESULTS}/curves/spots.h5",
        errors=f"{RESULTS}/curves/errors.csv",
    log:
        f"{RESULTS}/logs/curves.log",
    resources:
        mem_mb=CONTACT_MB,
    params:
        settings=settings("contact"),
    message:
        "compute the nominal force-separation curves"
    script:
        "../scripts/compute_nominal.py"


if SCENE.tails:
    SHOWN += rules.curves.output
