"""Scenes planned in this process, for tests and studies that plan many of them."""

from collections.abc import Set
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

from asperity.guards.bundle import ROOT


def silent_api() -> SnakemakeApi:
    """Snakemake that says nothing and runs nothing; to be used as a context."""
    return SnakemakeApi(OutputSettings(dryrun=True, quiet={Quietness.ALL}))


def read(api: SnakemakeApi, scene: str) -> WorkflowApi:
    """The workflow of a scene, in the working folder."""
    return api.workflow(
        resource_settings=ResourceSettings(cores=2),
        config_settings=ConfigSettings(config={"scene": scene}, config_args=(f"scene={scene}",)),
        snakefile=ROOT / "Snakefile",
        workdir=Path.cwd(),
    )


def plan(workflow: WorkflowApi, targets: Set[str]) -> None:
    """Plan targets; none are what a run without a target makes."""
    jobs = workflow.dag(DAGSettings(targets=set(targets)))
    jobs.execute_workflow(executor="dryrun", execution_settings=ExecutionSettings(lock=False))
