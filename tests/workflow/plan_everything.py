"""Plan every target of every shipped scene in one process; prints rows of scene, target and the
refusal, if any.
"""

import contextlib
import io
import json
from collections.abc import Callable
from pathlib import Path

from snakemake.api import SnakemakeApi, WorkflowApi
from snakemake.settings.types import (
    ConfigSettings,
    DAGSettings,
    ExecutionSettings,
    OutputSettings,
    Quietness,
    ResourceSettings,
)

from asperity.__main__ import targets
from asperity.guards.bundle import ROOT


def refusal(plan: Callable[[], object]) -> str:
    """The last line that a plan wrote before it ended itself; empty where it stands."""
    said = io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
        try:
            plan()
        except SystemExit:
            return said.getvalue().strip().splitlines()[-1]
    return ""


def read(api: SnakemakeApi, scene: str) -> WorkflowApi:
    """The workflow of a scene."""
    return api.workflow(
        resource_settings=ResourceSettings(cores=2),
        config_settings=ConfigSettings(config={"scene": scene}, config_args=(f"scene={scene}",)),
        snakefile=ROOT / "Snakefile",
        workdir=Path.cwd(),
    )


def plan(workflow: WorkflowApi, target: str) -> None:
    """Plan one target."""
    jobs = workflow.dag(DAGSettings(targets={target}))
    jobs.execute_workflow(executor="dryrun", execution_settings=ExecutionSettings(lock=False))


rows = []
with SnakemakeApi(OutputSettings(dryrun=True, quiet={Quietness.ALL})) as api:
    for scene in sorted(path.stem for path in (ROOT / "config" / "scenes").glob("*.yaml")):
        workflow = read(api, scene)
        rows += [
            (scene, target, refusal(lambda name=target, of=workflow: plan(of, name)))
            for target in targets()
        ]
print(json.dumps(rows))
