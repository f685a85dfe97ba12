"""A run of Snakemake on a scene, from its first look at the results to its last words."""

import sys
import time
import webbrowser
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

from snakemake.logging import logger

from asperity.guards.bundle import ROOT
from asperity.guards.foreign_text import shown, wrapped
from workflow.files.checksums import remove_unfinished
from workflow.run import ownership
from workflow.run.damage import renew_damaged
from workflow.run.installed import missing_packages
from workflow.run.last_words import answer_words, foreign_results, where_results_are
from workflow.run.process import obey_signals
from workflow.run.refuse import refuse
from workflow.scene import SCENES, Scene, find_scene

OWN_SNAKEFILES = (ROOT / "Snakefile", ROOT / "workflow/Snakefile")


class Run:
    """What a run does beside its jobs. Jobs are processes of Snakemake, too, and do nothing of it.

    Parameters
    ----------
    workflow : Snakemake's.
    scene_given : the scene as the user gave it, a name or a path.
    scene : the same, read.
    results : folder of its results.
    config : Snakemake's, of which `hours` and `show` are read.
    """

    def __init__(
        self,
        workflow: Any,
        scene_given: str,
        scene: Scene,
        results: str,
        config: Mapping[str, Any],
    ) -> None:
        self._workflow = workflow
        self._scene_given = scene_given
        self._scene = scene
        self._results = Path(results)
        self._config = config
        self._started = time.time()
        self._lock: int | None = None
        self._studies: Collection[str] = ()
        self._terminal: Any = None

    def look(self) -> None:
        """Refuse a folder of results that holds traps, is another scene's, or is in use."""
        if not self._has_results():
            return
        try:
            ownership.inspect(self._results)
        except ownership.Refused as error:
            refuse(error)
        self._own(write=False)

    def renew(self) -> None:
        """Let damaged results be made again."""
        if self._has_results():
            renew_damaged(self._results, self._is_made, self._workflow.output_settings.dryrun)

    def speak(self, closing_s: Mapping[str, float], studies: Collection[str]) -> None:
        """Let the terminal tell what goes on in our words; a host workflow has its own.

        Parameters
        ----------
        closing_s : seconds of each closing run.
        studies : tables of studies of this scene.
        """
        self._studies = studies
        if not self._workflow.is_main_process or self._is_hosted or missing_packages():
            return
        from workflow.run.cost import LONGEST_RUN_H, Costs  # takes a second: not in every job
        from workflow.run.progress import speak

        hours = self._config.get("hours", LONGEST_RUN_H)
        if isinstance(hours, bool) or not isinstance(hours, (int, float)) or not hours > 0:
            refuse(
                f"hours={hours}: accepted is a number > 0, the hours that a run may take on this"
                " machine"
            )
        nothing_to_do = f"nothing to do: {self._where()}"
        costs = Costs(self._scene, closing_s)
        self._terminal = speak(self._workflow, logger, costs, nothing_to_do, hours)

    def start(self) -> None:
        """Take the folder of results, before the first job."""
        if missing := missing_packages():
            refuse(
                f"{', '.join(missing)}: not installed; running a scene needs pip install"
                " 'asperity-contact[run]'"
            )
        if self._terminal is not None and self._terminal.refusal:
            refuse(f"{self._scene_given}: {self._terminal.refusal}")
        self._results.mkdir(parents=True, exist_ok=True)
        self._own(write=True)
        remove_unfinished(self._results)
        obey_signals(self._workflow)

    def succeed(self) -> None:
        """Say what came out, and where it lies."""
        has_scans = bool(self._scene.topography.scans)
        for line in answer_words(self._results, self._started, has_scans):
            print(wrapped(line))
        print(self._where())
        for line in foreign_results(self._results, self._is_made):
            print(wrapped(shown(line)))
        if self._config.get("show"):
            webbrowser.open((self._results / "report.html").resolve().as_uri())

    def fail(self) -> None:
        """Repeat why jobs failed at the very end, where a person looks first."""
        from workflow.run.job import failures  # with the schemas of all tables

        lines = map(shown, failures(self._results / "logs", self._started))
        print("\n".join(["", *lines]), file=sys.stderr)

    @property
    def _is_hosted(self) -> bool:
        """Whether this is a module of another workflow."""
        return Path(self._workflow.main_snakefile) not in OWN_SNAKEFILES

    def _has_results(self) -> bool:
        return self._workflow.is_main_process and self._results.is_dir()

    def _is_made(self, path: str) -> bool:
        return any(rule.is_producer(path) for rule in self._workflow.rules)

    def _where(self) -> str:
        return where_results_are(self._results, self._studies, self._scene_given)

    def _own(self, write: bool) -> None:
        """Keep the folder of results for this run; a plan changes nothing there, so it may look on
        while a run works.
        """
        try:
            scene = find_scene(self._scene_given)
            ownership.claim(self._results, scene, SCENES, write, self._is_hosted)
            if self._lock is None and not self._workflow.output_settings.dryrun:
                self._lock = ownership.take(self._results)
        except ownership.Refused as error:
            refuse(error)
