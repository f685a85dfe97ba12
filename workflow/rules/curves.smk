rule curves:
    input:
        f"{RESULTS}/curves/nominal.h5",


rule compute_nominal:
    message:
        "compute the nominal force-separation curves"
    input:
        inputs=f"{RESULTS}/inputs.csv",
    output:
        curves=f"{RESULTS}/curves/nominal.h5",
    log:
        f"{RESULTS}/logs/compute_nominal.log",
    params:
        settings=settings("contact"),
    threads: 1
    script:
        "../scripts/compute_nominal.py"
