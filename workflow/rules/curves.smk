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


rule study_contact_accuracy:
    message:
        "study the error of the contact model against its run time"
    output:
        f"{RESULTS}/accuracy/contact.csv",
    log:
        f"{RESULTS}/logs/study_contact_accuracy.log",
    params:
        settings=settings("contact"),
    threads: 1
    script:
        "../scripts/study_contact_accuracy.py"


rule draw_contacts:
    message:
        "close and open random draws of Table 1, chunk {wildcards.draws}"
    output:
        f"{RESULTS}/stability/contact_draws/chunk_{{draws}}.csv",
    log:
        f"{RESULTS}/logs/draw_contacts_{{draws}}.log",
    params:
        settings=settings("contact"),
    wildcard_constraints:
        draws="\\d+",
    threads: 1
    script:
        "../scripts/draw_contacts.py"


rule study_contact_stability:
    message:
        "study the contact model in stiff and extreme cases"
    input:
        draws=expand(rules.draw_contacts.output[0], draws=[f"{k:03d}" for k in range(SCENE.contact.draw_chunks)]),
    output:
        table=f"{RESULTS}/stability/contact.csv",
        draws=f"{RESULTS}/stability/contact_draws.csv",
    log:
        f"{RESULTS}/logs/study_contact_stability.log",
    params:
        settings=settings("contact"),
    threads: 1
    script:
        "../scripts/study_contact_stability.py"


ACCURACY.append(f"{RESULTS}/accuracy/contact.csv")
STABILITY.append(f"{RESULTS}/stability/contact.csv")
