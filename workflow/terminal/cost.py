"""What the jobs of a scene cost before they run: a first guess by rule, corrected by what this machine's jobs took.

The first guess is in seconds of one core of the development machine, a server with two busy cores.
"""

import heapq
import json
import math
import statistics
import time
from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
from scipy import fft

from atomistic.hardness.cost import ATOM_STEPS_PER_CORE_SECOND, base_seconds, closing_seconds
from atomistic.hardness.glass import TIMESTEP_FS, total_ps
from atomistic.hardness.stack import base_of
from atomistic.materials import Material
from mesoscale.settings import ContactSettings, HistorySettings
from mesoscale.settings.history import DWELL_STEPS
from mesoscale.settings.pad import POINTS_PER_JOB
from mesoscale.uncertainty.chunks import CHUNK_RUNS, MOST_REPEATED, collocation_run_count
from workflow.scene import Scene

TIMES = Path(".snakemake/asperity_seconds.json")
"""What jobs took and their first guess, seconds by rule; delete it to start again from the first guess."""
TRUST_S = 10.0  # jobs of so many guessed seconds count as much as the first guess
KEPT_S = 30.0  # those of former runs count as at most so many, since this run may find the machine busier
LONGEST_RUN_H = 12.0  # of a run on one machine, unless it is said to be meant: what a night finishes
START_S = 0.8  # Snakemake's start of a job, and the packages
ENGINE_S = 0.9  # more packages for a contact, and its loops from numba's cache
GRID = 1024**2  # sites of the reference
# of any cycle; of one on the reference grid, besides; the power of the sites with which that grows
CYCLE_S = {"asperity": (0.005, 0.054, 1.0), "coupled": (0.01, 2.5, 2.2), "adhesive": (0.05, 36.0, 1.2)}
NOMINAL = {"asperity": 10, "coupled": 70, "adhesive": 30}  # cycles: the largest load presses seven times as hard
RUN_S = 0.004  # law of a run and its row
CELL = {"asperity": 2.2, "coupled": 3.9, "adhesive": 3.0}  # a pad's cell over a cycle: it opens from several depths
PRESSED = {"asperity": 1.0, "coupled": 0.6, "adhesive": 5.0}  # that which a switch presses over it
BEAMS_S = 0.5  # a switch and those of two halves of its cells
TRANSFORM_S = 0.0049  # of `relative_speed` on the development machine


GROWS_BY = {  # the key that makes a rule's jobs many or long
    **dict.fromkeys(("make_glass", "make_base", "run_closing"), "hardness.seeds"),
    **dict.fromkeys(("make_amorphous", "scan_glass"), "elastic.structures"),
    "compute_runs": "uncertainty.seeds",
    "compute_direct_runs": "uncertainty.direct_runs",
    "press_pads": "pad.points",
    "follow_history": "history.cycles",
    "observe_cycles": "measurements.runs",
    "sample_posterior": "measurements.local_runs",
}


def cycle_s(contact: ContactSettings) -> float:
    """Seconds of one closing and opening."""
    fixed, growing, power = CYCLE_S[contact.mechanics]
    return fixed + growing * (contact.pixels**2 / GRID) ** power


def history_s(history: HistorySettings, contact: ContactSettings) -> float:
    """Seconds of closing and opening again and again; all but the first cycle find their surface."""
    cycle = 0.6 + (0.05 * DWELL_STEPS if history.dwell_s > 0 else 0.0)
    return history.seeds * history.cycles * (cycle * cycle_s(contact) + 0.015)


