"""What a run says in the terminal: its plan, and a line for each finished job with the clock and
the time left.
"""

import logging
import re
import sys
import textwrap
import time
from collections import Counter, defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping
from pathlib import Path, PurePosixPath
from shutil import disk_usage
from typing import Any

from snakemake.exceptions import WorkflowError

from asperity.guards.foreign_text import COLUMNS, did_you_mean, shown, wrapped
from workflow.run.changed_files import change_lines, changed_files
from workflow.run.cost import Costs, refusal, wall_seconds
from workflow.run.job import last_line
from workflow.scene.renamed import SINCE, STAGES, name_now, place_now

FEWEST_SWITCHES = 20
"""For the 5 and 95 % of their releases: of fewer, less than one lies beyond."""
NO_SUCH_TARGET = re.compile(
    r"MissingRuleException:\nNo rule to produce (.*) \(if you use input functions"
)

# the terminal names the target, the page comes before its job, and a failed job says why
IN_OWN_WORDS = re.compile(
    rf"{NO_SUCH_TARGET.pattern}|Warning: the following output files of rule report were not|"
    r"RuleException:\nCalledProcessError|Exiting because a job|WorkflowError:\nAt least one job"
)


class Terminal(logging.Handler):
    """Turns Snakemake's messages about jobs into the terminal's lines.

    Parameters
    ----------
    workflow : Snakemake's, of which it asks what is to run, on how many cores, and whether anything
        runs at all.
    costs : of the scene.
    nothing_to_do : what to say when every result is there.
    hours : the longest run on one machine.

    Attributes
    ----------
    refusal : why the planned run is longer than that; empty where it is not, or a cluster takes its
        jobs.
    """

    def __init__(self, workflow: Any, costs: Costs, nothing_to_do: str, hours: float) -> None:
        super().__init__()
        self._workflow, self._costs, self._nothing_to_do, self._hours = (
            workflow,
            costs,
            nothing_to_do,
            hours,
        )
        self.refusal = ""
        self._planned = False
        self._jobs = self._done = 0
        self._left: dict[int, Any] = {}  # Snakemake's jobs that have not finished, by number
        self._running: dict[int, tuple[str, float]] = {}  # message and start by number of the job

    def emit(self, record: logging.LogRecord) -> None:
        """Print what a message of Snakemake means for the user."""
        event = getattr(record, "event", None)
        about = record.__dict__
        if event == "run_info" and not self._planned:
            self._planned = True
            self._plan()
        elif event == "job_info" and not self._workflow.dryrun:
            message = about["rule_msg"] or about["rule_name"]
            self._running[about["jobid"]] = message, time.monotonic()
        elif event == "job_finished":
            self._finish(about["job_id"])
        elif event == "job_error":
            _say_if_silent(about)
        elif event is None and record.getMessage().startswith("Nothing to be done"):
            _say(self._nothing_to_do)
        elif mistyped := NO_SUCH_TARGET.match(record.getMessage()):
            self._refuse_target(mistyped[1])

    def _refuse_target(self, target: str) -> None:
        if renamed := _name_now(target):
            _say(f"ERROR {renamed}")
            return
        rules = self._workflow.rules
        names = [rule.name for rule in rules] + [
            str(path) for rule in rules for path in rule.output
        ]
        _say(
            f"ERROR {shown(target)}: no such target{did_you_mean(target, names)} (asperity targets"
            " lists the stages)"
        )

    def _plan(self) -> None:
        self._left = {
            job.jobid: job for job in self._workflow.dag.needrun_jobs() if not job.rule.norun
        }
        self._jobs = len(self._left)
        seconds: defaultdict[str, float] = defaultdict(float)
        for job in self._left.values():
            seconds[job.rule.name] += self._seconds(job)
        wall_s = self._wall_s()
        for line in self._changes():
            _say(wrapped(line))
        if self._workflow.local_exec:
            self.refusal = refusal(seconds, wall_s, self._cores, self._hours)
        if self._workflow.dryrun:
            counts = Counter(job.rule.name for job in self._left.values())
            rows = [
                ("job", "count", "one core"),
                *((rule, str(counts[rule]), duration(press)) for rule, press in seconds.items()),
            ]
            width = max(len(row[0]) for row in rows)
            _say(
                "\n".join(f"{rule:<{width}}  {count:>5}  {cost:>9}" for rule, count, cost in rows)
                + "\n"
            )
        if self._workflow.dryrun and self.refusal:
            _say(wrapped(f"a run is refused: {self.refusal}"))
        wall = f"about {duration(wall_s)}" if self._left else "no time"
        guessed = (
            "" if self._costs.known(seconds) else ", a guess until jobs of this scene have run here"
        )
        _say(wrapped(f"{self._jobs} jobs, {wall} on {self._cores} cores{guessed}"))

    def _changes(self) -> Iterator[str]:
        """Lines on files that changed since results were made of them, with what they renew and its
        time.
        """
        changed = changed_files(self._left.values(), self._workflow.persistence.params)
        if not changed:
            return
        rules = {number: job.rule.name for number, job in self._left.items()}
        seconds = {number: self._seconds(job) for number, job in self._left.items()}
        needs = self._needs()

        def cost(numbers: Collection[int]) -> str:
            chosen = {number: seconds[number] for number in numbers}
            return f"about {duration(wall_seconds(chosen, needs, self._cores))}"

        yield from change_lines(changed, needs, rules, cost)

    def _needs(self) -> dict[int, list[int]]:
        """Numbers of the jobs that each job that is left waits for."""
        needed = self._workflow.dag.job_dependencies
        return {
            number: [other.jobid for other in needed(job)] for number, job in self._left.items()
        }

    @property
    def _cores(self) -> int:
        try:
            return self._workflow.cores
        except WorkflowError:  # a cluster's jobs have no common number
            return self._workflow.nodes

    def _seconds(self, job: Any) -> float:
        return self._costs.seconds(job.rule.name, dict(job.wildcards_dict))

    def _wall_s(self) -> float:
        """Time to the end, side by side, by what the jobs took so far; jobs at work have their last
        part left.
        """
        seconds = {number: self._seconds(job) for number, job in self._left.items()}
        for number, (_, started) in self._running.items():
            if number in seconds:
                spent = time.monotonic() - started
                # one that takes longer goes on
                seconds[number] = max(seconds[number] - spent, 0.1 * spent)
        return wall_seconds(seconds, self._needs(), self._cores)

    def _finish(self, number: int) -> None:
        message, started = self._running.pop(number, ("", 0.0))
        if not message or number not in self._left:  # a dry run, or a target that only gathers
            return
        job = self._left.pop(number)
        self._done += 1
        took = time.monotonic() - started
        if self._workflow.local_exec:  # on a cluster jobs wait
            self._costs.learn(job.rule.name, dict(job.wildcards_dict), took)
        remaining = f", {duration(self._wall_s())} left" if self._left else ""
        start = f"{time.strftime('%H:%M')}  {self._done:>{len(str(self._jobs))}} of {self._jobs}  "
        end = f" ({duration(took)}){remaining}"
        _say(
            start
            + textwrap.shorten(message, COLUMNS - len(start) - len(end), placeholder=" …")
            + end
        )
        if job.rule.name == "press_pads":
            pressed = [
                press for press in self._workflow.dag.jobs if press.rule.name == "press_pads"
            ]
            for line in release_so_far(
                [
                    file
                    for press in pressed
                    if press.jobid not in self._left
                    for file in press.output
                ]
            ):
                _say(line)


