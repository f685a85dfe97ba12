from atomistic.runs import planned_runs

HARDNESS = settings("hardness")
POTENTIAL = HARDNESS["potential"]
if not POTENTIAL.endswith((".yaml", ".yml")):  # a name, not a path
    POTENTIAL = str(CONFIG / "potentials" / f"{POTENTIAL}.yaml")
if needed("hardness") and not Path(POTENTIAL).exists():
    known = ", ".join(sorted(path.stem for path in (CONFIG / "potentials").glob("*.yaml")))
    print(
        f"ERROR {config.get('scene', 'reduced')}: hardness.potential: no file {POTENTIAL}; known potentials: {known}",
        file=sys.stderr,
    )
    sys.exit(1)
CLOSINGS = {run.name: run for run in planned_runs(SCENE.hardness)}


def of_run(pattern):
    """The file of every closing run."""
    return [f"{RESULTS}/hardness/{pattern.format(run=run)}" for run in CLOSINGS]


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
        settings={key: HARDNESS[key] for key in ("material", "glass")},
        work=f"{RESULTS}/work/glass_{{glass}}",
    priority: 100
    script:
        "../scripts/make_glass.py"


rule run_closing:
    message:
        "close asperity {wildcards.run}"
    input:
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
        settings={key: HARDNESS[key] for key in ("material", "closing", "area")},
        asperity=lambda wildcards: CLOSINGS[wildcards.run].asperity.model_dump(),
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
        settings={key: HARDNESS[key] for key in ("closing", "plasticity", "potential")},
    script:
        "../scripts/find_hardness.py"


rule fit_hardness:
    message:
        "fit hardness against contact size"
    input:
        points=f"{RESULTS}/hardness/points.csv",
        glasses=[f"{RESULTS}/hardness/glass/{seed}.json" for seed in dict.fromkeys(SCENE.hardness.seeds)],
    output:
        fit=f"{RESULTS}/hardness/fit.json",
    log:
        f"{RESULTS}/logs/fit_hardness.log",
    params:
        settings={key: HARDNESS[key] for key in ("fit", "energy_scales")},
    script:
        "../scripts/fit_hardness.py"


from atomistic.variations import VARIATIONS, smallest_run

ACCURACY.append(f"{RESULTS}/accuracy/hardness.csv")
STABILITY.append(f"{RESULTS}/stability/hardness.csv")
SMALLEST = smallest_run(SCENE.hardness)


rule vary_closing:
    message:
        "close asperity {wildcards.run} with {wildcards.variation}"
    input:
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
            "material": HARDNESS["material"],
            "area": HARDNESS["area"],
            "closing": VARIATIONS[wildcards.variation].closing(SCENE.hardness).model_dump(),
        },
        asperity=SMALLEST.asperity.model_dump(),
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
