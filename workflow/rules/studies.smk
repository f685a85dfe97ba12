# Error against run time (accuracy) of what a scene can choose, and hard cases of its contact (stability)

STUDIES = {  # what each reads beside settings
    "accuracy/topography": {},
    "accuracy/pad": PRESSED,
    "stability/contact": {**SURFACE, "inputs": f"{RESULTS}/inputs.csv"},
}
STABILITY = [f"{RESULTS}/stability/contact.csv"]
ACCURACY = [f"{RESULTS}/accuracy/topography.csv"] if needed("topography") else []
if "pad" in SCENE.tails:
    ACCURACY.append(f"{RESULTS}/accuracy/pad.csv")


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
        **ON_PADS,
        topography=settings("topography"),
    message:
        "study {wildcards.study}"
    script:
        "../scripts/study.py"
