"""What the jobs of a scene cost before they run: seconds of one core by rule.

The figures were measured on the development machine, two cores of a server with both of them busy (one of them alone is
some 10 % faster), with compiled bytecode; `relative_speed` sets another machine against it.
"""

import heapq
import math
import statistics
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from scipy import fft

from atomistic.hardness.cost import ATOM_STEPS_PER_CORE_SECOND, plan_rows
from atomistic.materials import Material
from mesoscale.settings import ContactSettings, HistorySettings
from mesoscale.uncertainty.chunks import collocation_run_count
from workflow.scene import Scene

START_S = 0.8  # Snakemake's start of a job, and the packages
ENGINE_S = 0.9  # more packages for a contact, and its loops from numba's cache
GRID = 1024**2  # sites of the reference
# of any cycle; of one on the reference grid, besides; the power of the sites with which that grows
CYCLE_S = {"asperity": (0.005, 0.054, 1.0), "coupled": (0.01, 2.5, 2.2)}
CHAIN_S = 10.0  # a posterior of some twenty curves; scene made_up
FITTED_RUN_S = 0.004  # law of a run and its row
LATER_CYCLE, HOLD = 0.6, 0.05  # of a history, over a first cycle; of each time within a hold
CURVE_S = 0.01  # fit of both branches of a run, with fits repeated from other starts
RESPONSE_RUN_S = 0.0082  # of a direct run, in regressions and their validation
ANSWER_S = 6.0  # 89 switches solved on pads at other inputs
RELEASE_S = 0.015  # law and switch after a cycle
CELL_S = {"asperity": 2.75, "coupled": 3.9}  # a pad's cell over a cycle: it opens from several depths
PRESSED = {"asperity": 1.0, "coupled": 9.0}  # that which a switch presses over it
DRAW_CELL = {"asperity": 0.9, "coupled": 0.45}  # a cell of a pad at other inputs: fewer steps, half of the depths
PILOT_CELL = {"asperity": 0.45, "coupled": 0.15}  # a cell that is only closed, in coarse steps
SCAN_S = 0.8  # analysis of a scan of the reference grid
SCF_S = 9.0  # one volume of 28 atoms at 100 hartree
RELAXATION_STEP_S = 8.0  # the same, tightly converged and with forces
STRESS_STEP_S = 12.0  # the same with the stress; 80 hartree on a loaded machine, not yet on an idle one
QUENCH_S = 1.3  # one quench of 28 atoms
PERFECT_QUENCHES, BROKEN_QUENCHES = 75, 10  # until a new network passes its gates: perfect, or with broken bonds
TRANSFORM_S = 0.0049  # of `relative_speed` on the development machine
LONGEST_RUN_H = 12.0  # of a run on one machine, unless it is said to be meant: what a night finishes
GROWS_BY = {  # the key that makes a rule's jobs many or long
    **dict.fromkeys(("make_glass", "run_closing"), "hardness.seeds"),
    **dict.fromkeys(("make_amorphous", "relax_amorphous", "scan_volumes"), "elastic.glass.structures"),
    "scan_relaxed_volumes": "elastic.relaxed_structures",
    "measure_tensor": "elastic.tensor.structures",
    "compute_nominal": "contact.nominal_loads_nN",
    "compute_runs": "uncertainty.seeds",
    "compute_direct_runs": "uncertainty.direct_runs",
    "plan_pad": "pad.pilot_cells",
    "close_cells": "pad.cells",
    "close_draws": "pad.draws",
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
    cycle = LATER_CYCLE + (HOLD * history.dwell_steps if history.dwell_s > 0 else 0.0)
    return history.seeds * history.cycles * (cycle * cycle_s(contact) + RELEASE_S)


class Costs:
    """Costs of the jobs of one scene; `oxides` are the glasses that hardness names by formula."""

    def __init__(self, scene: Scene, oxides: Mapping[str, Material]) -> None:
        self.scene = scene
        self.atom_steps: dict[str, float] = {}  # by closing run
        if "hardness" in scene.stages():
            bodies = (scene.hardness.material, scene.hardness.closing.counter_material)
            rows = plan_rows(scene.hardness, *(oxides[formula] for formula in bodies))
            self.atom_steps = {str(row["run"]): float(row["atom_steps"]) for row in rows[:-1]}

    def seconds(self, rule: str, wildcards: Mapping[str, str]) -> float | None:
        """Seconds of one core; None for a rule that nobody has measured."""
        cost = _SECONDS.get(rule)
        return None if cost is None else START_S + cost(self, wildcards)

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

    @property
    def cell_s(self) -> float:
        """Seconds of one cell of a pad."""
        mechanics = self.scene.contact.mechanics
        return CELL_S[mechanics] * PRESSED[mechanics] * self.cycle_s

    @property
    def scf_size(self) -> float:
        """Cost of a glass cell over that of 28 atoms; measured to 112 atoms (docs/elastic.md)."""
        return (self.scene.elastic.glass.formula_units / 4) ** 2.4

    def make_glass(self, wildcards: Mapping[str, str]) -> float:
        """Melt, quench and rest."""
        glass = self.scene.hardness.glass
        cooling_ps = (glass.melt_temperature_K - glass.final_temperature_K) / glass.quench_rate_K_ps
        steps = 1e3 * (glass.melt_ps + cooling_ps + glass.rest_ps) / glass.timestep_fs
        return steps * glass.atoms / ATOM_STEPS_PER_CORE_SECOND

    def run_closing(self, wildcards: Mapping[str, str]) -> float:
        """Closing of one asperity."""
        return self.atom_steps[wildcards["run"]] / ATOM_STEPS_PER_CORE_SECOND

    def scan_volumes(self, wildcards: Mapping[str, str]) -> float:
        """Energy against volume; relaxed ions need some eight times the clamped ones."""
        elastic = self.scene.elastic
        energies = len(elastic.strains) * (8 if wildcards["ions"] == "relaxed" else 1)
        return SCF_S * energies * self.scf_size * elastic.dft.cutoff_Ha / 100

    def make_amorphous(self, wildcards: Mapping[str, str]) -> float:
        """Quenches of a glass cell until one passes its gates."""
        glass = self.scene.elastic.glass
        quenches = BROKEN_QUENCHES if glass.max_defects else PERFECT_QUENCHES
        return QUENCH_S * quenches * glass.formula_units / 4

    def relax_amorphous(self, wildcards: Mapping[str, str]) -> float:
        """Relaxation of the ions of a glass."""
        relaxation = self.scene.elastic.relaxation
        return RELAXATION_STEP_S * (1 + relaxation.max_steps) * self.scf_size * relaxation.cutoff_Ha / 100

    def measure_tensor(self, wildcards: Mapping[str, str]) -> float:
        """Ions and cell come to rest in a sixth of the steps allowed, a twelfth on two meshes; then strained states."""
        elastic = self.scene.elastic
        states = elastic.tensor.max_steps / 3 + 14 + 6 * elastic.tensor.rounds
        return STRESS_STEP_S * states * self.scf_size * elastic.relaxation.cutoff_Ha / 100

    def compute_runs(self, wildcards: Mapping[str, str]) -> float:
        """A chunk of cycles of a design."""
        return ENGINE_S + self.scene.uncertainty.chunk_runs * (self.cycle_s + FITTED_RUN_S)

    def compute_nominal(self, wildcards: Mapping[str, str]) -> float:
        """A cycle at each load, and the contact spots."""
        return ENGINE_S + 0.5 + len(self.scene.contact.nominal_loads_nN) * self.cycle_s

    def fit_law(self, wildcards: Mapping[str, str]) -> float:
        """Laws of all runs of the collocation."""
        return CURVE_S * collocation_run_count(len(self.scene.inputs.rows()), self.scene.uncertainty)

    def propagate_uncertainty(self, wildcards: Mapping[str, str]) -> float:
        """Responses and their validation."""
        return 0.5 + RESPONSE_RUN_S * self.scene.uncertainty.direct_runs

    def observe_cycles(self, wildcards: Mapping[str, str]) -> float:
        """A chunk of the cycles behind a calibration."""
        return ENGINE_S + self.scene.measurements.chunk_runs * (self.cycle_s + FITTED_RUN_S)

    def sample_posterior(self, wildcards: Mapping[str, str]) -> float:
        """Chains of all tables and of subsets of them, and the cycles where the posterior lies."""
        measurements = self.scene.measurements
        chains = 2 * len(measurements.tables) + 1 + measurements.rounds
        return CHAIN_S * chains + measurements.rounds * measurements.local_runs * (self.cycle_s + FITTED_RUN_S)

    def analyse_scans(self, wildcards: Mapping[str, str]) -> float:
        """A chunk of scans."""
        return self.scene.topography.scans_per_job * SCAN_S * self.scene.topography.synthetic.pixels**2 / GRID

    def plan_pad(self, wildcards: Mapping[str, str]) -> float:
        """Pilot cells."""
        return ENGINE_S + self.scene.pad.pilot_cells * PILOT_CELL[self.scene.contact.mechanics] * self.cell_s

    def close_cells(self, wildcards: Mapping[str, str]) -> float:
        """A chunk of the pad's cells."""
        return ENGINE_S + min(self.scene.pad.chunk_cells, self.scene.pad.cells) * self.cell_s

    def close_draws(self, wildcards: Mapping[str, str]) -> float:
        """A chunk of pads at other inputs; two pilots for each."""
        pad, mechanics = self.scene.pad, self.scene.contact.mechanics
        cells = pad.draw_cells * DRAW_CELL[mechanics] + 2 * PILOT_CELL[mechanics]
        return ENGINE_S + min(pad.chunk_draws, pad.draws) * cells * self.cell_s

    def open_pads(self, wildcards: Mapping[str, str]) -> float:
        """The pads of one case; the first half of the cases is of the first mechanics."""
        adhesion = self.scene.adhesion
        mechanics = adhesion.mechanics[int(wildcards["adhesion_case"]) * len(adhesion.mechanics) // adhesion.case_count]
        cycle = cycle_s(self.scene.contact.model_copy(update={"mechanics": mechanics}))
        return ENGINE_S + adhesion.pads * adhesion.cells * CELL_S[mechanics] * cycle


def _at(content: Any, key: str) -> Any:
    for part in key.split("."):
        content = content[part]
    return content


def _constant(seconds: float) -> Callable[[Costs, Mapping[str, str]], float]:
    return lambda costs, wildcards: seconds


_SECONDS: dict[str, Callable[[Costs, Mapping[str, str]], float]] = {
    **dict.fromkeys(("write_scene", "collect_inputs", "export_law", "combine_e_star"), _constant(0.0)),
    **dict.fromkeys(("find_hardness", "fit_hardness", "fit_bulk_moduli", "fit_nominal_law"), _constant(0.5)),
    "make_crystal": _constant(0.0),
    **dict.fromkeys(("make_glass", "make_counter_glass"), Costs.make_glass),
    "run_closing": Costs.run_closing,
    "make_amorphous": Costs.make_amorphous,
    "relax_amorphous": Costs.relax_amorphous,
    "scan_volumes": Costs.scan_volumes,
    "scan_relaxed_volumes": Costs.scan_volumes,
    "measure_tensor": Costs.measure_tensor,
    "average_tensors": _constant(0.5),
    "measure_elastic_accuracy": _constant(1100.0),
    "write_synthetic_scans": _constant(5.0),
    "analyse_scans": Costs.analyse_scans,
    "pool_spectra": _constant(3.0),
    "draw_surface": _constant(2.0),
    "judge_scans": lambda costs, wildcards: 3.0 + 3.0 * len(costs.scene.topography.scans),
    "weigh_unseen_waves": lambda costs, wildcards: 24 * costs.cycle_s,
    "compute_nominal": Costs.compute_nominal,
    "fit_law": Costs.fit_law,
    "compute_runs": Costs.compute_runs,
    "compute_direct_runs": Costs.compute_runs,
    "propagate_uncertainty": Costs.propagate_uncertainty,
    "rank_sensitivity": _constant(8.5),
    "plan_pad": Costs.plan_pad,
    "close_cells": Costs.close_cells,
    "close_draws": Costs.close_draws,
    "open_pads": Costs.open_pads,
    "summarise_adhesion": _constant(0.0),
    "assemble_pad": lambda costs, wildcards: 2.0 + (ANSWER_S if costs.scene.pad.draws else 0.0),
    "solve_switch": _constant(1.6),
    "render_report": lambda costs, wildcards: 5.5 + 0.5 * len(costs.scene.stages()),
    "measure_pad_accuracy": lambda costs, wildcards: 60.0 + 4 * costs.cell_s,
    "collect_priors": _constant(0.0),
    "follow_history": lambda costs, wildcards: history_s(costs.scene.history, costs.scene.contact),
    "observe_cycles": Costs.observe_cycles,
    "sample_posterior": Costs.sample_posterior,
    "rank_next_on_pad": _constant(20.0),
}


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
