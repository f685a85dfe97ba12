# Studies of the hardness stage: one knob at a time, hard cases, and single runs beyond a scene's own

from atomistic.errors import InputError
from atomistic.hardness.runs import needs_counter_glass, settings_of_run
from atomistic.hardness.studies.cases import load_study
from atomistic.hardness.studies.variations import VARIATIONS, smallest_run

# One knob at a time: accuracy/hardness.csv

if needed("hardness"):
    ACCURACY += [f"{RESULTS}/accuracy/hardness.csv", f"{RESULTS}/accuracy/hardness_detection.csv"]
    STABILITY.append(f"{RESULTS}/stability/hardness.csv")
SMALLEST = smallest_run(SCENE.hardness)


rule vary_closing:
    input:
        unpack(lambda wildcards: of_counter(f"{RESULTS}/hardness/glass/{SMALLEST.seed}_counter.data")),
        material=MATERIAL_OF_ASPERITY,
        potential=POTENTIAL,
        glass=f"{RESULTS}/hardness/glass/{SMALLEST.seed}.data",
    output:
        curve=f"{RESULTS}/accuracy/hardness/{{variation}}/{{run}}.csv",
        witness=f"{RESULTS}/accuracy/hardness/{{variation}}/{{run}}.witness.csv",
        snapshots=f"{RESULTS}/accuracy/hardness/{{variation}}/{{run}}.snapshots.csv",
        summary=f"{RESULTS}/accuracy/hardness/{{variation}}/{{run}}.json",
    log:
        f"{RESULTS}/logs/vary_closing_{{variation}}_{{run}}.log",
    wildcard_constraints:
        variation="|".join(VARIATIONS),
    params:
        settings=lambda wildcards: {
            **settings_of_run(SMALLEST, SCENE.hardness),
            "closing": VARIATIONS[wildcards.variation].closing(SCENE.hardness).model_dump(),
        },
        work=f"{RESULTS}/work/vary_{{variation}}_{{run}}",
    message:
        "close asperity {wildcards.run} with {wildcards.variation}"
    script:
        "../scripts/run_closing.py"


rule compare_closings:
    input:
        summaries=[f"{RESULTS}/accuracy/hardness/{name}/{SMALLEST.name}.json" for name in VARIATIONS],
    output:
        table=f"{RESULTS}/accuracy/hardness.csv",
    log:
        f"{RESULTS}/logs/compare_closings.log",
    params:
        settings=HARDNESS,
    message:
        "compare the hardness of varied closing runs"
    script:
        "../scripts/compare_closings.py"


rule hardness_area:
    input:
        f"{RESULTS}/accuracy/hardness_area.csv",


rule measure_area:
    input:
        unpack(lambda wildcards: of_counter(f"{RESULTS}/hardness/glass/{SMALLEST.seed}_counter.data")),
        potential=POTENTIAL,
        glass=f"{RESULTS}/hardness/glass/{SMALLEST.seed}.data",
    output:
        table=f"{RESULTS}/accuracy/hardness_area.csv",
    log:
        f"{RESULTS}/logs/measure_area.log",
    params:
        settings=HARDNESS,
        work=f"{RESULTS}/work/area",
    message:
        "measure the contact area of bodies of known section"
    script:
        "../scripts/measure_area.py"


rule measure_detection:
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
    message:
        "measure how often yield is found where there is none, and missed where it is"
    script:
        "../scripts/measure_detection.py"


rule check_hardness_stability:
    input:
        potentials=[str(path) for path in sorted((CONFIG / "potentials").glob("*.yaml"))],
        materials=[material_path(oxide) for oxide in OXIDES.values()],
    output:
        table=f"{RESULTS}/stability/hardness.csv",
    log:
        f"{RESULTS}/logs/check_hardness_stability.log",
    params:
        work=f"{RESULTS}/work/stability_hardness",
    message:
        "check the molecular dynamics in hard cases"
    script:
        "../scripts/check_hardness_stability.py"


# Single runs beyond a scene's own: study/hardness.csv

HARDNESS_STUDY_FILE = CONFIG / "studies" / "hardness.yaml"
try:
    HARDNESS_STUDY = load_study(HARDNESS_STUDY_FILE, SCENE.hardness)
except InputError as error:
    refuse(error)


