rule curves:
    input:
        f"{RESULTS}/curves/nominal.h5",


rule compute_nominal:
    input:
        **SURFACE,
        inputs=f"{RESULTS}/inputs.csv",
    output:
        curves=f"{RESULTS}/curves/nominal.h5",
        spots=f"{RESULTS}/curves/spots.h5",
    log:
        f"{RESULTS}/logs/compute_nominal.log",
    threads: 1
    resources:
        mem_mb=CONTACT_MB,
    params:
        settings=settings("contact"),
    message:
        "compute the nominal force-separation curves"
    script:
        "../scripts/compute_nominal.py"


rule study_contact_accuracy:
    input:
        **SURFACE,
        inputs=f"{RESULTS}/inputs.csv",
    output:
        f"{RESULTS}/accuracy/contact.csv",
    log:
        f"{RESULTS}/logs/study_contact_accuracy.log",
    threads: 1
    resources:
        mem_mb=CONTACT_MB,
    params:
        settings=settings("contact"),
    message:
        "study the error of the contact model against its run time"
    script:
        "../scripts/study_contact_accuracy.py"


rule study_contact_stability:
    input:
        **SURFACE,
        inputs=f"{RESULTS}/inputs.csv",
    output:
        f"{RESULTS}/stability/contact.csv",
    log:
        f"{RESULTS}/logs/study_contact_stability.log",
    threads: 1
    resources:
        mem_mb=CONTACT_MB,
    params:
        settings=settings("contact"),
    message:
        "study the contact model in stiff and extreme cases"
    script:
        "../scripts/study_contact_stability.py"


ACCURACY.append(f"{RESULTS}/accuracy/contact.csv")
STABILITY.append(f"{RESULTS}/stability/contact.csv")
