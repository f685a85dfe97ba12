from atomistic.hardness.runs import needs_counter_glass, planned_runs, settings_of_run

HARDNESS = settings("hardness")


def potential_path(key, name):
    """The file of a potential that `hardness` gives by name or by path."""
    if name.endswith((".yaml", ".yml")):
        return named_files(f"hardness.{key}", name)[0] if needed("hardness") else name
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


def counter_potential(hardness):
    """The file of the potential of a counterface of oxide: its own, or that of the asperity."""
    if hardness.closing.counter_potential is None:
        return potential_path("potential", hardness.potential)
    return potential_path("closing.counter_potential", hardness.closing.counter_potential)


POTENTIAL = potential_path("potential", HARDNESS["potential"])
MATERIAL_OF_ASPERITY = oxide_path("material", HARDNESS["material"])
MATERIAL_OF_COUNTERFACE = oxide_path("closing.counter_material", HARDNESS["closing"]["counter_material"])
CLOSINGS = {run.name: run for run in planned_runs(SCENE.hardness)}
COUNTER_GLASS = needs_counter_glass(SCENE.hardness)


def of_run(pattern):
    """The file of every closing run."""
    return [f"{RESULTS}/hardness/{pattern.format(run=run)}" for run in CLOSINGS]


def of_counter(path):
    """As named inputs: glass and potential of the counterface, where that is of another oxide or potential."""
    return {"counter_glass": path, "counter_potential": counter_potential(SCENE.hardness)} if COUNTER_GLASS else {}


wildcard_constraints:
    run="|".join(CLOSINGS),
    glass="\\d+",


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
        potential=counter_potential(SCENE.hardness),
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


rule run_closing:
    input:
        unpack(lambda wildcards: of_counter(f"{RESULTS}/hardness/glass/{CLOSINGS[wildcards.run].seed}_counter.data")),
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
        settings=lambda wildcards: settings_of_run(CLOSINGS[wildcards.run], SCENE.hardness),
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
        settings=[{key: HARDNESS[key] for key in ("closing", "plasticity", "potential")}] * len(CLOSINGS),
    message:
        "find the hardness of each closing run"
    script:
        "../scripts/find_hardness.py"


rule fit_hardness:
    input:
        points=f"{RESULTS}/hardness/points.csv",
        potential=POTENTIAL,
        counter_potentials=[counter_potential(SCENE.hardness)] if COUNTER_GLASS else [],
        glasses=[
            f"{RESULTS}/hardness/glass/{seed}{body}.json"
            for seed in dict.fromkeys(SCENE.hardness.seeds)
            for body in ("", *(["_counter"] if COUNTER_GLASS else []))
        ],
    output:
        fit=report(f"{RESULTS}/hardness/fit.json", caption="../captions/hardness.rst", category="Inputs"),
    log:
        f"{RESULTS}/logs/fit_hardness.log",
    params:
        settings={key: HARDNESS[key] for key in ("fit", "energy_scales", "area")},
    message:
        "fit hardness against contact size"
    script:
        "../scripts/fit_hardness.py"


rule plan_hardness:
    input:
        material=MATERIAL_OF_ASPERITY,
        counter_material=MATERIAL_OF_COUNTERFACE,
    output:
        plan=f"{RESULTS}/hardness/plan.csv",
    log:
        f"{RESULTS}/logs/plan_hardness.log",
    params:
        settings=HARDNESS,
    message:
        "estimate what the closing runs will cost"
    script:
        "../scripts/plan_hardness.py"
