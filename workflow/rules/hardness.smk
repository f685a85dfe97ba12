from atomistic.hardness.accuracy import VARIATIONS, variations, varied
from atomistic.hardness.runs import PROTOCOL, needs_counter_glass, planned_runs, smallest_run
from atomistic.potentials import load_potential

HARDNESS = settings("hardness")


def potential_path(key, name):
    """The file of a potential that `hardness` gives by name or by path."""
    if name.endswith((".yaml", ".yml")):
        if not needed("hardness"):
            return name
        path = named_files(f"hardness.{key}", name)[0]
        if workflow.is_main_process:
            try:
                load_potential(path)  # a plan says what the first job would
            except InputError as error:
                refuse(error)
        return path
    path = CONFIG / "potentials" / f"{name}.yaml"
    if needed("hardness") and not os.path.isfile(path):
        known = ", ".join(sorted(file.stem for file in path.parent.glob("*.yaml")))
        refuse(f"{SCENE_GIVEN}: hardness.{key} = {name!r:.60}: no such potential; known: {known}, or a path")
    return str(path)


def oxide_path(key, formula):
    """The file of an oxide that `hardness` names by its formula."""
    if formula not in OXIDES:
        refuse(
            f"{SCENE_GIVEN}: hardness.{key} = {formula!r:.60}: no material with oxide_glass; known: {', '.join(OXIDES)}"
        )
    return material_path(OXIDES[formula])


POTENTIAL = potential_path("potential", HARDNESS["potential"])
COUNTER_POTENTIAL = POTENTIAL
if (own := HARDNESS["closing"]["counter_potential"]) is not None:
    COUNTER_POTENTIAL = potential_path("closing.counter_potential", own)
MATERIAL_OF_ASPERITY = oxide_path("material", HARDNESS["material"])
MATERIAL_OF_COUNTERFACE = oxide_path("closing.counter_material", HARDNESS["closing"]["counter_material"])
BASE = None
if (name := HARDNESS["base"]) is not None:
    if name not in MATERIALS or MATERIALS[name].film_base is None:
        known = ", ".join(sorted(key for key, material in MATERIALS.items() if material.film_base is not None))
        refuse(f"{SCENE_GIVEN}: hardness.base = {name!r:.60}: no material with a film_base; known: {known}")
    BASE = material_path(MATERIALS[name])
CLOSINGS = {run.name: run for run in planned_runs(SCENE.hardness)}
SMALLEST = smallest_run(SCENE.hardness)
COUNTER_GLASS = needs_counter_glass(SCENE.hardness)
if needed("hardness"):
    ACCURACY.append(f"{RESULTS}/accuracy/hardness.csv")
    STABILITY.append(f"{RESULTS}/stability/hardness.csv")


if needed("hardness") and workflow.is_main_process:
    from atomistic.hardness.cost import plan_rows  # jobs do without
    from atomistic.hardness.stack import base_of, check_ions

    try:
        below = base_of(MATERIALS[HARDNESS["base"]]) if BASE else None
        if below is not None:
            check_ions(below.material, load_potential(POTENTIAL).materials.get(HARDNESS["material"], {}))
        plan_rows(SCENE.hardness, OXIDES[HARDNESS["material"]], OXIDES[HARDNESS["closing"]["counter_material"]], below)
    except InputError as error:
        refuse(f"{SCENE_GIVEN}: hardness.asperities: {error}")


def of_run(pattern):
    """The file of every closing run."""
    return [f"{RESULTS}/hardness/{pattern.format(run=run)}" for run in CLOSINGS]


def of_counter(seed):
    """As named inputs: glass and potential of the counterface, where that is of another oxide or potential."""
    if not COUNTER_GLASS:
        return {}
    glass = f"{RESULTS}/hardness/glass/{seed}_counter.data"
    return {"counter_glass": glass, "counter_potential": COUNTER_POTENTIAL}


def of_base(run):
    """As named inputs: what lies below a film, and the cell of it that fits the asperity."""
    if run.asperity.film_nm is None:
        return {}
    return {"base": f"{RESULTS}/hardness/base/{run.seed}_{run.asperity.tiles}.data", "base_material": BASE}


