ELASTIC = settings("elastic")
GLASSES = [f"a{k:02d}" for k in range(1, ELASTIC["structures"] + 1)]
WITH_LDA = GLASSES[: max(1, len(GLASSES) // 2)]  # enough for the shift between functionals
FUNCTIONALS = {name: ["GGA", "LDA"] if name in WITH_LDA else ["GGA"] for name in GLASSES}
CRYSTALS = {
    name: material_path(material) for material in MATERIALS.values() for name in material.crystals
}
MATERIAL = str(CONFIG / "materials" / f"{ELASTIC['material']}.yaml")
COUNTER_BODY = str(CONFIG / "materials" / f"{ELASTIC['counter_body']}.yaml")

for key, name, known in (
    (
        "material",
        ELASTIC["material"],
        [name for name, one in MATERIALS.items() if one.network_glass is not None],
    ),
    (
        "counter_body",
        ELASTIC["counter_body"],
        [name for name, one in MATERIALS.items() if one.polycrystal is not None],
    ),
    *(("crystals", name, list(CRYSTALS)) for name in ELASTIC["crystals"]),
):
    if needed("elastic") and name not in known:
        refuse(
            f"{SCENE_GIVEN}: elastic.{key} = {name!r:.60}: not known; known are {', '.join(known)}"
        )


wildcard_constraints:
    amorphous="a\\d+",
    crystal="|".join(CRYSTALS),


rule make_amorphous:
    input:
        material=MATERIAL,
        # those that this quench must not make once more: it costs nothing beside their DFT
        others=lambda wildcards: [
            f"{RESULTS}/elastic/quenched/a{k:02d}.xyz"
            for k in range(1, int(wildcards.amorphous[1:]))
        ],
    output:
        structure=f"{RESULTS}/elastic/quenched/{{amorphous}}.xyz",
        attempts=f"{RESULTS}/elastic/quenched/{{amorphous}}.csv",
    log:
        f"{RESULTS}/logs/make_amorphous_{{amorphous}}.log",
    priority: 90
    params:
        contents=contents(MATERIAL),
        glass=ELASTIC["glass"],
        seed=ELASTIC["seed"],
        work=f"{RESULTS}/work/{{amorphous}}",
    message:
        "melt and quench amorphous cell {wildcards.amorphous}"
    script:
        "../scripts/make_amorphous.py"


rule scan_glass:
    input:
        material=MATERIAL,
        structure=f"{RESULTS}/elastic/quenched/{{amorphous}}.xyz",
        attempts=f"{RESULTS}/elastic/quenched/{{amorphous}}.csv",
    output:
        structure=f"{RESULTS}/elastic/structures/{{amorphous}}.xyz",
        report=f"{RESULTS}/elastic/structures/{{amorphous}}.json",
        points=f"{RESULTS}/elastic/scans/{{amorphous}}.csv",
    log:
        f"{RESULTS}/logs/scan_glass_{{amorphous}}.log",
    priority: 90
    params:
        contents=contents(MATERIAL),
        dft=ELASTIC["dft"],
        functionals=lambda wildcards: FUNCTIONALS[wildcards.amorphous],
        store=f"{RESULTS}/work/scf/{{amorphous}}",
    message:
        "relax amorphous cell {wildcards.amorphous} and scan its E(V)"
    script:
        "../scripts/scan_glass.py"


rule scan_crystal:
    input:
        material=lambda wildcards: CRYSTALS[wildcards.crystal],
    output:
        points=f"{RESULTS}/elastic/scans/{{crystal}}.csv",
    log:
        f"{RESULTS}/logs/scan_crystal_{{crystal}}.log",
    priority: 80
    params:
        contents=lambda wildcards: contents(CRYSTALS[wildcards.crystal]),
        dft=ELASTIC["dft"],
        store=f"{RESULTS}/work/scf/{{crystal}}",
    message:
        "E(V) of {wildcards.crystal}"
    script:
        "../scripts/scan_crystal.py"


rule elastic:
    """effective modulus from density functional theory"""
    input:
        scans=[f"{RESULTS}/elastic/scans/{name}.csv" for name in (*ELASTIC["crystals"], *GLASSES)],
        structures=[f"{RESULTS}/elastic/structures/{name}.json" for name in GLASSES],
        attempts=[f"{RESULTS}/elastic/quenched/{name}.csv" for name in GLASSES],
        material=MATERIAL,
        counter_body=COUNTER_BODY,
    output:
        points=f"{RESULTS}/elastic/points.csv",
        moduli=captioned(f"{RESULTS}/elastic/bulk_moduli.csv"),
        structures=f"{RESULTS}/elastic/structures.csv",
        e_star=f"{RESULTS}/elastic/e_star.json",
        samples=f"{RESULTS}/elastic/e_star.h5",
    log:
        f"{RESULTS}/logs/elastic.log",
    params:
        contents=contents(MATERIAL, COUNTER_BODY),
        settings=ELASTIC,
    message:
        "fit equations of state, and combine E* with Poisson's ratio and the counter body"
    script:
        "../scripts/combine_e_star.py"


if needed("elastic") and is_used(rules.elastic):
    SHOWN += rules.elastic.output
    KEPT += rules.elastic.input.scans
    KEPT += expand([*rules.make_amorphous.output, *rules.scan_glass.output], amorphous=GLASSES)
