# Error against run time (accuracy) and hard cases (stability) of the stages that the scene uses

OF_CELL = {**SURFACE, "inputs": f"{RESULTS}/inputs.csv"}
STUDIES = {  # what each reads beside settings
    "accuracy/topography": {},
    "accuracy/contact": OF_CELL,
    "accuracy/uncertainty": {**OF_CELL, "direct": DIRECT},
    "accuracy/pad": PRESSED,
    "accuracy/failure": PRESSED,
    "accuracy/hardness": {
        "summaries": [f"{RESULTS}/accuracy/hardness/{name}/{SMALLEST.name}.json" for name in variations(SMALLEST)]
    },
    "accuracy/elastic": {
        "material": MATERIAL,
        "moduli": f"{RESULTS}/elastic/bulk_moduli.csv",
        "points": f"{RESULTS}/elastic/points.csv",
    },
    "stability/contact": OF_CELL,
    "stability/hardness": {
        "potential": BODIES.potential,
        "glass": f"{RESULTS}/hardness/glass/{SMALLEST.seed}.data",
    },
    "stability/elastic": {"material": MATERIAL},
}
OF_SCENE = {
    "contact": True,
    "topography": needed("topography"),
    "hardness": needed("hardness"),
    "elastic": needed("elastic"),
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
        **{section: settings(section) for section in ("topography", "uncertainty", "hardness", "elastic")},
        work=f"{RESULTS}/work/{{study}}",
    message:
        "study {wildcards.study}"
    script:
        "../scripts/study.py"
