"""What a closing run measured, read from the files that LAMMPS left: the curve and the witness."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

from atomistic.constants import EV_PER_A3_IN_GPA
from atomistic.hardness.asperity import TOP_ATOMS
from atomistic.hardness.contact_area import Area, contact_area
from atomistic.lammps import LammpsFolder, load_averages, load_dump

Rows = list[dict[str, float]]
Bonds = set[tuple[int, int]]
Frame = np.ndarray  # rows (type, x, y, z), ordered by atom id


@dataclass(frozen=True)
class PressedCell:
    """The periodic cell of a pressed body, Å; `atoms` counts its atoms."""

    wavelength_A: float
    atoms: int

    @property
    def axis_A(self) -> float:
        """x and y of the peak, where the contact is."""
        return self.wavelength_A / 4


@dataclass(frozen=True)
class OxideBond:
    """What joins cation and anion, by type; `length_A` is the first minimum of their g(r)."""

    cation: int
    anion: int
    length_A: float


@dataclass(frozen=True)
class Sample:
    """One moment of a closing.

    Attributes
    ----------
    averages : position, force and temperature, as the script wrote them.
    area_A2 : contact area, Å².
    touching_A : places (x, y) of the atoms in contact, shape (atoms, 2).
    """

    averages: np.ndarray
    area_A2: float
    touching_A: np.ndarray


@dataclass(frozen=True)
class Relaxed:
    """A snapshot relaxed without its counterface, with bonds below 0.9 and 1.2 `length_A`."""

    step: int
    frame: Frame
    bonds: tuple[Bonds, Bonds]


class Readout:
    """What a growing run has measured; every file is read once.

    Parameters
    ----------
    per_average : samples of an average.
    bond : what counts as one; None: nothing does.
    """

    def __init__(
        self,
        workspace: LammpsFolder,
        segment_steps: int,
        timestep_ps: float,
        per_average: int,
        area: Area,
        cell: PressedCell,
        bond: OxideBond | None,
    ) -> None:
        self._workspace, self._segment_steps, self._timestep_ps = (
            workspace,
            segment_steps,
            timestep_ps,
        )
        self._per_average, self.area, self._cell = per_average, area, cell
        self._bond = bond
        self._samples: dict[int, dict[int, Sample]] = {}
        self._ends: dict[int, np.ndarray] = {}
        self._relaxed: dict[int, Relaxed] = {}

    def curve(self, segments: range) -> Rows:
        """Averages over samples of force, contact area and temperature, with the energy balance."""
        samples: dict[int, Sample] = {}
        # the last step of a segment may stand in the next one again: the first one counts
        for n in segments:
            if n not in self._samples:
                self._samples[n] = load_samples(self._workspace, n, self.area, self._cell)
            samples = self._samples[n] | samples
        balances = {n: self._end(n) for n in (segments[0] - 1, *segments)}
        drift = energy_drift(balances, self._segment_steps, samples)
        return curve_rows(samples, drift, self._timestep_ps, self._per_average, self._cell)

    def _end(self, segment: int) -> np.ndarray:
        """Position, energy and heat at the end of a segment."""
        if segment not in self._ends:
            self._ends[segment] = load_averages(self._workspace / f"energy.{segment}")[0]
        return self._ends[segment]

    def last_sample(self, segment: int) -> Sample:
        """The sample at the end of a segment, whose relaxed snapshot follows it."""
        samples = self._samples[segment]
        return samples[max(samples)]

    def relaxed(self, segment: int) -> Relaxed:
        """The relaxed snapshot after a segment; 0: before the first."""
        if segment not in self._relaxed:
            [(step, table)] = load_dump(self._workspace / f"relaxed.{segment}")
            frame = table[:, 1:5]
            wavelength = self._cell.wavelength_A
            near, far = (bonds_of(frame, self._bond, factor, wavelength) for factor in (0.9, 1.2))
            self._relaxed[segment] = Relaxed(step, frame, (near, far))
        return self._relaxed[segment]


def load_samples(
    workspace: LammpsFolder, segment: int, area: Area, cell: PressedCell
) -> dict[int, Sample]:
    """What a segment measured, by step."""
    near = dict(load_dump(workspace / f"near.{segment}"))
    side = (cell.wavelength_A, cell.wavelength_A)
    axis = (cell.axis_A, cell.axis_A)
    samples = {}
    for step, *averages in load_averages(workspace / f"averages.{segment}"):
        atoms = near[int(step)]  # id, type, x, y, z, and how far beyond the flat
        touching = atoms[atoms[:, 5] > -area.depth_A, 2:4]
        samples[int(step)] = Sample(
            np.array(averages), contact_area(touching, side, area, axis), touching
        )
    return samples


def energy_drift(
    balances: Mapping[int, np.ndarray], segment_steps: int, samples: Mapping[int, Sample]
) -> dict[int, float]:
    """What the energy balance gained until the end of each segment, eV by step.

    The work of what moves is the only energy that may come in, the heat of the thermostats the only
    one that may leave.

    Parameters
    ----------
    ends : position, energy and heat at the ends of consecutive segments, by segment; the first is
        where the balance begins.
    """
    numbers = sorted(balances)
    place, energy, heat = np.array([balances[n] for n in numbers]).T
    steps = sorted(samples)
    position, drive, _ = np.array([samples[step].averages for step in steps]).T
    # between the samples by trapezoids, since the force rises; beyond the last before an end it is
    # held
    steps_of_work = 0.5 * (drive[1:] + drive[:-1]) * (position[:-1] - position[1:])
    between = np.concatenate([[0.0], np.cumsum(steps_of_work)])
    last = np.searchsorted(steps, segment_steps * np.array(numbers[1:]), side="right") - 1
    before = drive[0] * (place[0] - position[0])
    after = drive[last] * (position[last] - place[1:])
    work = before + between[last] + after
    gained = energy[1:] - energy[0] + np.cumsum(heat[1:]) - work
    drift = [0.0, *gained.tolist()]
    return dict(zip([segment_steps * n for n in numbers], drift, strict=True))


def curve_rows(
    samples: Mapping[int, Sample],
    drift: Mapping[int, float],
    timestep_ps: float,
    per_average: int,
    cell: PressedCell,
) -> Rows:
    """Rows of the curve of the samples of consecutive segments.

    Parameters
    ----------
    drift : of `energy_drift`; a row has the value between two ends of segments on the line through
        them.
    """
    steps = sorted(samples)
    position, force, temperature = np.array([samples[step].averages for step in steps]).T
    gained = np.interp(steps, list(drift), list(drift.values()))
    curve = []
    for k in range(0, len(steps) - per_average + 1, per_average):
        window = slice(k, k + per_average)
        averaged = [samples[step] for step in steps[k : k + per_average]]
        contact = float(np.mean([sample.area_A2 for sample in averaged]))
        push = float(np.mean(force[window]))
        step = steps[k + per_average - 1]
        contact_stress = float("nan")
        if contact > 0:
            contact_stress = push / contact * EV_PER_A3_IN_GPA
        atoms = [len(sample.touching_A) for sample in averaged]
        curve.append(
            {
                "step": step,
                "time_ps": step * timestep_ps,
                "displacement_nm": float(position[0] - np.mean(position[window])) / 10,
                "force_nN": push * EV_PER_A3_IN_GPA / 100,
                "nominal_stress_GPa": push / cell.wavelength_A**2 * EV_PER_A3_IN_GPA,
                "contact_area_nm2": contact / 100,
                "contact_length_nm": float(np.sqrt(contact)) / 10,
                "contact_stress_GPa": contact_stress,
                "temperature_K": float(np.mean(temperature[window])),
                "energy_drift_meV_per_atom": 1000 * float(np.mean(gained[window])) / cell.atoms,
                "contact_atoms": float(np.mean(atoms)),
                "atoms": cell.atoms,
            }
        )
    return curve


def witness_rows(
    snapshots: Sequence[Relaxed], timestep_ps: float, speed_A_ps: float, held_A: float
) -> Rows:
    """Bonds exchanged and lowering of the top since the first snapshot (no contact yet).

    A bond counts as broken (formed) when its length passes from below 0.9 to above 1.2 times the
    first minimum of g(r) (or back): bonds that flicker about one cutoff do not count.

    Parameters
    ----------
    speed_A_ps : of the flat.
    held_A : thickness of the rigid bottom.
    """
    first = snapshots[0].frame
    held = first[:, 3] < first[:, 3].min() + 0.8 * held_A
    tops = []
    for snapshot in snapshots:
        settled = np.mean(snapshot.frame[held, 3] - first[held, 3])
        tops.append(_top(snapshot.frame) - settled)
    bonds = [snapshot.bonds for snapshot in snapshots]
    rows = []
    for k, snapshot in enumerate(snapshots):
        row: dict[str, float] = {"step": snapshot.step}
        row["displacement_nm"] = snapshot.step * timestep_ps * speed_A_ps / 10
        row["exchanged_bonds"] = _exchanges(bonds[0], bonds[k])
        row["new_exchanges"] = _exchanges(bonds[max(0, k - 1)], bonds[k])
        row["lowering_nm"] = float(tops[0] - tops[k]) / 10
        rows.append(row)
    return rows


def _exchanges(before: tuple[Bonds, Bonds], after: tuple[Bonds, Bonds]) -> int:
    """Broken and formed bonds, given the (near, far) pairs before and after."""
    return len(before[0] - after[1]) + len(after[0] - before[1])


def bonds_of(frame: Frame, bond: OxideBond | None, factor: float, wavelength_A: float) -> Bonds:
    """Pairs of cation and anion nearer than `factor` bond lengths, as rows of the frame."""
    if bond is None:
        return set()
    box = np.array([wavelength_A, wavelength_A, 0.0])  # 0: not periodic
    positions = frame[:, 1:4].copy()
    positions[:, :2] = np.mod(positions[:, :2], wavelength_A)
    pairs = KDTree(positions, boxsize=box).query_pairs(
        factor * bond.length_A, output_type="ndarray"
    )
    kinds = np.sort(frame[pairs, 0], axis=1)
    bonded = np.all(kinds == sorted((bond.cation, bond.anion)), axis=1)
    return set(map(tuple, pairs[bonded].tolist()))


def _top(frame: Frame) -> float:
    """Mean height of the highest atoms."""
    return float(np.mean(np.sort(frame[:, 3])[-TOP_ATOMS:]))