wildcard_constraints:
    run="|".join(CLOSINGS),
    variation="|".join(VARIATIONS),
    glass="\\d+",
    tiles="\\d+",


rule hardness:
    input:
        f"{RESULTS}/hardness/fit.json",


rule make_glass:
    input:
        material=MATERIAL_OF_ASPERITY,
        potential=POTENTIAL,
    output:
        atoms=f"{RESULTS}/hardness/glass/{{glass}}.data",
        properties=f"{RESULTS}/hardness/glass/{{glass}}.json",
    log:
        f"{RESULTS}/logs/make_glass_{{glass}}.log",
    priority: 100
    params:
        glass=HARDNESS["glass"],
        seed=lambda wildcards: wildcards.glass,
        work=f"{RESULTS}/work/glass_{{glass}}",
    message:
        "melt and quench glass {wildcards.glass}"
    script:
        "../scripts/make_glass.py"


use rule make_glass as make_counter_glass with:
    input:
        material=MATERIAL_OF_COUNTERFACE,
        potential=COUNTER_POTENTIAL,
        beside=f"{RESULTS}/hardness/glass/{{glass}}.data",
    output:
        atoms=f"{RESULTS}/hardness/glass/{{glass}}_counter.data",
        properties=f"{RESULTS}/hardness/glass/{{glass}}_counter.json",
    log:
        f"{RESULTS}/logs/make_counter_glass_{{glass}}.log",
    params:
        glass=HARDNESS["glass"],
        seed=lambda wildcards: wildcards.glass,
        work=f"{RESULTS}/work/counter_glass_{{glass}}",
    message:
        "melt and quench the counterface of glass {wildcards.glass}"


rule make_base:
    input:
        material=BASE or [],
        glass=f"{RESULTS}/hardness/glass/{{glass}}.data",
    output:
        atoms=f"{RESULTS}/hardness/base/{{glass}}_{{tiles}}.data",
    log:
        f"{RESULTS}/logs/make_base_{{glass}}_{{tiles}}.log",
    priority: 95
    params:
        tiles=lambda wildcards: int(wildcards.tiles),
        seed=lambda wildcards: int(wildcards.glass),
        work=f"{RESULTS}/work/base_{{glass}}_{{tiles}}",
    message:
        "make base {wildcards.glass}, {wildcards.tiles} glass cells wide"
    script:
        "../scripts/make_base.py"


rule run_closing:
    input:
        unpack(lambda wildcards: of_counter(CLOSINGS[wildcards.run].seed)),
        unpack(lambda wildcards: of_base(CLOSINGS[wildcards.run])),
        material=MATERIAL_OF_ASPERITY,
        potential=POTENTIAL,
        glass=lambda wildcards: f"{RESULTS}/hardness/glass/{CLOSINGS[wildcards.run].seed}.data",
    output:
        curve=f"{RESULTS}/hardness/closing/{{run}}.csv",
        witness=f"{RESULTS}/hardness/witness/{{run}}.csv",
        snapshots=f"{RESULTS}/hardness/snapshots/{{run}}.csv",
        summary=f"{RESULTS}/hardness/runs/{{run}}.json",
    log:
        f"{RESULTS}/logs/run_closing_{{run}}.log",
    priority: 90
    threads: HARDNESS["closing"]["processes"]
    params:
        closing_run=lambda wildcards: CLOSINGS[wildcards.run].model_dump(mode="json"),
        closing=HARDNESS["closing"],
        protocol=PROTOCOL.model_dump(mode="json"),
        work=f"{RESULTS}/work/closing_{{run}}",
    message:
        "close asperity {wildcards.run}"
    script:
        "../scripts/run_closing.py"


rule find_hardness:
    input:
        curves=of_run("closing/{run}.csv"),
        witnesses=of_run("witness/{run}.csv"),
        summaries=of_run("runs/{run}.json"),
    output:
        points=f"{RESULTS}/hardness/points.csv",
    log:
        f"{RESULTS}/logs/find_hardness.log",
    params:
        closing=HARDNESS["closing"],
        potential=HARDNESS["potential"],
    message:
        "find the hardness of each closing run"
    script:
        "../scripts/find_hardness.py"


