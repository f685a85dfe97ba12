# Shared by all rule files - the scene, where its results go, and what several of them ask

import os
from pathlib import Path

from asperity.guards.bundle import ROOT, bind_workflow

bind_workflow()  # a host workflow may have a package of this name

from workflow.run.process import prepare_process

prepare_process()  # before anything imports numba

from asperity.guards.foreign_text import from_word
from asperity.guards.errors import InputError
from atomistic.materials import load_materials, oxide_glasses
from workflow.run.installed import missing_packages
from workflow.run.refuse import refuse
from workflow.run.whole import Run
from workflow.scene.memory import contact_MB, propagation_MB
from workflow.files.checksums import content_checksums
from workflow.scene import SceneError, files_of, load_scene, locate

# one thread a process: jobs fill the cores, and results do not depend on their number
for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[variable] = "1"


SCENE_GIVEN = from_word(str(config.get("scene", "reduced")))  # a name or a path
for argument in workflow.config_settings.config_args or ():
    if argument.startswith("scene=") and from_word(argument.removeprefix("scene=")) != SCENE_GIVEN:
        refuse(
            f"{argument}: Snakemake reads {SCENE_GIVEN!r}; rename the file, or: asperity run FILE"
        )
try:
    SCENE = load_scene(SCENE_GIVEN)
except SceneError as error:
    refuse(error)

RESULTS = f"results/{SCENE.name}"

for folder in (Path(RESULTS), Path(RESULTS).parent):
    if os.path.islink(folder) and not os.path.exists(
        folder
    ):  # unlike Path.exists, False where one may not look
        refuse(
            f"{folder}: a link to {os.readlink(folder)}, which is not there;"
            " mount it, or remove the link"
        )
writable = next(
    folder for folder in (Path(RESULTS), *Path(RESULTS).parents) if os.path.exists(folder)
)
if not (writable.is_dir() and os.access(writable, os.W_OK)):
    refuse(f"{RESULTS}: cannot write to {writable}; run in a folder you may write to")

# a job reads what the main process has checked; with Snakemake alone rules are only linted
IS_CHECKED_HERE = workflow.is_main_process and not missing_packages()
CONTACT_MB = contact_MB(SCENE.contact)
PROPAGATION_MB = propagation_MB(SCENE.uncertainty)


# with --sdm apptainer: the image of workflow/Containerfile in the working folder (docs/cluster.md)
container: "asperity.sif"


CONFIG = ROOT / "config"  # data files that ship with the project
try:
    MATERIALS = load_materials(CONFIG / "materials")
except InputError as error:
    refuse(error)
OXIDES = oxide_glasses(MATERIALS.values())  # by formula
SHOWN = []  # files of the stages that the scene uses, of which the page is made
KEPT = []  # what jobs of these stages leave besides; a lost one is made again


def settings(section):
    """One section as plain values for `params:`, so that a change re-runs just that stage."""
    return RESOLVED[section]


def contents(*paths):
    """Checksums of files that no job makes, for `params:`.

    What reads them follows their content, whatever the date.
    """
    return content_checksums(paths)


def named_files(key, *names):
    """Paths of files that the scene names under a key; missing ones are refused."""
    try:
        return locate(SCENE_GIVEN, key, names)
    except SceneError as error:
        refuse(error)


def with_found_samples(scene):
    """The scene with the paths of its files of departures (device.spread), and these paths."""
    rows, found = {}, []
    for name in scene.device.varied:
        row = getattr(scene.device.spread, name)
        if isinstance(row.values, str):
            found += named_files(f"device.spread.{name}.values", row.values)
            rows[name] = row.model_copy(update={"values": found[-1]})
    spread = scene.device.spread.model_copy(update=rows)
    device = scene.device.model_copy(update={"spread": spread})
    return (scene.model_copy(update={"device": device}), found) if found else (scene, [])


SCENE, SPREAD_FILES = with_found_samples(SCENE)
RESOLVED = SCENE.model_dump(mode="json")


def material_path(material):
    """The file of a material."""
    return str(CONFIG / "materials" / f"{material.name}.yaml")


def required(is_there, words):
    """No input where a scene has what a target needs; else what refuses the target."""
    line = f"{SCENE_GIVEN}: {words}"
    return [] if is_there else lambda wildcards: refuse(line)


def needed(stage):
    """Does the report of this scene need `stage` (hardness, elastic or topography) computed?"""
    return stage in SCENE.stages()


def captioned(table):
    """A table for `snakemake --report`, with its caption in a file of the same name."""
    name = Path(table).relative_to(RESULTS).with_suffix("")
    return report(
        table,
        caption=f"../report/captions/{name}.rst",
        category="Tables",
        labels={"table": str(name)},
    )


def is_used(proxy):
    """Is this rule part of the run? A host workflow may exclude one and make its files itself."""
    return any(rule is proxy.rule for rule in workflow.rules)


def of_run(pattern):
    """The file of every closing run."""
    return [f"{RESULTS}/hardness/{pattern.format(run=run)}" for run in CLOSINGS]


def base_files(run):
    """Files of what lies below the film of a closing run."""
    return [] if run.asperity.film_nm is None else [BASE]


def of_base(run):
    """As named inputs: what lies below a film, and the cell of it that fits the asperity."""
    if run.asperity.film_nm is None:
        return {}
    return {
        "base": f"{RESULTS}/hardness/base/{run.seed}_{run.asperity.tiles}.data",
        "base_material": BASE,
    }


def measured(*scans):
    """Those of these scans that no job makes."""
    return scans if TOPOGRAPHY.scans else []


def scan_files():
    """The scans to analyse: the user's own, or the synthetic ones that the workflow writes."""
    if not TOPOGRAPHY.scans:
        synthetic = TOPOGRAPHY.synthetic
        names = [f"small_{k + 1:02d}" for k in range(synthetic.small_scans)]
        names += [f"large_{k + 1:02d}" for k in range(synthetic.large_scans)]
        return [f"{SCAN_FOLDER}/{name}.gwy" for name in names]
    try:
        return named_files("topography.scans", *files_of(SCENE_GIVEN, TOPOGRAPHY.scans))
    except SceneError as error:
        refuse(error)


def studies_of(kind):
    """The tables of a kind of study: those of the stages that the scene uses."""
    return [f"{RESULTS}/{kind}/{stage}.csv" for stage, (_, used) in OF_STAGE.items() if used]


def files_of_study(wildcards):
    """As named inputs: what a study reads; a stage that the scene does not use is refused."""
    files, used = OF_STAGE[wildcards.stage]
    words = (
        f"target accuracy or stability: the scene does not use the stage {wildcards.stage};"
        " nothing to study"
    )
    return {
        "used": required(used, words),
        **files,
        **ALSO_READ.get(f"{wildcards.kind}/{wildcards.stage}", {}),
    }


RUN = Run(workflow, SCENE_GIVEN, SCENE, RESULTS, config)
RUN.look()
