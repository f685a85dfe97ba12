"""What the jobs of a scene take: first typical seconds of their rule, then what this machine's jobs
took.
"""

import json
import math
from collections.abc import Iterable, Mapping
from contextlib import suppress
from graphlib import TopologicalSorter
from pathlib import Path
from typing import Any

from mesoscale.settings import SceneContact
from workflow.scene import Scene

TIMES = Path(".snakemake/asperity_seconds.json")
"""Seconds that jobs took, beside the typical ones, by scene and rule; delete it to start again from
these.
"""
LONGEST_RUN_H = 12.0
"""Of a run on one machine, unless it is said to be meant: what a night finishes."""
TABLES_COUNT_S = 60.0
"""Jobs of so many typical seconds count as much as the tables below."""
COLLECTING_S = 3.0
"""Of a rule that is in neither table, which collects or fits."""
TYPICAL_S = {  # on one core of a server
    "make_glass": 20.0,
    "make_base": 2000.0,
    "make_amorphous": 60.0,
    "scan_glass": 100.0,
    "scan_crystal": 35.0,
    "analyse_scans": 9.0,
    "judge_scans": 10.0,
    "press_pads": 15.0,
    "press_prior_pads": 15.0,
    "answer": 25.0,
    "uncertainty": 20.0,
    "report": 8.0,
    "calibration": 60.0,
    "circuit": 30.0,
    "failure": 3000.0,
    "lifetime": 200.0,
    "study": 25.0,
}
CYCLES = {  # contacts that a job closes and opens, to the largest force of the scene
    "contact": 50,
    "compute_runs": 200,
    "compute_direct_runs": 200,
    "observe_cycles": 200,
    "press_pads": 250,
    "press_prior_pads": 250,
    "study": 500,
    "humidity": 1000,
    "history": 100,
}


def typical_cycle_s(contact: SceneContact) -> float:
    """Seconds of one closing and opening."""
    on_1024 = {"asperity": 0.06, "coupled": 2.5, "adhesive": 36.0}
    return on_1024[contact.mechanics] * (contact.pixels / 1024) ** 3


class Costs:
    """Costs of the jobs of one scene.

    Parameters
    ----------
    closing_s : seconds of one core of each closing run of the hardness stage, which differ a
        thousandfold.
    times : see TIMES.
    """

    def __init__(self, scene: Scene, closing_s: Mapping[str, float], times: Path = TIMES) -> None:
        self._scene = scene
        self._closing_s = closing_s
        self._file = times
        self._all = _read(times)
        # former jobs count half, since this run may find the machine busier
        former = self._all.get(scene.name, {})
        self._learned = {rule: (took / 2, typical / 2) for rule, (took, typical) in former.items()}

    def seconds(self, rule: str, wildcards: Mapping[str, str]) -> float:
        """Seconds of one core of this machine, by all that jobs took so far."""
        took, typical = self._learned.get(rule) or self._of_all_rules()
        return took / typical * self._typical_s(rule, wildcards)

    def _of_all_rules(self) -> tuple[float, float]:
        """What all jobs took, and what is typical of them: a rule that has not run here is as slow
        as the others were.
        """
        pairs = [(TABLES_COUNT_S, TABLES_COUNT_S), *self._learned.values()]
        return sum(took for took, _ in pairs), sum(typical for _, typical in pairs)

    def learn(self, rule: str, wildcards: Mapping[str, str], took: float) -> None:
        """Keep what a job took, for the rest of this run and for later ones."""
        took_before, typical_before = self._learned.get(rule, (0.0, 0.0))
        typical = self._typical_s(rule, wildcards)
        self._learned[rule] = took_before + took, typical_before + typical
        content = json.dumps(self._all | {self._scene.name: self._learned})
        with suppress(OSError):  # a full disk
            self._file.parent.mkdir(exist_ok=True)
            self._file.write_text(content, encoding="utf-8")

    def known(self, rules: Iterable[str]) -> bool:
        """Did jobs of all these rules run for this scene before?"""
        return set(rules) <= self._learned.keys()

    def _typical_s(self, rule: str, wildcards: Mapping[str, str]) -> float:
        if "closing" in rule and "run" in wildcards:
            return self._closing_s[wildcards["run"]]
        cycles_s = CYCLES.get(rule, 0) * typical_cycle_s(self._scene.contact)
        return TYPICAL_S.get(rule, COLLECTING_S) + cycles_s


def _read(times: Path) -> dict[str, dict[str, tuple[float, float]]]:
    """What was learned, by scene and rule; nothing from a file that is missing, half-written or of
    another shape.
    """
    try:
        content: Any = json.loads(times.read_text(encoding="utf-8"))
        return {str(scene): _pairs(rules) for scene, rules in content.items()}
    except (OSError, ValueError, TypeError, AttributeError, RecursionError):
        return {}


def _pairs(rules: Any) -> dict[str, tuple[float, float]]:
    """What the jobs of each rule took, and what is typical of them (s).

    Raises
    ------
    ValueError, TypeError, AttributeError : it is no mapping to pairs of positive numbers.
    """
    pairs = {}
    for rule, (took, typical) in rules.items():
        pair = (float(took), float(typical))
        if not all(0 < seconds < math.inf for seconds in pair):
            raise ValueError(pair)
        pairs[str(rule)] = pair
    return pairs


def refusal(seconds: Mapping[str, float], wall_s: float, cores: int, hours: float) -> str:
    """Why a run on one machine is refused: the rule behind most of its time; empty where it is not.

    Parameters
    ----------
    seconds : of one core, by rule.
    wall_s : of the whole plan on these cores.
    hours : the longest run.
    """
    if wall_s <= hours * 3600:
        return ""
    rule = max(seconds, key=lambda rule: seconds[rule])
    of_rule_h = seconds[rule] / 3600
    of_all_h = sum(seconds.values()) / 3600
    wall_h = wall_s / 3600
    allowed = math.ceil(1.2 * wall_h)
    return (
        f"jobs {rule} take {of_rule_h:.3g} of the {of_all_h:.3g} hours of one core, {wall_h:.3g}"
        f" hours on {cores}, and a run on one machine may take {hours:g}; ask for less, allow it"
        f" (--hours {allowed}, make run HOURS={allowed}), or run on a cluster (docs/cluster.md)"
    )


def wall_seconds(
    seconds: Mapping[int, float], needs: Mapping[int, Iterable[int]], cores: int
) -> float:
    """Least time that jobs take side by side: all cores busy, or the longest chain of jobs that
    wait for each other.

    Parameters
    ----------
    seconds : of each job on one core, by number.
    needs : numbers of the jobs that each waits for; of others than these it waits no more.
    """
    waits = {number: seconds.keys() & set(needs[number]) for number in seconds}
    ends: dict[int, float] = {}
    for number in TopologicalSorter(waits).static_order():
        begins = max((ends[other] for other in waits[number]), default=0.0)
        ends[number] = begins + seconds[number]
    return max(sum(seconds.values()) / cores, max(ends.values(), default=0.0))
