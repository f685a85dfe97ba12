from atomistic.errors import InputError
from atomistic.hardness.runs import needs_counter_glass, planned_runs, settings_of_run
from atomistic.hardness.studies.cases import load_study
from atomistic.hardness.studies.variations import VARIATIONS, smallest_run

HARDNESS = settings("hardness")


def potential_path(name):
    """The file of a potential that is given by name or by path."""
    path = name if name.endswith((".yaml", ".yml")) else str(CONFIG / "potentials" / f"{name}.yaml")
    if needed("hardness") and not Path(path).exists():
        known = ", ".join(sorted(file.stem for file in (CONFIG / "potentials").glob("*.yaml")))
        scene = config.get("scene", "reduced")
        print(f"ERROR {scene}: hardness.potential: no file {path}; known potentials: {known}", file=sys.stderr)
        sys.exit(1)
    return path


POTENTIAL = potential_path(HARDNESS["potential"])
CLOSINGS = {run.name: run for run in planned_runs(SCENE.hardness)}
COUNTER_GLASS = needs_counter_glass(SCENE.hardness)


def of_run(pattern):
    """The file of every closing run."""
    return [f"{RESULTS}/hardness/{pattern.format(run=run)}" for run in CLOSINGS]


def of_counter(path):
    """As a named input: the glass of the counterface, where that is of another oxide."""
    return {"counter_glass": path} if COUNTER_GLASS else {}


wildcard_constraints:
    run="|".join(CLOSINGS),
    glass="\\d+",


rule hardness:
    input:
        f"{RESULTS}/hardness/fit.json",


rule make_glass:
    message:
        "melt and quench glass {wildcards.glass}"
    input:
        potential=POTENTIAL,
    output:
        atoms=f"{RESULTS}/hardness/glass/{{glass}}.data",
        properties=f"{RESULTS}/hardness/glass/{{glass}}.json",
    log:
        f"{RESULTS}/logs/make_glass_{{glass}}.log",
    params:
        material=HARDNESS["material"],
        glass=HARDNESS["glass"],
        seed=lambda wildcards: wildcards.glass,
        work=f"{RESULTS}/work/glass_{{glass}}",
    priority: 100
    script:
        "../scripts/make_glass.py"


use rule make_glass as make_counter_glass with:
    message:
        "melt and quench the counterface of glass {wildcards.glass}"
    input:
        potential=POTENTIAL,
        beside=f"{RESULTS}/hardness/glass/{{glass}}.data",
    output:
        atoms=f"{RESULTS}/hardness/glass/{{glass}}_counter.data",
        properties=f"{RESULTS}/hardness/glass/{{glass}}_counter.json",
    log:
        f"{RESULTS}/logs/make_counter_glass_{{glass}}.log",
    params:
        material=HARDNESS["closing"]["counter_material"],
        glass=HARDNESS["glass"],
        seed=lambda wildcards: wildcards.glass,
        work=f"{RESULTS}/work/counter_glass_{{glass}}",


rule run_closing:
    message:
        "close asperity {wildcards.run}"
    input:
        unpack(lambda wildcards: of_counter(f"{RESULTS}/hardness/glass/{CLOSINGS[wildcards.run].seed}_counter.data")),
        potential=POTENTIAL,
        glass=lambda wildcards: f"{RESULTS}/hardness/glass/{CLOSINGS[wildcards.run].seed}.data",
    output:
        curve=f"{RESULTS}/hardness/closing/{{run}}.csv",
        witness=f"{RESULTS}/hardness/witness/{{run}}.csv",
        snapshots=f"{RESULTS}/hardness/snapshots/{{run}}.csv",
        summary=f"{RESULTS}/hardness/runs/{{run}}.json",
    log:
        f"{RESULTS}/logs/run_closing_{{run}}.log",
    params:
        settings=lambda wildcards: settings_of_run(CLOSINGS[wildcards.run], SCENE.hardness),
        work=f"{RESULTS}/work/closing_{{run}}",
    threads: HARDNESS["closing"]["processes"]
    priority: 90
    script:
        "../scripts/run_closing.py"


rule find_hardness:
    message:
        "find the hardness of each closing run"
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
    script:
        "../scripts/find_hardness.py"