class Costs:
    """Costs of the jobs of one scene.

    Parameters
    ----------
    materials : those that hardness names: oxides by formula, bodies below films by name.
    times : see TIMES.
    """

    def __init__(self, scene: Scene, materials: Mapping[str, Material], times: Path = TIMES) -> None:
        self.scene, self._times = scene, times
        self.closing_s: dict[str, float] = {}  # by closing run
        self.base_s: dict[str, float] = {}  # of the body below films, by its width in glass cells
        if "hardness" in scene.stages():
            oxide = materials[scene.hardness.material]
            base = base_of(materials[scene.hardness.base]) if scene.hardness.base else None
            self.closing_s = closing_seconds(scene.hardness, oxide, base)
            if base is not None:
                widths = {asperity.tiles for asperity in scene.hardness.asperities}
                self.base_s = {str(tiles): base_seconds(scene.hardness, oxide, base, tiles) for tiles in widths}
        self._sums = defaultdict(lambda: [0.0, 0.0])  # seconds and their first guess, by rule
        with suppress(OSError, ValueError):  # no run yet, or one that was killed
            for rule, (took, guess) in json.loads(times.read_text()).items():
                share = min(1.0, KEPT_S / guess)
                self._sums[rule] = [share * took, share * guess]
        self._slowness = 1 / relative_speed()

    def seconds(self, rule: str, wildcards: Mapping[str, str]) -> float | None:
        """Seconds of one core of this machine, by all that jobs took so far; None for a rule without a first guess."""
        if rule not in FIRST_GUESS:
            return None
        took, guessed = self._sums.get(rule, (0.0, 0.0))
        every_took, every_guessed = np.sum([(0.0, 0.0), *self._sums.values()], axis=0).tolist()
        # a rule that has not run here is as slow as the others were
        general = (every_took + TRUST_S * self._slowness) / (every_guessed + TRUST_S)
        return (took + TRUST_S * general) / (guessed + TRUST_S) * self._guess(rule, wildcards)

    def learn(self, rule: str, wildcards: Mapping[str, str], took: float) -> None:
        """Keep what a job took, for the rest of this run and for later ones."""
        sums = self._sums[rule]
        sums[0], sums[1] = sums[0] + took, sums[1] + self._guess(rule, wildcards)
        with suppress(OSError):  # a full disk
            self._times.parent.mkdir(exist_ok=True)
            self._times.write_text(json.dumps(self._sums))

    def _guess(self, rule: str, wildcards: Mapping[str, str]) -> float:
        return START_S + FIRST_GUESS[rule](self, wildcards)

    def refusal(self, seconds: Mapping[str, float], wall_s: float, cores: int, hours: float) -> str:
        """Why a run on one machine is refused: the key behind most of its time; empty where it is not.

        Parameters
        ----------
        seconds : of one core, by rule.
        wall_s : of the whole plan on these cores.
        hours : the longest run.
        """
        if wall_s <= hours * 3600:
            return ""
        rule = max(seconds, key=lambda rule: seconds[rule])
        cause, value = GROWS_BY.get(rule, rule), ""
        if rule in GROWS_BY:
            value = f" = {_at(self.scene.model_dump(mode='json'), cause)}"
        allowed = math.ceil(1.2 * wall_s / 3600)
        return (
            f"{cause}{value}: takes {seconds[rule] / 3600:.3g} of the {sum(seconds.values()) / 3600:.3g} hours of one "
            f"core, {wall_s / 3600:.3g} hours on {cores}, and a run on one machine may take {hours:g}; ask for less, "
            f"allow it (--hours {allowed}, make run HOURS={allowed}), or run on a cluster (docs/cluster.md)"
        )

    @property
    def cycle_s(self) -> float:
        """Seconds of one closing and opening."""
        return cycle_s(self.scene.contact)

    def cycles_s(self, runs: int) -> float:
        """Seconds of a job of so many cycles with their laws."""
        return ENGINE_S + runs * (self.cycle_s + RUN_S)

    @property
    def mechanics(self) -> str:
        """Of the contact."""
        return self.scene.contact.mechanics

    def cells_s(self, cells: float) -> float:
        """Seconds of a job of so many cells of a pad."""
        return ENGINE_S + cells * CELL[self.mechanics] * PRESSED[self.mechanics] * self.cycle_s

    def points_s(self, central: bool) -> float:
        """Seconds of a job of so many points, or of the one at central inputs."""
        pad = self.scene.pad
        if central:
            return self.cells_s(pad.cells) + BEAMS_S
        points = min(POINTS_PER_JOB[self.mechanics], pad.points)
        return self.cells_s(points * pad.point_cells) + points * BEAMS_S

    def scf_s(self, seconds: float, tight: bool = True) -> float:
        """Seconds of DFT on a glass from those of 28 atoms at 100 hartree; the power was measured to 112 atoms."""
        elastic = self.scene.elastic
        cutoff_Ha = elastic.dft.forces_cutoff_Ha if tight else elastic.dft.cutoff_Ha
        return seconds * (elastic.glass.formula_units / 4) ** 2.4 * cutoff_Ha / 100


def _at(content: Any, key: str) -> Any:
    for part in key.split("."):
        content = content[part]
    return content


def _glass_steps(scene: Scene) -> float:
    """Atom-steps of a melt, quench and rest."""
    return 1e3 * total_ps(scene.hardness.glass) / TIMESTEP_FS * scene.hardness.glass.atoms


def _quenches(glass: Any) -> int:
    """Quenches until a new network passes its gates: with broken bonds, or perfect."""
    return 10 if glass.max_defects else 75


def _each(seconds: float, *rules: str) -> dict[str, Callable[[Costs, Any], float]]:
    return dict.fromkeys(rules, lambda costs, wildcards: seconds)


def _design_runs(costs: Costs) -> int:
    return collocation_run_count(len(costs.scene.inputs.rows()), costs.scene.uncertainty)


