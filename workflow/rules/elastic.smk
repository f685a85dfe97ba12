ELASTIC = settings("elastic")
GLASSES = [f"a{k:02d}" for k in range(1, ELASTIC["structures"] + 1)]
CRYSTALS = {}  # name → file that holds it
if needed("elastic"):
    for key, part in (("material", "network_glass"), ("counter_body", "polycrystal")):
        known = [name for name, material in MATERIALS.items() if getattr(material, part) is not None]
        if ELASTIC[key] not in known:
            refuse(
                f"{SCENE_GIVEN}: elastic.{key}: no material {ELASTIC[key]!r:.60} with {part}; known: {', '.join(known)}"
            )
for material in MATERIALS.values():
    CRYSTALS |= dict.fromkeys(material.crystals, material_path(material))
for crystal in ELASTIC["crystals"]:
    if crystal not in CRYSTALS:
        refuse(f"{SCENE_GIVEN}: elastic.crystals: no crystal {crystal!r:.60}; known: {', '.join(CRYSTALS)}")
LDA_GLASSES = GLASSES[: ELASTIC["lda_structures"]]
TENSORS = GLASSES[: ELASTIC["tensor_structures"]] if ELASTIC["poisson"] == "computed" else []
VOLUME_SCANS = [f"{name}_{xc}" for name in ELASTIC["crystals"] for xc in ("GGA", "LDA")]
VOLUME_SCANS += [f"{name}_GGA" for name in GLASSES] + [f"{name}_LDA" for name in LDA_GLASSES]
MATERIAL = str(CONFIG / "materials" / f"{ELASTIC['material']}.yaml")
COUNTER_BODY = str(CONFIG / "materials" / f"{ELASTIC['counter_body']}.yaml")


wildcard_constraints:
    amorphous="a\\d+",
    structure="|".join(["a\\d+", *CRYSTALS]),
    xc="GGA|LDA",


rule elastic:
    input:
        f"{RESULTS}/elastic/e_star.json",


def quenched_before(wildcards):
    """Cells that a quench must not make once more: one after the other, which costs nothing beside their DFT."""
    return [f"{RESULTS}/elastic/quenched/a{k:02d}.xyz" for k in range(1, int(wildcards.amorphous[1:]))]


rule make_amorphous:
    input:
        material=MATERIAL,
        others=quenched_before,
    output:
        structure=f"{RESULTS}/elastic/quenched/{{amorphous}}.xyz",
        attempts=f"{RESULTS}/elastic/quenched/{{amorphous}}.csv",
    log:
        f"{RESULTS}/logs/make_amorphous_{{amorphous}}.log",
    priority: 90
    params:
        glass=ELASTIC["glass"],
        seed=ELASTIC["seed"],
        work=f"{RESULTS}/work/{{amorphous}}",
    message:
        "melt and quench amorphous cell {wildcards.amorphous}"
    script:
        "../scripts/make_amorphous.py"


rule relax_amorphous:
    input:
        material=MATERIAL,
        structure=f"{RESULTS}/elastic/quenched/{{amorphous}}.xyz",
        attempts=f"{RESULTS}/elastic/quenched/{{amorphous}}.csv",
    output:
        structure=f"{RESULTS}/elastic/structures/{{amorphous}}.xyz",
        report=f"{RESULTS}/elastic/structures/{{amorphous}}.json",
        start=f"{RESULTS}/elastic/structures/{{amorphous}}.h5",
    log:
        f"{RESULTS}/logs/relax_amorphous_{{amorphous}}.log",
    priority: 90
    params:
        dft=ELASTIC["dft"],
        store=f"{RESULTS}/work/scf/relax_{{amorphous}}",
    message:
        "relax amorphous cell {wildcards.amorphous}"
    script:
        "../scripts/relax_amorphous.py"


def to_scan(wildcards):
    """A relaxed glass with its verdict and the orbitals to start from, or the material of a crystal."""
    if wildcards.structure in CRYSTALS:
        return {"material": CRYSTALS[wildcards.structure]}
    stem = f"{RESULTS}/elastic/structures/{wildcards.structure}"
    return {"structure": f"{stem}.xyz", "report": f"{stem}.json", "start": f"{stem}.h5"}