rule fit_hardness:
    message:
        "fit hardness against contact size"
    input:
        points=f"{RESULTS}/hardness/points.csv",
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
        settings={key: HARDNESS[key] for key in ("fit", "energy_scales")},
    script:
        "../scripts/fit_hardness.py"


rule plan_hardness:
    message:
        "estimate what the closing runs will cost"
    output:
        plan=f"{RESULTS}/hardness/plan.csv",
    log:
        f"{RESULTS}/logs/plan_hardness.log",
    params:
        settings=HARDNESS,
    script:
        "../scripts/plan_hardness.py"


# One knob at a time: accuracy/hardness.csv

ACCURACY.append(f"{RESULTS}/accuracy/hardness.csv")
ACCURACY.append(f"{RESULTS}/accuracy/hardness_detection.csv")
STABILITY.append(f"{RESULTS}/stability/hardness.csv")
SMALLEST = smallest_run(SCENE.hardness)


rule vary_closing:
    message:
        "close asperity {wildcards.run} with {wildcards.variation}"
    input:
        unpack(lambda wildcards: of_counter(f"{RESULTS}/hardness/glass/{SMALLEST.seed}_counter.data")),
        potential=POTENTIAL,
        glass=f"{RESULTS}/hardness/glass/{SMALLEST.seed}.data",
    output:
        curve=f"{RESULTS}/accuracy/hardness/{{variation}}/{{run}}.csv",
        witness=f"{RESULTS}/accuracy/hardness/{{variation}}/{{run}}.witness.csv",
        snapshots=f"{RESULTS}/accuracy/hardness/{{variation}}/{{run}}.snapshots.csv",
        summary=f"{RESULTS}/accuracy/hardness/{{variation}}/{{run}}.json",
    wildcard_constraints:
        variation="|".join(VARIATIONS),
    log:
        f"{RESULTS}/logs/vary_closing_{{variation}}_{{run}}.log",
    params:
        settings=lambda wildcards: {
            **settings_of_run(SMALLEST, SCENE.hardness),
            "closing": VARIATIONS[wildcards.variation].closing(SCENE.hardness).model_dump(),
        },
        work=f"{RESULTS}/work/vary_{{variation}}_{{run}}",
    script:
        "../scripts/run_closing.py"


rule compare_closings:
    message:
        "compare the hardness of varied closing runs"
    input:
        summaries=[f"{RESULTS}/accuracy/hardness/{name}/{SMALLEST.name}.json" for name in VARIATIONS],
    output:
        table=f"{RESULTS}/accuracy/hardness.csv",
    log:
        f"{RESULTS}/logs/compare_closings.log",
    params:
        settings=HARDNESS,
    script:
        "../scripts/compare_closings.py"


rule measure_detection:
    message:
        "measure how often yield is found where there is none, and missed where it is"
    input:
        curves=of_run("closing/{run}.csv"),
        witnesses=of_run("witness/{run}.csv"),
        points=f"{RESULTS}/hardness/points.csv",
    output:
        table=f"{RESULTS}/accuracy/hardness_detection.csv",
    log:
        f"{RESULTS}/logs/measure_detection.log",
    params:
        settings=HARDNESS,
    script:
        "../scripts/measure_detection.py"


rule check_hardness_stability:
    message:
        "check the molecular dynamics in hard cases"
    input:
        potentials=[str(path) for path in sorted((CONFIG / "potentials").glob("*.yaml"))],
    output:
        table=f"{RESULTS}/stability/hardness.csv",
    log:
        f"{RESULTS}/logs/check_hardness_stability.log",
    params:
        work=f"{RESULTS}/work/stability_hardness",
    script:
        "../scripts/check_hardness_stability.py"


# Single runs beyond a scene's own: study/hardness.csv

STUDY_FILE = CONFIG / "studies" / "hardness.yaml"
try:
    STUDY = load_study(STUDY_FILE, SCENE.hardness)
except InputError as error:
    print(f"ERROR {error}", file=sys.stderr)
    sys.exit(1)


def study_settings(wildcards):
    return STUDY[wildcards.case][1]


def study_glass(case):
    """The scene's own glass where the case needs no other."""
    own = STUDY[case][1]
    if all(getattr(own, key) == getattr(SCENE.hardness, key) for key in ("potential", "material", "glass")):
        return f"{RESULTS}/hardness/glass/{own.seeds[0]}.data"
    return f"{RESULTS}/study/glass/{case}.data"


