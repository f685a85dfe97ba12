# Error against run time (accuracy) and hard cases (stability) of the stages that the scene uses

OF_CELL = {**SURFACE, "inputs": f"{RESULTS}/inputs.csv"}
STUDIES = {  # what each reads beside settings
    "accuracy/topography": {},
    "accuracy/contact": OF_CELL,
    "accuracy/uncertainty": {**OF_CELL, "direct": DIRECT},
    "accuracy/pad": PRESSED,
    "accuracy/failure": PRESSED,
    "stability/contact": OF_CELL,
}
ACCURACY.append(f"{RESULTS}/accuracy/contact.csv")
STABILITY.append(f"{RESULTS}/stability/contact.csv")
if needed("topography"):
    ACCURACY.append(f"{RESULTS}/accuracy/topography.csv")
if "law" in SCENE.tails:
    ACCURACY.append(f"{RESULTS}/accuracy/uncertainty.csv")
if "pad" in SCENE.tails:
    ACCURACY.append(f"{RESULTS}/accuracy/pad.csv")
    if SCENE.failure.probability is not None:
        ACCURACY.append(f"{RESULTS}/accuracy/failure.csv")


rule accuracy:
    """error against run time of the scene's stages"""
    input:
        ACCURACY,


rule stability:
    """stiff and extreme cases"""
    input:
        STABILITY,


rule study:
    input:
        unpack(lambda wildcards: STUDIES[wildcards.study]),
    output:
        f"{RESULTS}/{{study}}.csv",
    log:
        f"{RESULTS}/logs/{{study}}.log",
    wildcard_constraints:
        study="|".join(STUDIES),
    resources:
        mem_mb=contact_MB(SCENE.contact, PILOTS),
    params:
        **{section: settings(section) for section in ("contact", "device", "failure", "pad")},
        **{section: settings(section) for section in ("topography", "uncertainty")},
    message:
        "study {wildcards.study}"
    script:
        "../scripts/study.py"
