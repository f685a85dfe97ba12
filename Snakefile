"""Asperity: contact mechanics of rough surfaces from atoms to device.

Choose a scene with `--config scene=NAME` (config/scenes/) or the path of your own YAML file.
"""

import fcntl
import os
import sys
import time
from pathlib import Path

from workflow.job import failures, file_checksum
from workflow.scene import ROOT, SceneError, load_scene

# one thread per process: the jobs themselves fill the cores, and results do not depend on their number
for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[variable] = "1"

try:
    SCENE = load_scene(config.get("scene", "reduced"))
except SceneError as error:
    for line in str(error).splitlines():
        print(f"ERROR {line}", file=sys.stderr)
    sys.exit(1)

RESULTS = f"results/{SCENE.name}"

writable = next(folder for folder in (Path(RESULTS), *Path(RESULTS).parents) if folder.exists())
if not (writable.is_dir() and os.access(writable, os.W_OK)):
    print(f"ERROR {RESULTS}: cannot write to {writable}; run in a folder you may write to", file=sys.stderr)
    sys.exit(1)

CONFIG = ROOT / "config"  # data files that ship with the project
STARTED = time.time()
RESOLVED = SCENE.model_dump(mode="json")
ACCURACY = []  # result files of the error-against-run-time studies, filled by the stages' rules
STABILITY = []  # result files of the stability studies


def settings(section):
    """Settings of one section as plain values for `params:`, so that a change re-runs just that stage."""
    return RESOLVED[section]


def needed(stage):
    """Does the report of this scene need `stage` (hardness, elastic or topography) computed?"""
    return stage in SCENE.stages()


include: "workflow/rules/scene.smk"
include: "workflow/rules/hardness.smk"
include: "workflow/rules/elastic.smk"
include: "workflow/rules/topography.smk"
include: "workflow/rules/inputs.smk"
include: "workflow/rules/curves.smk"
include: "workflow/rules/law.smk"
include: "workflow/rules/uncertainty.smk"
include: "workflow/rules/device.smk"
include: "workflow/rules/history.smk"
include: "workflow/rules/coupling.smk"
include: "workflow/rules/report.smk"


rule all:
    default_target: True
    input:
        f"{RESULTS}/report.html",
        # named too, so that what was deleted is made again although the report is there
        report_inputs(),
        rules.fit_law.input,


rule accuracy:
    input:
        ACCURACY,


rule stability:
    input:
        STABILITY,


onstart:
    # two runs of one scene would overwrite each other; the system frees this lock even after SIGKILL
    global run_lock
    try:
        Path(RESULTS).mkdir(parents=True, exist_ok=True)
        run_lock = open(f"{RESULTS}/.lock", "w")
        fcntl.flock(run_lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        print(f"ERROR {RESULTS}: another run of this scene is working here; wait for it or stop it", file=sys.stderr)
        sys.exit(1)


onsuccess:
    report = Path(RESULTS) / "report.html"
    print(f"results are in {RESULTS}" + (f"; the report is {report}" if report.exists() else ""))


onerror:
    # repeated at the very end, where a person looks first
    print("\n".join(["", *failures(Path(RESULTS) / "logs", STARTED)]), file=sys.stderr)