def study_inputs(wildcards):
    files = {"glass": study_glass(wildcards.case), "potential": potential_path(study_settings(wildcards).potential)}
    if needs_counter_glass(study_settings(wildcards)):
        files["counter_glass"] = f"{RESULTS}/study/glass/{wildcards.case}_counter.data"
    return files


wildcard_constraints:
    case="|".join(STUDY),


rule hardness_study:
    input:
        f"{RESULTS}/study/hardness.csv",
        f"{RESULTS}/study/size_effect.json",


use rule make_glass as make_study_glass with:
    message:
        "melt and quench the glass of {wildcards.case}"
    input:
        potential=lambda wildcards: potential_path(study_settings(wildcards).potential),
    output:
        atoms=f"{RESULTS}/study/glass/{{case}}.data",
        properties=f"{RESULTS}/study/glass/{{case}}.json",
    log:
        f"{RESULTS}/logs/make_study_glass_{{case}}.log",
    params:
        material=lambda wildcards: study_settings(wildcards).material,
        glass=lambda wildcards: study_settings(wildcards).glass.model_dump(),
        seed=lambda wildcards: study_settings(wildcards).seeds[0],
        work=f"{RESULTS}/work/study_glass_{{case}}",


use rule make_study_glass as make_study_counter_glass with:
    message:
        "melt and quench the counterface of {wildcards.case}"
    input:
        potential=lambda wildcards: potential_path(study_settings(wildcards).potential),
        beside=lambda wildcards: study_glass(wildcards.case),
    output:
        atoms=f"{RESULTS}/study/glass/{{case}}_counter.data",
        properties=f"{RESULTS}/study/glass/{{case}}_counter.json",
    log:
        f"{RESULTS}/logs/make_study_counter_glass_{{case}}.log",
    params:
        material=lambda wildcards: study_settings(wildcards).closing.counter_material,
        glass=lambda wildcards: study_settings(wildcards).glass.model_dump(),
        seed=lambda wildcards: study_settings(wildcards).seeds[0],
        work=f"{RESULTS}/work/study_counter_glass_{{case}}",


rule run_study_case:
    message:
        "close the asperity of {wildcards.case}"
    input:
        unpack(study_inputs),
    output:
        curve=f"{RESULTS}/study/hardness/{{case}}.csv",
        witness=f"{RESULTS}/study/hardness/{{case}}.witness.csv",
        snapshots=f"{RESULTS}/study/hardness/{{case}}.snapshots.csv",
        summary=f"{RESULTS}/study/hardness/{{case}}.json",
    log:
        f"{RESULTS}/logs/run_study_case_{{case}}.log",
    params:
        settings=lambda wildcards: study_settings(wildcards).model_dump(),
        work=f"{RESULTS}/work/study_{{case}}",
    script:
        "../scripts/run_closing.py"


rule collect_hardness_study:
    message:
        "collect the study of hardness"
    input:
        study=STUDY_FILE,
        curves=expand(f"{RESULTS}/study/hardness/{{case}}.csv", case=STUDY),
        witnesses=expand(f"{RESULTS}/study/hardness/{{case}}.witness.csv", case=STUDY),
        summaries=expand(f"{RESULTS}/study/hardness/{{case}}.json", case=STUDY),
    output:
        points=f"{RESULTS}/study/hardness.csv",
    log:
        f"{RESULTS}/logs/collect_hardness_study.log",
    params:
        settings=[own.model_dump() for _, own in STUDY.values()],
        labels=[{"case": case.name, "about": case.about} for case, _ in STUDY.values()],
    script:
        "../scripts/find_hardness.py"


rule fit_all_sizes:
    message:
        "fit the size effect to all runs"
    input:
        points=f"{RESULTS}/hardness/points.csv",
        study=f"{RESULTS}/study/hardness.csv",
    output:
        fit=f"{RESULTS}/study/size_effect.json",
    log:
        f"{RESULTS}/logs/fit_all_sizes.log",
    params:
        settings={"fit": HARDNESS["fit"]},
        cases=[
            name
            for name, (_, own) in STUDY.items()
            if own.model_copy(update=dict.fromkeys(("asperities", "seeds", "energy_scales")))
            == SCENE.hardness.model_copy(update=dict.fromkeys(("asperities", "seeds", "energy_scales")))
        ],
    script:
        "../scripts/fit_all_sizes.py"
