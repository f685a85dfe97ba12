"""Error of a closing against run time, one numerical choice at a time, in small form.

The smallest asperity of a scene is pressed until its contact is some 2 nm wide, without the
snapshots on the way. Two cuts of one glass are the samples. Each is annealed once, on the thickest
base, for half of the scene's time, and every choice then starts from these atoms. All choices but
the speed are varied at four times the scene's speed, where they take a quarter of its time. A
repeat from reversed velocities tells what the motion of the atoms alone changes: an error below it
cannot be seen.
"""

import resource
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from typing import TypeVar

import numpy as np

from atomistic.constants import EV_PER_A3_IN_GPA
from atomistic.for_studies import Deviations, Variation
from atomistic.hardness.asperity import formula_of, neutralise
from atomistic.hardness.closing import cut_body, top_below
from atomistic.hardness.contact_area import Area
from atomistic.hardness.glass import MELT_K, TIMESTEP_FS
from atomistic.hardness.motion import drift_meV_atom_ps, free_motion, heated
from atomistic.hardness.plateau import RULES
from atomistic.hardness.pressing import base_thickness_nm, plan_closing, prepare_body, press_body
from atomistic.hardness.readout import PressedCell, Sample, load_samples
from atomistic.hardness.runs import PROTOCOL, ClosingRun
from atomistic.hardness.top_attraction import combined_cutoffs_nm
from atomistic.lammps import Atoms, LammpsFolder, load_dump, run_lammps
from atomistic.potentials import Potential
from atomistic.settings import AsperitySettings, ClosingSettings

CUTS = (1, 2)
"""Seeds of the cuts from one glass."""
DEPTH = 0.9
"""Travel of the flat below the highest atom, in amplitudes: the contact is then 2 nm wide, a
quarter of the cell.
"""
WINDOW = 0.25
"""Share of this travel, at its end, over which pressure and force are averaged."""
CLEARANCE_NM = 0.02
"""At the start: enough not to touch, as no snapshot before contact is needed."""
ANNEAL_SHARE = 0.5
FAST = 4
"""Times the scene's speed at which all choices but the speed are varied."""
SPEEDS = (4, 2, 1)
TIMESTEPS = (2.0, 1.0)
FINER_TIMESTEP = 0.5
BASES = (0.7, 1.0)
THICKER_BASE = 1.5
"""All over the value in use."""
ITERATIONS = (75, 150)
MORE_ITERATIONS = 600
"""Most steps of the minimiser; relax.in takes 150."""
SOLID_K = {"drift cold": 10.0, "drift hot": PROTOCOL.anneal_temperature_K}
MOLTEN_K = {"drift molten": MELT_K}
FREE_PS = 2.0
"""Time at constant energy."""
PRESSED = [("pressure at depth", "%"), ("force at depth", "%")]
T = TypeVar("T")


@dataclass(frozen=True)
class Choice:
    """How an asperity is pressed; speed, time step and base over those in use.

    `reversed_velocities` : start with them, for a repeat.
    """

    speed: float = FAST
    timestep: float = 1.0
    base: float = 1.0
    reversed_velocities: bool = False


@dataclass(frozen=True)
class Pressed:
    """A pressed cut: pressure (GPa) and force (nN) at the end of its travel, processor seconds."""

    pressure_GPa: float
    force_nN: float
    cpu_s: float
    body: Atoms
    last: Sample
    cell: PressedCell
    folder: LammpsFolder