rule scan_volumes:
    input:
        unpack(to_scan),
    output:
        points=f"{RESULTS}/elastic/scans/{{structure}}_{{xc}}.csv",
    log:
        f"{RESULTS}/logs/scan_volumes_{{structure}}_{{xc}}.log",
    priority: 80
    params:
        strains=ELASTIC["strains"],
        dft=ELASTIC["dft"],
        store=f"{RESULTS}/work/scf/{{structure}}_{{xc}}",
    message:
        "E(V) of {wildcards.structure}, {wildcards.xc}"
    script:
        "../scripts/scan_volumes.py"


rule fit_bulk_moduli:
    input:
        scans=[f"{RESULTS}/elastic/scans/{scan}.csv" for scan in VOLUME_SCANS],
    output:
        points=f"{RESULTS}/elastic/points.csv",
        moduli=f"{RESULTS}/elastic/bulk_moduli.csv",
    log:
        f"{RESULTS}/logs/fit_bulk_moduli.log",
    message:
        "fit equations of state"
    script:
        "../scripts/fit_bulk_moduli.py"


rule measure_tensor:
    input:
        material=MATERIAL,
        structure=f"{RESULTS}/elastic/structures/{{amorphous}}.xyz",
        report=f"{RESULTS}/elastic/structures/{{amorphous}}.json",
        start=f"{RESULTS}/elastic/structures/{{amorphous}}.h5",
    output:
        tensor=f"{RESULTS}/elastic/tensors/{{amorphous}}.json",
        at_rest=f"{RESULTS}/elastic/tensors/{{amorphous}}.xyz",
    log:
        f"{RESULTS}/logs/measure_tensor_{{amorphous}}.log",
    priority: 94
    params:
        dft=ELASTIC["dft"],
        store=f"{RESULTS}/work/scf/tensor_{{amorphous}}",
    message:
        "elastic constants of {wildcards.amorphous}"
    script:
        "../scripts/measure_tensor.py"


rule average_tensors:
    input:
        tensors=[f"{RESULTS}/elastic/tensors/{name}.json" for name in TENSORS],
        at_rest=[f"{RESULTS}/elastic/tensors/{name}.xyz" for name in TENSORS],
    output:
        table=f"{RESULTS}/elastic/isotropic_moduli.csv",
    log:
        f"{RESULTS}/logs/average_tensors.log",
    message:
        "bulk and shear modulus, E and Poisson's ratio from elastic constants"
    script:
        "../scripts/average_tensors.py"


# the glasses' own Poisson's ratios, where they are wanted
ISOTROPIC = {"isotropic": f"{RESULTS}/elastic/isotropic_moduli.csv"} if TENSORS else {}


rule combine_e_star:
    input:
        **ISOTROPIC,
        moduli=f"{RESULTS}/elastic/bulk_moduli.csv",
        structures=[f"{RESULTS}/elastic/structures/{name}.json" for name in GLASSES],
        attempts=[f"{RESULTS}/elastic/quenched/{name}.csv" for name in GLASSES],
        counter_body=COUNTER_BODY,
    output:
        e_star=f"{RESULTS}/elastic/e_star.json",
        samples=f"{RESULTS}/elastic/e_star.h5",
        structures=f"{RESULTS}/elastic/structures.csv",
    log:
        f"{RESULTS}/logs/combine_e_star.log",
    params:
        settings=ELASTIC,
    message:
        "combine E* from bulk moduli, Poisson's ratio and the counter body"
    script:
        "../scripts/combine_e_star.py"


if needed("elastic"):
    ACCURACY.append(f"{RESULTS}/accuracy/elastic.csv")
    STABILITY.append(f"{RESULTS}/stability/elastic.csv")


rule measure_elastic_accuracy:
    input:
        material=MATERIAL,
        moduli=f"{RESULTS}/elastic/bulk_moduli.csv",
        points=f"{RESULTS}/elastic/points.csv",
    output:
        table=f"{RESULTS}/accuracy/elastic.csv",
    log:
        f"{RESULTS}/logs/measure_elastic_accuracy.log",
    params:
        settings=ELASTIC,
    message:
        "measure the error of bulk and shear modulus against run time"
    script:
        "../scripts/measure_elastic_accuracy.py"


rule check_elastic_stability:
    input:
        material=MATERIAL,
    output:
        table=f"{RESULTS}/stability/elastic.csv",
    log:
        f"{RESULTS}/logs/check_elastic_stability.log",
    params:
        dft=ELASTIC["dft"],
    message:
        "check the elastic stage in hard cases"
    script:
        "../scripts/check_elastic_stability.py"
