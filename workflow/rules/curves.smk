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
        accuracy=f"{RESULTS}/accuracy/contact.csv",
        cutoff=f"{RESULTS}/uq/cutoff.csv",
    log:
        f"{RESULTS}/logs/study_contact_accuracy.log",
    threads: 1
    resources:
        mem_mb=CONTACT_MB,
    params:
        settings=settings("contact"),
        law=settings("law"),
    message:
        "study the error of the contact model against its run time"
    script:
        "../scripts/study_contact_accuracy.py"


rule draw_contacts:
    output:
        f"{RESULTS}/stability/contact_draws/chunk_{{draws}}.csv",
    log:
        f"{RESULTS}/logs/draw_contacts_{{draws}}.log",
    wildcard_constraints:
        draws="\\d+",
    threads: 1
    params:
        settings=settings("contact"),
    message:
        "close and open random draws of Table 1, chunk {wildcards.draws}"
    script:
        "../scripts/draw_contacts.py"


rule study_contact_stability:
    input:
        draws=expand(rules.draw_contacts.output[0], draws=[f"{k:03d}" for k in range(SCENE.contact.draw_chunks)]),
    output:
        table=f"{RESULTS}/stability/contact.csv",
        draws=f"{RESULTS}/stability/contact_draws.csv",
    log:
        f"{RESULTS}/logs/study_contact_stability.log",
    threads: 1
    params:
        settings=settings("contact"),
    message:
        "study the contact model in stiff and extreme cases"
    script:
        "../scripts/study_contact_stability.py"


ACCURACY += [f"{RESULTS}/accuracy/contact.csv", f"{RESULTS}/uq/cutoff.csv"]
STABILITY.append(f"{RESULTS}/stability/contact.csv")