class SmallClosings:
    """Cuts of a glass, annealed and pressed by several choices; each is computed once.

    Parameters
    ----------
    asperity : its film is left out: the oxide alone is pressed.
    glass : a periodic cell of the oxide.
    work : for LAMMPS; the caller removes it.
    """

    def __init__(
        self,
        asperity: AsperitySettings,
        glass: Atoms,
        potential: Potential,
        closing: ClosingSettings,
        work: Path,
    ) -> None:
        self.glass = glass
        self.potential = potential
        self.closing = closing.model_copy(update={"anneal_ps": ANNEAL_SHARE * closing.anneal_ps})
        self._asperity = asperity.model_copy(update={"film_nm": None})
        self.work = work
        self.base_nm = base_thickness_nm(closing, asperity.tiles * float(glass.cell_A[0]) / 10)
        self._identity = {
            "potential": potential.model_dump(),
            "run": [self._asperity.model_dump(), self.closing.model_dump(), PROTOCOL.model_dump()],
            "glass": [glass.cell_A.tolist(), glass.positions_A.sum(axis=0).tolist()],
        }
        self._bodies: dict[int, Atoms] = {}
        self._pressed: dict[tuple[int, Choice], Pressed] = {}

    def pressed(self, cut: int, choice: Choice) -> Pressed:
        """A cut, pressed by a choice."""
        if (cut, choice) not in self._pressed:
            self._pressed[cut, choice] = self._press(cut, choice)
        return self._pressed[cut, choice]

    def outputs(self, choice: Choice) -> np.ndarray:
        """Pressure and force of each cut, shape (cuts, 2)."""
        runs = [self.pressed(cut, choice) for cut in CUTS]
        return np.array([(run.pressure_GPa, run.force_nN) for run in runs])

    def cpu_s(self, choice: Choice) -> float:
        """Mean over the cuts."""
        return float(np.mean([self.pressed(cut, choice).cpu_s for cut in CUTS]))

    def noise_percent(self) -> np.ndarray:
        """Standard deviation of a run's pressure and force by its atoms' motion, from repeats."""
        first = self.outputs(Choice())
        again = self.outputs(Choice(reversed_velocities=True))
        return 100 * np.sqrt(np.mean((again / first - 1) ** 2, axis=0) / 2)

    def cutoff_nm(self, cut: int, iterations: int) -> tuple[float, float]:
        """D0 of the top below a contact after so many minimiser steps, and processor seconds."""
        run = self.pressed(cut, Choice())
        variables = {"pairs": "pairs", "segment": 1, "iterations": iterations}
        _, cpu_s = _timed(lambda: run_lammps("relax.in", run.folder, variables))
        [(_, relaxed)] = load_dump(run.folder / "relaxed.1")
        unpressed = np.column_stack([run.body.types, run.body.positions_A])
        top = top_below(run.last, relaxed[:, 1:5], unpressed, Area(), run.cell)
        return combined_cutoffs_nm([top])[1], cpu_s

    def _run(self, cut: int) -> ClosingRun:
        return ClosingRun(name=f"cut {cut}", asperity=self._asperity, seed=cut, energy_scale=1.0)

    def _place(self, cut: int) -> tuple[int, ...]:
        return cut, self._asperity.tiles, round(1000 * self._asperity.amplitude_nm)

    def _body(self, cut: int) -> Atoms:
        """A cut on the thickest base, annealed."""
        if cut not in self._bodies:
            place = self._place(cut)
            made = cut_body(
                self._run(cut), self.glass, self.potential, THICKER_BASE * self.base_nm, place
            )
            folder = LammpsFolder(self.work / f"anneal_{cut}", self._identity, "anneal.in")
            settings = (made.force, self.closing, PROTOCOL, folder, place)
            self._bodies[cut] = prepare_body(self._run(cut), made.atoms, made.formula, *settings)
        return self._bodies[cut]

    def _press(self, cut: int, choice: Choice) -> Pressed:
        run = self._run(cut)
        cut_off_A = 10 * (THICKER_BASE - choice.base) * self.base_nm
        body = lowered(self._body(cut), cut_off_A, formula_of(self.glass))
        if choice.reversed_velocities and body.velocities_A_ps is not None:
            body = replace(body, velocities_A_ps=-body.velocities_A_ps)
        closing = self.closing.model_copy(
            update={"speed_m_s": choice.speed * self.closing.speed_m_s}
        )
        changed = {
            "timestep_fs": choice.timestep * PROTOCOL.timestep_fs,
            "approach_nm": CLEARANCE_NM,
        }
        protocol = PROTOCOL.model_copy(update=changed)
        depth_A = 10 * DEPTH * self._asperity.amplitude_nm
        plan = plan_closing(closing, run, protocol)
        sample_A = plan.sample_steps * plan.speed * plan.timestep
        samples = int(np.ceil((depth_A + 10 * CLEARANCE_NM) / sample_A)) + 1
        plan = replace(plan, segment_steps=samples * plan.sample_steps, segments=1)
        identity = {**self._identity, "choice": [cut, asdict(choice)]}
        folder = LammpsFolder(self.work / f"press_{len(self._pressed)}", identity, "closing.in")
        top_A = float(np.max(body.positions_A[:, 2]))

        def press() -> PressedCell:
            force = self.potential
            cell, _ = press_body(
                run, body, force, closing, protocol, plan, self._place(cut), folder, lambda *_: True
            )
            return cell

        cell, cpu_s = _timed(press)
        measured = load_samples(folder, 1, Area(), cell)
        pressure_GPa, force_nN = at_depth([*measured.values()], top_A, depth_A)
        return Pressed(pressure_GPa, force_nN, cpu_s, body, measured[max(measured)], cell, folder)


