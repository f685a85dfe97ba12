from atomistic.hardness.runs import PROTOCOL
from workflow.scene.hardness_files import check_bodies, hardness_files

HARDNESS = settings("hardness")
CLOSING_S = {}  # seconds of each closing run
UNFIT = (
    ""  # why the closings cannot be run; of a scene that needs none, it refuses the target alone
)
try:
    BODIES = hardness_files(
        SCENE.hardness, MATERIALS, CONFIG, lambda path: named_files("hardness.potential", path)[0]
    )
    if IS_CHECKED_HERE:
        CLOSING_S = check_bodies(SCENE.hardness, BODIES, MATERIALS)
except InputError as error:
    UNFIT = str(error)
    if needed("hardness"):
        refuse(f"{SCENE_GIVEN}: {UNFIT}")
CLOSINGS = BODIES.closings
BASE = BODIES.base
H_MACRO = SCENE.inputs.priors().h_macro  # the runs give H' beside it
H_MACRO_FILE = (
    named_files("inputs.h_macro.values", H_MACRO.values) if isinstance(H_MACRO.values, str) else []
)


BODY_FILES = [BODIES.material, BODIES.potential]
BASE_FILES = [BASE] if BASE else []  # of what lies below films


wildcard_constraints:
    run="|".join(CLOSINGS),
    glass="\\d+",
    tiles="\\d+",


rule make_glass:
    input:
        required(not UNFIT, UNFIT),
        material=BODIES.material,
        potential=BODIES.potential,
    output:
        atoms=f"{RESULTS}/hardness/glass/{{glass}}.data",
        properties=f"{RESULTS}/hardness/glass/{{glass}}.json",
    log:
        f"{RESULTS}/logs/make_glass_{{glass}}.log",
    priority: 100
    params:
        contents=contents(*BODY_FILES),
        glass=HARDNESS["glass"],
        seed=lambda wildcards: wildcards.glass,
        work=f"{RESULTS}/work/glass_{{glass}}",
    message:
        "melt and quench glass {wildcards.glass}"
    script:
        "../scripts/make_glass.py"


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
        contents=contents(*BASE_FILES),
        tiles=lambda wildcards: int(wildcards.tiles),
        seed=lambda wildcards: int(wildcards.glass),
        work=f"{RESULTS}/work/base_{{glass}}_{{tiles}}",
    message:
        "make base {wildcards.glass}, {wildcards.tiles} glass cells wide"
    script:
        "../scripts/make_base.py"


rule run_closing:
    input:
        unpack(lambda wildcards: of_base(CLOSINGS[wildcards.run])),
        material=BODIES.material,
        potential=BODIES.potential,
        glass=lambda wildcards: f"{RESULTS}/hardness/glass/{CLOSINGS[wildcards.run].seed}.data",
    output:
        curve=f"{RESULTS}/hardness/closing/{{run}}.csv",
        witness=f"{RESULTS}/hardness/witness/{{run}}.csv",
        summary=f"{RESULTS}/hardness/runs/{{run}}.json",
    log:
        f"{RESULTS}/logs/run_closing_{{run}}.log",
    priority: 90
    threads: HARDNESS["closing"]["processes"]
    params:
        contents=lambda wildcards: contents(*BODY_FILES, *base_files(CLOSINGS[wildcards.run])),
        closing_run=lambda wildcards: CLOSINGS[wildcards.run].model_dump(mode="json"),
        closing=HARDNESS["closing"],
        protocol=PROTOCOL.model_dump(mode="json"),
        work=f"{RESULTS}/work/closing_{{run}}",
    message:
        "close asperity {wildcards.run}"
    script:
        "../scripts/run_closing.py"


rule hardness:
    """hardness from molecular dynamics"""
    input:
        curves=of_run("closing/{run}.csv"),
        witnesses=of_run("witness/{run}.csv"),
        summaries=of_run("runs/{run}.json"),
        material=BODIES.material,
        base_material=BASE or [],
        potential=BODIES.potential,
        glasses=[
            f"{RESULTS}/hardness/glass/{seed}.json" for seed in dict.fromkeys(SCENE.hardness.seeds)
        ],
        h_macro=H_MACRO_FILE,
    output:
        points=captioned(f"{RESULTS}/hardness/points.csv"),
        fit=f"{RESULTS}/hardness/fit.json",
    log:
        f"{RESULTS}/logs/hardness.log",
    params:
        contents=contents(*BODY_FILES, *BASE_FILES, *H_MACRO_FILE),
        potential=HARDNESS["potential"],
        energies=HARDNESS["energies"],
        h_macro=H_MACRO.model_dump(mode="json"),
    message:
        "find the hardness of each closing run and fit it"
    script:
        "../scripts/fit_hardness.py"


if needed("hardness") and is_used(rules.hardness):
    SHOWN += [*rules.hardness.output, *rules.hardness.input.curves, *rules.hardness.input.witnesses]
    KEPT += [
        *rules.hardness.input.summaries,
        *expand(rules.make_glass.output, glass=SCENE.hardness.seeds),
    ]
