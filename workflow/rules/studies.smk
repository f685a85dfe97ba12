# Error against run time (accuracy) of the stages that the scene uses, and hard cases of its contact (stability)

OF_CELL = {**SURFACE, "inputs": f"{RESULTS}/inputs.csv"}
STUDIES = {  # what each reads beside settings
    "accuracy/topography": {},
    "accuracy/contact": OF_CELL,
    "accuracy/uncertainty": {**OF_CELL, "direct": DIRECT},
    "accuracy/pad": PRESSED,
    "accuracy/failure": PRESSED,
    "stability/contact": OF_CELL,
}
OF_SCENE = {
    "contact": True,
    "topography": needed("topography"),
    "uncertainty": "law" in SCENE.tails,
    "pad": "pad" in SCENE.tails,
    "failure": "pad" in SCENE.tails and SCENE.failure.probability is not None,
}
for kind, tables in (("accuracy", ACCURACY), ("stability", STABILITY)):
    tables += [
        f"{RESULTS}/{study}.csv" for study in STUDIES if study.startswith(kind) and OF_SCENE[study.split("/")[1]]
    ]


rule accuracy:
    """error against run time of the scene's stages"""
    input:
        ACCURACY,


rule stability:
    """stiff and extreme cases of the contact"""
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