def variations(closings: SmallClosings) -> list[Variation]:
    """The numerical choices of a closing."""
    return [
        _speeds(closings),
        _timesteps(closings),
        _bases(closings),
        _minimisers(closings),
        _drifts(closings, "time step at constant energy, fs", PROTOCOL.timestep_fs, SOLID_K),
        _drifts(closings, "time step of the melt, fs", TIMESTEP_FS, MOLTEN_K),
    ]


def _speeds(closings: SmallClosings) -> Variation:
    """The speed of the flat, against rest."""
    used = closings.closing.speed_m_s
    # of the runs at each speed in the deviation: 2 q(v) - q(2v) is that of a flat at rest
    weights = {4: (1, 1, 2), 2: (2, 2), 1: (1, 1)}

    def deviations(speed: int) -> Deviations:
        at_rest = 2 * closings.outputs(Choice(speed=1)) - closings.outputs(Choice(speed=2))
        off = 100 * (closings.outputs(Choice(speed=speed)) / at_rest - 1)
        of_sum = closings.noise_percent() * float(np.linalg.norm(weights[speed]))
        noise = of_sum / np.sqrt(len(CUTS))
        return Deviations(off, noise, closings.cpu_s(Choice(speed=speed)))

    values = [(speed * used, partial(deviations, speed)) for speed in SPEEDS]
    reference = f"at rest, on the line through {used:g} and {2 * used:g} m/s"
    return Variation("closing speed, m/s", PRESSED, values, used, reference, _samples())


def _timesteps(closings: SmallClosings) -> Variation:
    """The time step of the closing."""
    used = PROTOCOL.timestep_fs
    best = Choice(timestep=FINER_TIMESTEP)
    values = [
        (factor * used, partial(_against, closings, Choice(timestep=factor), best))
        for factor in TIMESTEPS
    ]
    reference = f"{FINER_TIMESTEP * used:g} fs, {_fast(closings)}"
    return Variation("time step, fs", PRESSED, values, used, reference, _samples())


def _bases(closings: SmallClosings) -> Variation:
    """The thickness of the base."""
    best = Choice(base=THICKER_BASE)
    values = []
    for factor in BASES:
        thickness_nm = round(factor * closings.base_nm, 2)
        values.append((thickness_nm, partial(_against, closings, Choice(base=factor), best)))
    reference = f"{THICKER_BASE * closings.base_nm:.2f} nm, {_fast(closings)}"
    return Variation("base, nm", PRESSED, values, round(closings.base_nm, 2), reference, _samples())


def _against(closings: SmallClosings, choice: Choice, best: Choice) -> Deviations:
    off = 100 * (closings.outputs(choice) / closings.outputs(best) - 1)
    noise = closings.noise_percent() * np.sqrt(2 / len(CUTS))
    return Deviations(off, noise, closings.cpu_s(choice))