def _name_now(target: str) -> str:
    """The line on a target of before that is called otherwise now; empty for any other one."""
    if target in STAGES:
        return name_now(target, STAGES)
    results, scene, *inside = [*PurePosixPath(target).parts, "", ""]
    place = place_now("/".join(filter(None, inside))) if results == "results" else ""
    return f"`{target}` is `{results}/{scene}/{place}` since {SINCE}" if place else ""


def release_so_far(files: Iterable[str]) -> Iterator[str]:
    """A line on the switches of these files of pad/points/ together, by the quantiles of the
    answer.
    """
    import h5py  # not while a run is planned
    import numpy as np

    from workflow.report.verdict import volts

    release_V = []
    for path in files:
        with h5py.File(path) as file:  # of the central point the job says more
            release_V += [
                file[name].attrs.get("release_V", np.nan) for name in file if name != "point_0000"
            ]
    solved = [value for value in release_V if np.isfinite(value)]
    if not solved:
        return
    low, middle, high = (volts(value) for value in np.quantile(solved, (0.05, 0.5, 0.95)))
    ends = f"5 %: {low}; 95 %: {high}"
    if len(solved) < FEWEST_SWITCHES:
        ends = f"least: {volts(min(solved))}; largest: {volts(max(solved))}"
    stuck = np.mean(np.equal(solved, 0.0))
    yield f"  release of {len(solved)} switches so far: {middle} ({ends}); {stuck:.0%} stick"


def _say_if_silent(about: Mapping[str, Any]) -> None:
    """A job that says nothing before it ends was ended by the system."""
    log = Path(next(iter(about["log"]), ""))
    if log.is_file() and last_line(log).startswith("ERROR "):
        return
    if disk_usage(Path.cwd()).free < 100_000:  # bytes: less than a job and its log need
        why = f"no space left on the disk of {Path.cwd()}; make room, then run again"
    elif about["log"] and not log.is_file():
        why = "ended before it began, its script has a mistake: see the lines above"
    else:
        why = (
            "ended by the system without a word, probably out of memory: take fewer --cores or"
            " contact.pixels"
        )
    _say(f"ERROR {about['rule_name']}: {why}")


def duration(seconds: float) -> str:
    """A time as people say it: 8 s, 2 min 40 s, 12 min, 2.5 h."""
    if seconds < 90:
        return f"{max(1, round(seconds))} s"
    if seconds < 10 * 60:
        return f"{round(seconds) // 60} min {round(seconds) % 60} s"
    return f"{seconds / 60:.0f} min" if seconds < 90 * 60 else f"{seconds / 3600:.1f} h"


def speak(
    workflow: Any, logger: logging.Logger, costs: Costs, nothing_to_do: str, hours: float
) -> Terminal:
    """Let `Terminal` tell what goes on instead of Snakemake, whose warnings and errors stay."""

    def is_needed(record: logging.LogRecord) -> bool:
        event = getattr(record, "event", None)
        in_detail = workflow.dryrun and event == "job_info"  # --dry-run without --quiet
        replaced = (event == "job_error" and workflow.local_exec) or IN_OWN_WORDS.match(
            record.getMessage()
        )
        return (
            (record.levelno > logging.INFO and not replaced)
            or in_detail
            or workflow.output_settings.verbose
        )

    for handler in logger.handlers:
        handler.addFilter(is_needed)
    terminal = Terminal(workflow, costs, nothing_to_do, hours)
    logger.addHandler(terminal)
    return terminal


def _say(text: str) -> None:
    # in one piece: a reader that leaves after the first line must not end the run within the text
    sys.stderr.write(f"{text}\n")
    sys.stderr.flush()
