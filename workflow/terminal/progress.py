"""What a run says in the terminal: its plan, and a line for each finished job with the clock and the time left."""

import logging
import sys
import textwrap
import time
from collections import Counter, defaultdict
from collections.abc import Mapping
from pathlib import Path
from shutil import disk_usage
from typing import Any

from snakemake.exceptions import WorkflowError

from asperity.foreign_text import COLUMNS, wrapped
from workflow.job import last_line
from workflow.terminal.cost import Costs, wall_seconds

FULL_DISK = 100_000  # bytes left: less than a job and its log need


class Terminal(logging.Handler):
    """Turns Snakemake's messages about jobs into the terminal's lines.

    Parameters
    ----------
    workflow : Snakemake's, of which it asks what is to run, on how many cores, and whether anything runs at all.
    costs : of the scene.
    nothing_to_do : what to say when every result is there.
    hours : the longest run on one machine.

    Attributes
    ----------
    refusal : why the planned run is longer than that; empty where it is not, or a cluster takes its jobs.
    """

    def __init__(self, workflow: Any, costs: Costs, nothing_to_do: str, hours: float) -> None:
        super().__init__()
        self._workflow, self._costs, self._nothing_to_do, self._hours = workflow, costs, nothing_to_do, hours
        self.refusal = ""
        self._planned = False
        self._jobs = self._done = 0
        self._counts: Counter[str] = Counter()  # of the jobs that have not finished, by rule
        self._seconds_left: defaultdict[str, float] = defaultdict(float)
        self._running: dict[int, tuple[str, str, float]] = {}  # rule, message and start by number of the job

    def emit(self, record: logging.LogRecord) -> None:
        """Print what a message of Snakemake means for the user."""
        event, about = getattr(record, "event", None), record.__dict__
        if event == "run_info" and not self._planned:
            self._planned = True
            self._plan()
        elif event == "job_info" and not self._workflow.dryrun:
            message = about["rule_msg"] or about["rule_name"]
            self._running[about["jobid"]] = about["rule_name"], message, time.monotonic()
        elif event == "job_finished":
            self._finish(about["job_id"])
        elif event == "job_error":
            _say_if_silent(about)
        elif event is None and record.getMessage().startswith("Nothing to be done"):
            _say(self._nothing_to_do)

    def _plan(self) -> None:
        jobs = self._waiting()
        rules = [job.rule.name for job in jobs]
        self._counts = Counter(rules)
        costs = [(job.rule.name, self._costs.seconds(job.rule.name, dict(job.wildcards_dict))) for job in jobs]
        unknown = sorted({rule for rule, cost in costs if cost is None})
        seconds = [cost or 0.0 for _, cost in costs]
        for rule, cost in zip(rules, seconds, strict=True):
            self._seconds_left[rule] += cost
        self._jobs = len(jobs)
        wall_s = wall_seconds(seconds, self._needs(jobs), self._cores, [job.priority for job in jobs])
        if self._workflow.local_exec:
            self.refusal = self._costs.refusal(self._seconds_left, wall_s, self._cores, self._hours)
        wall = duration(wall_s) if jobs else "no time"
        besides = f", and {', '.join(unknown)}, whose time nobody has measured" if unknown else ""
        if self._workflow.dryrun:
            rows = [
                ("job", "count", "one core"),
                *((rule, str(count), self._time(rule)) for rule, count in self._counts.items()),
            ]
            width = max(len(row[0]) for row in rows)
            _say("\n".join(f"{rule:<{width}}  {count:>5}  {cost:>9}" for rule, count, cost in rows) + "\n")
        if self._workflow.dryrun and self.refusal:
            _say(wrapped(f"a run is refused: {self.refusal}"))
        _say(wrapped(f"{self._jobs} jobs, about {wall} on {self._cores} cores{besides}"))

    @property
    def _cores(self) -> int:
        try:
            return self._workflow.cores
        except WorkflowError:  # a cluster's jobs have no common number
            return self._workflow.nodes

    def _waiting(self) -> list[Any]:
        return [job for job in self._workflow.dag.needrun_jobs() if not job.rule.norun]

    def _needs(self, jobs: list[Any]) -> list[list[int]]:
        """Which of the jobs each waits for, by their numbers."""
        numbers = {job: number for number, job in enumerate(jobs)}
        needed = self._workflow.dag.job_dependencies
        return [[numbers[other] for other in needed(job) if other in numbers] for job in jobs]

    def _time(self, rule: str) -> str:
        return duration(self._seconds_left[rule]) if self._seconds_left[rule] else "?"

    def _finish(self, number: int) -> None:
        rule, message, started = self._running.pop(number, ("", "", 0.0))
        if rule not in self._counts:  # a target that only gathers
            return
        self._done += 1
        took, planned = time.monotonic() - started, self._seconds_left[rule] / self._counts[rule]
        self._seconds_left[rule] -= planned
        if self._workflow.local_exec and planned:  # on a cluster jobs wait
            self._costs.learn(rule, took, planned)
        self._counts[rule] -= 1
        left = sum(self._seconds_left.values()) / self._cores
        rest = f", {duration(left)} left" if self._done < self._jobs else ""
        start = f"{time.strftime('%H:%M')}  {self._done:>{len(str(self._jobs))}} of {self._jobs}  "
        end = f" ({duration(took)}){rest}"
        _say(start + textwrap.shorten(message, COLUMNS - len(start) - len(end), placeholder=" …") + end)


def _say_if_silent(about: Mapping[str, Any]) -> None:
    """A job that says nothing before it ends was ended by the system."""
    log = Path(next(iter(about["log"]), ""))
    if log.is_file() and last_line(log).startswith("ERROR "):
        return
    if disk_usage(Path.cwd()).free < FULL_DISK:
        _say(f"ERROR {about['rule_name']}: no space left on the disk of {Path.cwd()}; make room, then run again")
        return
    if about["log"] and not log.is_file():
        _say(f"ERROR {about['rule_name']}: ended before it began, its script has a mistake: see the lines above")
        return
    _say(
        f"ERROR {about['rule_name']}: ended by the system without a word, probably out of memory: run again with "
        "fewer --cores, or lower contact.pixels"
    )


def duration(seconds: float) -> str:
    """A time as people say it: 8 s, 2 min 40 s, 12 min, 2.5 h."""
    if seconds < 90:
        return f"{max(1, round(seconds))} s"
    if seconds < 10 * 60:
        return f"{round(seconds) // 60} min {round(seconds) % 60} s"
    return f"{seconds / 60:.0f} min" if seconds < 90 * 60 else f"{seconds / 3600:.1f} h"


def speak(workflow: Any, logger: logging.Logger, costs: Costs, nothing_to_do: str, hours: float) -> Terminal:
    """Let `Terminal` tell what goes on instead of Snakemake, whose warnings and errors stay."""

    def is_needed(record: logging.LogRecord) -> bool:
        in_detail = workflow.dryrun and getattr(record, "event", None) == "job_info"  # --dry-run without --quiet
        return record.levelno > logging.INFO or in_detail or workflow.output_settings.verbose

    for handler in logger.handlers:
        handler.addFilter(is_needed)
    terminal = Terminal(workflow, costs, nothing_to_do, hours)
    logger.addHandler(terminal)
    return terminal


def _say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)