def _minimisers(closings: SmallClosings) -> Variation:
    """Steps of the minimiser, by what they leave of D0: the same contact is relaxed each time."""
    best: list[float] = []

    def deviations(iterations: int) -> Deviations:
        if not best:
            best.extend(closings.cutoff_nm(cut, MORE_ITERATIONS)[0] for cut in CUTS)
        cutoffs_nm, cpu_s = np.array([closings.cutoff_nm(cut, iterations) for cut in CUTS]).T
        off = 100 * (cutoffs_nm / np.array(best) - 1)
        return Deviations(off[:, None], np.zeros(1), float(cpu_s.mean()))

    values = [(iterations, partial(deviations, iterations)) for iterations in ITERATIONS]
    quantities = [("D0", "%")]
    return Variation(
        "steps of the minimiser",
        quantities,
        values,
        max(ITERATIONS),
        f"{MORE_ITERATIONS} steps",
        _samples(),
    )


def _drifts(
    closings: SmallClosings, name: str, used_fs: float, temperatures_K: dict[str, float]
) -> Variation:
    """A time step at constant energy: the drift of the glass's energy, which has to be none."""

    def drift(timestep_fs: float, kelvin: float, seed: int) -> float:
        atoms = heated(closings.glass, closings.potential, kelvin, seed)
        steps = round(1000 * FREE_PS / timestep_fs)
        record, _ = free_motion(
            atoms, closings.potential, closings.work / "nve", timestep_fs, steps
        )
        return drift_meV_atom_ps(record, len(atoms), timestep_fs)

    def deviations(timestep_fs: float) -> Deviations:

        def drifts_of_cuts() -> np.ndarray:
            kelvins = temperatures_K.values()
            return np.array(
                [[drift(timestep_fs, kelvin, cut) for kelvin in kelvins] for cut in CUTS]
            )

        drifts, cpu_s = _timed(drifts_of_cuts)
        return Deviations(drifts, np.zeros(len(temperatures_K)), cpu_s / drifts.size)

    values = [(factor * used_fs, partial(deviations, factor * used_fs)) for factor in TIMESTEPS]
    quantities = [(quantity, "meV per atom and ps") for quantity in temperatures_K]
    samples = f"{len(CUTS)} starts of {FREE_PS:g} ps"
    reference = f"no drift (gate of a closing: {RULES.max_drift_meV_atom_ps:g})"
    return Variation(name, quantities, values, used_fs, reference, samples)


def lowered(body: Atoms, by_A: float, formula: np.ndarray) -> Atoms:
    """A body without its lowest layer, standing at z = 0 and neutral.

    Parameters
    ----------
    by_A : thickness of the layer.
    formula : of `neutralise`.
    """
    above = body.take(body.positions_A[:, 2] >= by_A)
    standing = replace(above, positions_A=above.positions_A - [0.0, 0.0, by_A])
    return neutralise(standing, formula)


def at_depth(samples: Sequence[Sample], top_A: float, depth_A: float) -> tuple[float, float]:
    """Mean contact pressure (GPa) and force (nN) over the end of a travel.

    Parameters
    ----------
    samples : of the run, in order.
    top_A : height of the highest atom before contact.
    depth_A : of the flat below it, at the end.
    """
    depth = top_A - np.array([sample.averages[0] for sample in samples])
    force = np.array([sample.averages[1] for sample in samples])
    area = np.array([sample.area_A2 for sample in samples])
    places = np.linspace((1 - WINDOW) * depth_A, depth_A, 50)
    mean_force = float(np.mean(np.interp(places, depth, force)))
    mean_area = float(np.mean(np.interp(places, depth, area)))
    return mean_force / mean_area * EV_PER_A3_IN_GPA, mean_force * EV_PER_A3_IN_GPA / 100


def _samples() -> str:
    return f"{len(CUTS)} cuts of one glass"


def _fast(closings: SmallClosings) -> str:
    return f"all at {FAST * closings.closing.speed_m_s:g} m/s"


def _timed(compute: Callable[[], T]) -> tuple[T, float]:
    """What is computed, and processor seconds of this process and of LAMMPS."""
    before = _processor_s()
    result = compute()
    return result, _processor_s() - before


def _processor_s() -> float:
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + children.ru_utime + children.ru_stime