rule fit_hardness:
    input:
        points=f"{RESULTS}/hardness/points.csv",
        witnesses=of_run("witness/{run}.csv"),
        curves=of_run("closing/{run}.csv") if BASE else [],
        base_material=BASE or [],
        potential=POTENTIAL,
        counter_potentials=[COUNTER_POTENTIAL] if COUNTER_GLASS else [],
        glasses=[
            f"{RESULTS}/hardness/glass/{seed}{body}.json"
            for seed in dict.fromkeys(SCENE.hardness.seeds)
            for body in ("", *(["_counter"] if COUNTER_GLASS else []))
        ],
    output:
        fit=f"{RESULTS}/hardness/fit.json",
    log:
        f"{RESULTS}/logs/fit_hardness.log",
    params:
        fit=HARDNESS["fit"],
        energy_scales=HARDNESS["energy_scales"],
    message:
        "fit hardness against contact size"
    script:
        "../scripts/fit_hardness.py"


rule plan_hardness:
    input:
        **({"base": BASE} if BASE else {}),
        material=MATERIAL_OF_ASPERITY,
        counter_material=MATERIAL_OF_COUNTERFACE,
    output:
        plan=f"{RESULTS}/hardness/plan.csv",
    log:
        f"{RESULTS}/logs/plan_hardness.log",
    params:
        hardness=HARDNESS,
    message:
        "estimate what the closing runs will cost"
    script:
        "../scripts/plan_hardness.py"


# The same run with one choice changed, and hard cases with the scene's own potentials and glasses


use rule run_closing as vary_closing with:
    output:
        curve=f"{RESULTS}/accuracy/hardness/{{variation}}/{{run}}.csv",
        witness=f"{RESULTS}/accuracy/hardness/{{variation}}/{{run}}.witness.csv",
        snapshots=f"{RESULTS}/accuracy/hardness/{{variation}}/{{run}}.snapshots.csv",
        summary=f"{RESULTS}/accuracy/hardness/{{variation}}/{{run}}.json",
    log:
        f"{RESULTS}/logs/vary_closing_{{variation}}_{{run}}.log",
    params:
        closing_run=lambda wildcards: CLOSINGS[wildcards.run].model_dump(mode="json"),
        closing=lambda wildcards: varied(wildcards.variation, SCENE.hardness.closing)[0].model_dump(mode="json"),
        protocol=lambda wildcards: varied(wildcards.variation, SCENE.hardness.closing)[1].model_dump(mode="json"),
        work=f"{RESULTS}/work/vary_{{variation}}_{{run}}",
    message:
        "close asperity {wildcards.run} with {wildcards.variation}"


rule compare_closings:
    input:
        summaries=[f"{RESULTS}/accuracy/hardness/{name}/{SMALLEST.name}.json" for name in variations(SMALLEST)],
    output:
        table=f"{RESULTS}/accuracy/hardness.csv",
    log:
        f"{RESULTS}/logs/compare_closings.log",
    params:
        closing=HARDNESS["closing"],
    message:
        "compare the hardness of varied closing runs"
    script:
        "../scripts/compare_closings.py"


rule check_hardness_stability:
    input:
        **of_counter(SMALLEST.seed),
        **(of_base(SMALLEST) if SMALLEST.asperity.film_nm else {}),
        potential=POTENTIAL,
        glass=f"{RESULTS}/hardness/glass/{SMALLEST.seed}.data",
    output:
        table=f"{RESULTS}/stability/hardness.csv",
    log:
        f"{RESULTS}/logs/check_hardness_stability.log",
    params:
        material=HARDNESS["material"],
        counter_material=HARDNESS["closing"]["counter_material"],
        energy_scales=HARDNESS["energy_scales"],
        closing_run=SMALLEST.model_dump(mode="json"),
        closing=HARDNESS["closing"],
        work=f"{RESULTS}/work/stability_hardness",
    message:
        "check the molecular dynamics in hard cases"
    script:
        "../scripts/check_hardness_stability.py"