FIRST_GUESS: dict[str, Callable[[Costs, Any], float]] = {
    **_each(0.0, "write_scene", "collect_inputs", "collect_pad_inputs", "combine_e_star", "collect_priors"),
    **_each(0.0, "collect_prior_pad_inputs"),
    **_each(0.5, "fit_hardness", "fit_nominal_law"),
    **_each(2.0, "pool_spectra"),
    **_each(5.0, "write_synthetic_scans"),
    **_each(8.5, "rank_sensitivity"),
    **_each(60.0, "make_circuit"),
    **_each(180.0, "find_failure_rate", "measure_failure_accuracy"),
    **_each(1100.0, "measure_elastic_accuracy"),
    "make_glass": lambda c, _: _glass_steps(c.scene) / ATOM_STEPS_PER_CORE_SECOND,
    "make_base": lambda c, job: c.base_s[job["tiles"]],
    "run_closing": lambda c, job: c.closing_s[job["run"]],
    "make_amorphous": lambda c, _: 1.3 * _quenches(c.scene.elastic.glass) * c.scene.elastic.glass.formula_units / 4,
    # with LDA twice as many strains, as of the first glasses
    "scan_glass": lambda c, _: (
        c.scf_s(8.0 * (1 + c.scene.elastic.dft.relaxation_steps))
        + c.scf_s(13.0 * len(c.scene.elastic.strains), tight=False)
    ),
    "scan_crystal": lambda c, _: c.scf_s(18.0 * len(c.scene.elastic.strains), tight=False),
    # six scans, after the import of their readers
    "analyse_scans": lambda c, _: 4.0 + 4.8 * c.scene.topography.synthetic.pixels**2 / GRID,
    "judge_scans": lambda c, _: 3.0 + 3.0 * len(c.scene.topography.scans),
    # to eight forces, twice; the cycles to small forces are short
    "measure_resistance": lambda c, _: c.cycles_s(4 * c.scene.resistance.runs),
    "compute_nominal": lambda c, _: 0.5 + c.cycles_s(NOMINAL[c.mechanics]),
    "compute_runs": lambda c, _: c.cycles_s(min(CHUNK_RUNS, _design_runs(c))),
    "compute_direct_runs": lambda c, _: c.cycles_s(min(CHUNK_RUNS, c.scene.uncertainty.direct_runs)),
    "repeat_direct_runs": lambda c, _: c.cycles_s(min(MOST_REPEATED, c.scene.uncertainty.direct_runs)),
    "fit_law": lambda c, _: 0.01 * _design_runs(c),
    "propagate_uncertainty": lambda c, _: 0.5 + 0.0082 * c.scene.uncertainty.direct_runs,
    "observe_cycles": lambda c, _: c.cycles_s(min(CHUNK_RUNS, c.scene.measurements.runs)),
    # chains of all tables and of all but one of them, and the cycles where the posterior lies
    "sample_posterior": lambda c, _: (
        10.0 * (len(c.scene.measurements.tables) + 1 + c.scene.measurements.rounds)
        + c.cycles_s(c.scene.measurements.rounds * c.scene.measurements.local_runs)
    ),
    **dict.fromkeys(("press_pads", "press_prior_pads"), lambda c, job: c.points_s(job["chunk"] == "central")),
    "assemble_pad": lambda c, _: 3.0,
    "measure_pad_accuracy": lambda c, _: 60.0 + c.cells_s(30 * c.scene.pad.point_cells),
    "follow_history": lambda c, _: history_s(c.scene.history, c.scene.contact),
    "render_report": lambda c, _: 5.5 + 0.5 * len(c.scene.stages()),
}
"""Seconds of a job of each rule, from its costs and wildcards, beside START_S."""


def wall_seconds(
    seconds: Sequence[float], needs: Sequence[Iterable[int]], cores: int, priorities: Sequence[int] | None = None
) -> float:
    """Time that jobs take side by side, each started as soon as what it needs is done and a core is free.

    Parameters
    ----------
    seconds : of each job on one core.
    needs : which other jobs each waits for, by their numbers.
    priorities : of each job; of those that could start the highest does, of equal ones the first.
    """
    ranks = [0] * len(seconds) if priorities is None else [-priority for priority in priorities]
    missing = [set(others) for others in needs]
    waited_for: list[list[int]] = [[] for _ in seconds]
    for number, others in enumerate(missing):
        for other in others:
            waited_for[other].append(number)
    ready = [(ranks[number], number) for number, others in enumerate(missing) if not others]
    heapq.heapify(ready)
    running: list[tuple[float, int]] = []
    now = 0.0
    while ready or running:
        while ready and len(running) < cores:
            _, number = heapq.heappop(ready)
            heapq.heappush(running, (now + seconds[number], number))
        now, done = heapq.heappop(running)
        for number in waited_for[done]:
            missing[number].remove(done)
            if not missing[number]:
                heapq.heappush(ready, (ranks[number], number))
    return now


def relative_speed() -> float:
    """Speed of this machine over the development machine's, by the Fourier transform of a reference grid."""
    heights = np.random.default_rng(0).normal(size=(1024, 1024))
    seconds = []
    for _ in range(20):
        started = time.process_time()
        fft.rfft2(heights)
        seconds.append(time.process_time() - started)
    return TRANSFORM_S / statistics.median(seconds)  # one may be lucky or disturbed