def study_settings(wildcards):
    return HARDNESS_STUDY[wildcards.case][1]


def study_glass(case):
    """The scene's own glass where the case needs no other."""
    own = HARDNESS_STUDY[case][1]
    if all(getattr(own, key) == getattr(SCENE.hardness, key) for key in ("potential", "material", "glass")):
        return f"{RESULTS}/hardness/glass/{own.seeds[0]}.data"
    return f"{RESULTS}/study/glass/{case}.data"


def study_material(wildcards):
    return oxide_path("material", study_settings(wildcards).material)


def study_inputs(wildcards):
    files = {
        "material": study_material(wildcards),
        "glass": study_glass(wildcards.case),
        "potential": potential_path("potential", study_settings(wildcards).potential),
    }
    if needs_counter_glass(study_settings(wildcards)):
        files["counter_glass"] = f"{RESULTS}/study/glass/{wildcards.case}_counter.data"
        files["counter_potential"] = counter_potential(study_settings(wildcards))
    return files


wildcard_constraints:
    case="|".join(HARDNESS_STUDY),


rule hardness_study:
    input:
        f"{RESULTS}/study/hardness.csv",
        f"{RESULTS}/study/size_effect.json",


use rule make_glass as make_study_glass with:
    input:
        material=study_material,
        potential=lambda wildcards: potential_path("potential", study_settings(wildcards).potential),
    output:
        atoms=f"{RESULTS}/study/glass/{{case}}.data",
        properties=f"{RESULTS}/study/glass/{{case}}.json",
    log:
        f"{RESULTS}/logs/make_study_glass_{{case}}.log",
    params:
        glass=lambda wildcards: study_settings(wildcards).glass.model_dump(),
        seed=lambda wildcards: study_settings(wildcards).seeds[0],
        work=f"{RESULTS}/work/study_glass_{{case}}",
    message:
        "melt and quench the glass of {wildcards.case}"


use rule make_study_glass as make_study_counter_glass with:
    input:
        material=lambda wildcards: oxide_path(
            "closing.counter_material", study_settings(wildcards).closing.counter_material
        ),
        potential=lambda wildcards: counter_potential(study_settings(wildcards)),
        beside=lambda wildcards: study_glass(wildcards.case),
    output:
        atoms=f"{RESULTS}/study/glass/{{case}}_counter.data",
        properties=f"{RESULTS}/study/glass/{{case}}_counter.json",
    log:
        f"{RESULTS}/logs/make_study_counter_glass_{{case}}.log",
    params:
        glass=lambda wildcards: study_settings(wildcards).glass.model_dump(),
        seed=lambda wildcards: study_settings(wildcards).seeds[0],
        work=f"{RESULTS}/work/study_counter_glass_{{case}}",
    message:
        "melt and quench the counterface of {wildcards.case}"


rule run_study_case:
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
    message:
        "close the asperity of {wildcards.case}"
    script:
        "../scripts/run_closing.py"


rule collect_hardness_study:
    input:
        study=HARDNESS_STUDY_FILE,
        curves=expand(f"{RESULTS}/study/hardness/{{case}}.csv", case=HARDNESS_STUDY),
        witnesses=expand(f"{RESULTS}/study/hardness/{{case}}.witness.csv", case=HARDNESS_STUDY),
        summaries=expand(f"{RESULTS}/study/hardness/{{case}}.json", case=HARDNESS_STUDY),
    output:
        points=f"{RESULTS}/study/hardness.csv",
    log:
        f"{RESULTS}/logs/collect_hardness_study.log",
    params:
        settings=[own.model_dump() for _, own in HARDNESS_STUDY.values()],
        labels=[{"case": case.name, "about": case.about} for case, _ in HARDNESS_STUDY.values()],
    message:
        "collect the study of hardness"
    script:
        "../scripts/find_hardness.py"


rule fit_all_sizes:
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
            for name, (_, own) in HARDNESS_STUDY.items()
            if own.model_copy(update=dict.fromkeys(("asperities", "seeds", "energy_scales")))
            == SCENE.hardness.model_copy(update=dict.fromkeys(("asperities", "seeds", "energy_scales")))
        ],
    message:
        "fit the size effect to all runs"
    script:
        "../scripts/fit_all_sizes.py"
