# Error against run time (accuracy), and stiff and extreme cases (stability), of every stage that
# the scene uses

OF_CELL = {**SURFACE, "inputs": f"{RESULTS}/inputs.csv"}
# what both studies of a stage read beside settings, and whether the scene uses the stage
OF_STAGE = {
    "hardness": (
        {
            "material": BODIES.material,
            "potential": BODIES.potential,
            "glass": f"{RESULTS}/hardness/glass/{SCENE.hardness.seeds[0]}.data",
        },
        needed("hardness"),
    ),
    "elastic": ({"material": MATERIAL}, needed("elastic")),
    "topography": ({}, needed("topography")),
    "contact": (OF_CELL, bool(SCENE.tails)),
    "uncertainty": (OF_CELL, "law" in SCENE.tails),
    "pad": (PRESSED, "switch" in SCENE.tails),
    "answer": (PRESSED, "switch" in SCENE.tails),
    "circuit": (PRESSED, "switch" in SCENE.tails),
    "failure": (PRESSED, "switch" in SCENE.tails and SCENE.failure.probability is not None),
    "lifetime": (PRESSED, "switch" in SCENE.tails and SCENE.lifetime.years is not None),
}
IN_VOLTS = PRESSED if "switch" in SCENE.tails else {}
ALSO_READ = {  # by one study alone
    "accuracy/hardness": IN_VOLTS,
    "accuracy/elastic": {
        **IN_VOLTS,
        "e_star": f"{RESULTS}/elastic/e_star.json",
        "moduli": f"{RESULTS}/elastic/bulk_moduli.csv",
        "reports": expand(f"{RESULTS}/elastic/structures/{{name}}.json", name=GLASSES),
        "structures": expand(f"{RESULTS}/elastic/structures/{{name}}.xyz", name=GLASSES),
        "scans": expand(f"{RESULTS}/elastic/scans/{{name}}.csv", name=GLASSES),
    },
    "accuracy/topography": IN_VOLTS,
    "accuracy/contact": IN_VOLTS,
    "accuracy/uncertainty": {
        "direct": DIRECT,
        "again": rules.uncertainty.input.again,
        "parameters": f"{RESULTS}/law/parameters.csv",
    },
}


ACCURACY = studies_of("accuracy")
STABILITY = studies_of("stability")


rule accuracy:
    """error against run time of the scene's stages"""
    input:
        ACCURACY,


rule stability:
    """stiff and extreme cases of the scene's stages"""
    input:
        STABILITY,


rule study:
    input:
        unpack(files_of_study),
    output:
        f"{RESULTS}/{{kind}}/{{stage}}.csv",
    log:
        f"{RESULTS}/logs/{{kind}}_{{stage}}.log",
    wildcard_constraints:
        kind="accuracy|stability",
        stage="|".join(OF_STAGE),
    resources:
        mem_mb=contact_MB(SCENE.contact, PILOTS),
    params:
        **ON_PADS,
        **{
            section: settings(section)
            for section in ("topography", "uncertainty", "failure", "hardness", "elastic")
        },
        **({"lifetime": RESOLVED["lifetime"]} if "lifetime" in RESOLVED else {}),
        work=f"{RESULTS}/work/{{kind}}_{{stage}}",
    message:
        "study {wildcards.kind} of {wildcards.stage}"
    script:
        "../scripts/study.py"
