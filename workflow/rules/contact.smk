rule contact:
    """force against separation at central inputs"""
    input:
        **SURFACE,
        inputs=f"{RESULTS}/inputs.csv",
    output:
        nominal=f"{RESULTS}/contact/nominal.h5",
        spots=f"{RESULTS}/contact/spots.h5",
        errors=f"{RESULTS}/contact/errors.csv",
    log:
        f"{RESULTS}/logs/contact.log",
    resources:
        mem_mb=CONTACT_MB,
    params:
        settings=settings("contact"),
    message:
        "compute the nominal force-separation curves"
    script:
        "../scripts/compute_nominal.py"


if SCENE.tails:
    SHOWN += rules.contact.output
