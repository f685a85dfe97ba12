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

from scipy.constants import epsilon_0

from mesoscale.settings import DeviceSettings, SceneContact
from mesoscale.settings.pad import MORE_CELLS, POINTS_PER_JOB
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
    "uncertainty": 20.0,
    "report": 8.0,
    "calibration": 60.0,
    "circuit": 30.0,
    "failure": 700.0,
    "lifetime": 200.0,
    "study": 25.0,
}
CYCLES = {  # contacts that a job closes and opens, to the largest force of the scene
    "contact": 50,
    "compute_runs": 200,
    "compute_direct_runs": 200,
    "observe_cycles": 200,
    "study": 500,
    "history": 100,
}


START_S = 6.0
"""Of a job on pads: imports, and code that is compiled."""
CELL_S_PER_MPA = {"asperity": 0.0013, "coupled": 0.003, "adhesive": 0.043}
"""Of a cell of a pad with `CELL_PIXELS` a side, for each MPa that its switch presses with."""
CELL_PIXELS = 256
CELL_POWER = 1.4
"""Of the number of pixels a side."""
PRESSES_MPA = (5.0, 200.0)
"""Pressures of the switches that this was measured on."""
SWITCH_S = {"beam": 0.22, "plate": 0.02}
"""Of a switch on a pad, and on its halves."""
UNDECIDED = 0.4
"""Share of points that four times as many cells must decide."""
ANSWERED_TIMES = 1.1
"""Switches that the answer solves beside its points, for each of them: other devices, what frees
those that stick."""
PRESSED_AGAIN = 24
"""Pads of a point that the answer presses: other hardness, other numerical choices, and roughness
that frees."""
TRIED_HUMIDITIES = 10
"""Of a humidity that is not known exactly."""
PLAIN_CELL_NM = 1000.0
"""Side of a cell where a scene leaves it open."""
UNKNOWN_CUTOFF_HALVES = 1
"""Times that a grid is halved for pads where only a measurement tells the cut-off."""


def typical_cycle_s(contact: SceneContact) -> float:
    """Seconds of one closing and opening."""
    on_1024 = {"asperity": 0.06, "coupled": 2.5, "adhesive": 36.0}
    return on_1024[contact.mechanics] * (contact.pixels / 1024) ** 3


def _cell_s(scene: Scene) -> float:
    """Seconds of a cell of a pad, on the grid that pads have (docs/pad.md)."""
    finer = (_pad_pixels(scene) / CELL_PIXELS) ** CELL_POWER
    return CELL_S_PER_MPA[scene.contact.mechanics] * _presses_MPa(scene.device) * finer


def _presses_MPa(device: DeviceSettings) -> float:
    """Rough pressure of the closed switch on its pad, by the field across the dielectric."""
    gap_m = 1e-6 * device.gap_um
    area_m2 = 1e-12 * device.length_um * device.width_um
    volts = device.hold_voltage_V
    if volts is None:  # pull-in of a plate on a spring
        volts = math.sqrt(8.0 * _spring_N_m(device) * gap_m**3 / (27.0 * epsilon_0 * area_m2))
    across_m = max(1e-9 * device.dielectric_nm / device.permittivity, 1e-9)
    least, most = PRESSES_MPA
    return min(max(1e-6 * 0.5 * epsilon_0 * (volts / across_m) ** 2, least), most)


def _spring_N_m(device: DeviceSettings) -> float:
    """Stiffness against an even load, without stretch."""
    if device.spring_N_per_m is not None:
        return device.spring_N_per_m
    slender = device.thickness_um / device.length_um
    bending = {"clamped": 32.0, "cantilever": 2.0 / 3.0}[device.ends]
    of_bending = bending * 1e9 * device.youngs_modulus_GPa * slender**2
    of_stress = 8e6 * max(device.residual_stress_MPa, 0.0)
    return (of_bending + of_stress) * 1e-6 * device.width_um * slender


def _pad_pixels(scene: Scene) -> int:
    """Pixels a side of a pad's cells: the fewest that hold all waves."""
    contact = scene.contact
    side_nm = contact.length_nm or PLAIN_CELL_NM
    stated = scene.inputs.rows().get("q1")
    shortest = contact.q1_per_nm
    if stated is not None:
        shortest = stated.reaches
        if shortest is None:
            return contact.pixels // 2**UNKNOWN_CUTOFF_HALVES
    if shortest is None:
        return contact.pixels
    pixels = contact.pixels
    while pixels % 2 == 0 and math.pi * (pixels // 2) / side_nm >= shortest:
        pixels //= 2
    return pixels


def _pressing_s(scene: Scene, wildcards: Mapping[str, str]) -> float:
    """Seconds of a chunk of pads with their switches."""
    switch_s = SWITCH_S[scene.device.kind]
    if wildcards.get("chunk") == "central":
        return START_S + scene.pad.cells * _cell_s(scene) + switch_s
    points = min(POINTS_PER_JOB[scene.contact.mechanics], scene.pad.points)
    cells = scene.pad.point_cells * (1.0 + UNDECIDED * MORE_CELLS)
    return START_S + points * (cells * _cell_s(scene) + (1.0 + UNDECIDED) * switch_s)


def _answering_s(scene: Scene, wildcards: Mapping[str, str]) -> float:
    """Seconds of the answer."""
    switches = ANSWERED_TIMES * scene.pad.points * SWITCH_S[scene.device.kind]
    return START_S + switches + PRESSED_AGAIN * scene.pad.point_cells * _cell_s(scene)


def _wetting_s(scene: Scene, wildcards: Mapping[str, str]) -> float:
    """Seconds of the switch against humidity, with twice the cells, by both limits of opening."""
    row = scene.inputs.rows().get("humidity")
    count = TRIED_HUMIDITIES
    if row is None or row.distribution == "fixed":
        count = 1
    pads = 2 * count
    each_s = 2 * scene.pad.point_cells * _cell_s(scene) + SWITCH_S[scene.device.kind]
    return START_S + pads * each_s


OF_PADS = {
    "press_pads": _pressing_s,
    "press_prior_pads": _pressing_s,
    "answer": _answering_s,
    "humidity": _wetting_s,
}
"""Seconds of the jobs on pads, by rule."""


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
        if rule in OF_PADS:
            return OF_PADS[rule](self._scene, wildcards)
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
