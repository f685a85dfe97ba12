# Error against run time (accuracy) of what a scene can choose, and hard cases of its contact (stability)

STUDIES = {  # what each reads beside settings
    "accuracy/topography": {},
    "accuracy/pad": PRESSED,
    "stability/contact": {**SURFACE, "inputs": f"{RESULTS}/inputs.csv"},
}
STABILITY.append(f"{RESULTS}/stability/contact.csv")
if needed("topography"):
    ACCURACY.append(f"{RESULTS}/accuracy/topography.csv")
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
        **{section: settings(section) for section in ("contact", "device", "pad", "topography")},
    message:
        "study {wildcards.study}"
    script:
        "../scripts/study.py"
