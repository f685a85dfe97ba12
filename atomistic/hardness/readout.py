"""What a closing run measured, read from the files that LAMMPS left: the curve, the witness, the pictures."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.spatial import KDTree

from atomistic.constants import EV_PER_A3_IN_GPA
from atomistic.hardness.contact_area import contact_area
from atomistic.lammps import Workspace, load_averages, load_dump
from atomistic.settings import AreaSettings

NEAR, FAR = 0.9, 1.2  # bond lengths in units of the first minimum of g(r)
TOP_ATOMS = 8
SLICE_A = 4.0  # half the thickness of the slices for pictures
Rows = list[dict[str, float]]
Frame = np.ndarray  # rows (type, x, y, z), ordered by atom id


@dataclass(frozen=True)
class Geometry:
    """Where the contact is: periodic cell, axis of the contact, atoms below and above; lengths in Å.

    Attributes
    ----------
    axis_A : x and y of the peak (or of the sphere's centre).
    lower : atoms of the asperity; ids above belong to the counterface.
    top_radius_A : the top is looked for within this distance of the axis.
    """

    wavelength_A: float
    axis_A: float
    lower: int
    atoms: int
    bodies: int
    top_radius_A: float


Areas = dict[tuple[int, float], float]


def load_curve(
    workspace: Workspace, segments: range, segment_steps: int, area: AreaSettings, geometry: Geometry, known: Areas
) -> Rows:
    """Averages over `area.snapshots` samples of force, contact area and temperature, with the energy balance.

    Parameters
    ----------
    known : areas by step and depth, kept from one reading of a growing run to the next.
    """
    rows: dict[int, np.ndarray] = {}
    near: dict[int, np.ndarray] = {}
    for n in segments:  # the last step of a segment may stand in the next one again: the first one counts
        rows = {int(row[0]): row for row in load_averages(workspace / f"averages.{n}")} | rows
        near = dict(load_dump(workspace / f"near.{n}")) | near
    steps = sorted(rows)
    touching = {step: beyond_counterface(near[step], geometry, area.touch_A) for step in steps}
    cell = (geometry.wavelength_A, geometry.wavelength_A)
    axis = (geometry.axis_A, geometry.axis_A)

    def areas(depth_A: float) -> np.ndarray:
        for step, (places, beyond) in touching.items():
            if (step, depth_A) not in known:
                known[step, depth_A] = contact_area(places[beyond > -depth_A], cell, area, axis)
        return np.array([known[step, depth_A] for step in steps])

    contact_areas = areas(area.depth_A)
    other_areas = {depth: areas(depth) for depth in area.other_depths_A}
    table = np.array([rows[step] for step in steps])
    position, force, temperature, energy, drive = table[:, 1:].T
    # energy balance: the work of what moves is the only energy that may come in; segments start afresh
    # because the count of the thermostat's energy does
    gained = np.zeros(len(steps))
    for k in range(1, len(steps)):
        new_segment = (steps[k] - 1) // segment_steps != (steps[k - 1] - 1) // segment_steps
        work = 0.5 * (drive[k] + drive[k - 1]) * (position[k - 1] - position[k])
        gained[k] = gained[k - 1] + (0.0 if new_segment else energy[k] - energy[k - 1] - work)
    curve = []
    per = area.snapshots
    for k in range(0, len(steps) - per + 1, per):
        part = slice(k, k + per)
        contact, push = float(np.mean(contact_areas[part])), float(np.mean(force[part]))
        curve.append(
            {
                "step": steps[k + per - 1],
                "displacement_nm": float(position[0] - np.mean(position[part])) / 10,
                "force_nN": push * EV_PER_A3_IN_GPA / 100,
                "nominal_stress_GPa": push / geometry.wavelength_A**2 * EV_PER_A3_IN_GPA,
                "contact_area_nm2": contact / 100,
                "contact_length_nm": float(np.sqrt(contact)) / 10,
                "contact_stress_GPa": push / contact * EV_PER_A3_IN_GPA if contact > 0 else float("nan"),
                "temperature_K": float(np.mean(temperature[part])),
                "energy_drift_meV_per_atom": 1000 * float(np.mean(gained[part])) / geometry.atoms,
                "contact_atoms": float(np.mean([np.sum(touching[step][1] > -area.depth_A) for step in steps[part]])),
                "atoms": geometry.atoms,
                **{
                    f"contact_area_nm2_depth_{depth:g}A": float(np.mean(values[part])) / 100
                    for depth, values in other_areas.items()
                },
            }
        )
    return curve


def beyond_counterface(near: np.ndarray, geometry: Geometry, touch_A: float) -> tuple[np.ndarray, np.ndarray]:
    """Places (x, y) of the asperity's atoms near the contact, and how far they lie beyond the counterface.

    Beyond a body of atoms: how much nearer than `touch_A` its nearest atom is.
    """
    if geometry.bodies == 1:
        return near[:, 2:4], near[:, 5]
    below = near[:, 0] <= geometry.lower
    if np.all(below) or not np.any(below):
        return np.empty((0, 2)), np.empty(0)
    box = np.array([geometry.wavelength_A, geometry.wavelength_A, 0.0])  # 0: not periodic
    positions = near[:, 2:5].copy()
    positions[:, :2] = np.mod(positions[:, :2], geometry.wavelength_A)
    distance, _ = KDTree(positions[~below], boxsize=box).query(positions[below])
    return near[below, 2:4], touch_A - distance


def load_relaxed(workspace: Workspace, segment: int) -> tuple[int, Frame]:
    """Step and frame of a relaxed snapshot."""
    [(step, table)] = load_dump(workspace / f"relaxed.{segment}")
    return step, table[:, 1:5]


def witness_rows(
    frames: list[tuple[int, Frame]],
    displacement_nm: Callable[[int], float],
    cation_types: list[int],
    cutoff_A: float,
    held_A: float,
    geometry: Geometry,
) -> Rows:
    """Bonds exchanged and lowering of the top since the first snapshot (no contact yet).

    A bond counts as broken (formed) when its length passes from below `NEAR` to above `FAR` times the first
    minimum of g(r) (or back): bonds that flicker about one cutoff do not count.
    """
    bonds = [
        tuple(_bonds(frame, cation_types, factor * cutoff_A, geometry.wavelength_A) for factor in (NEAR, FAR))
        for _, frame in frames
    ]
    first = frames[0][1]
    held = first[:, 3] < first[:, 3].min() + 0.8 * held_A
    tops = [_top(frame, geometry) - np.mean(frame[held, 3] - first[held, 3]) for _, frame in frames]
    return [
        {
            "step": step,
            "displacement_nm": displacement_nm(step),
            "exchanged_bonds": _exchanges(bonds[0], bonds[k]),
            "new_exchanges": _exchanges(bonds[max(0, k - 1)], bonds[k]),
            "lowering_nm": float(tops[0] - tops[k]) / 10,
        }
        for k, (step, _) in enumerate(frames)
    ]


Bonds = set[tuple[int, int]]


def _exchanges(before: tuple[Bonds, ...], after: tuple[Bonds, ...]) -> int:
    """Broken and formed bonds, given the (near, far) pairs before and after."""
    return len(before[0] - after[1]) + len(after[0] - before[1])


def _bonds(frame: Frame, cation_types: list[int], cutoff_A: float, wavelength_A: float) -> Bonds:
    is_cation = np.isin(frame[:, 0], cation_types)
    box = np.array([wavelength_A, wavelength_A, 0.0])  # 0: not periodic
    positions = frame[:, 1:4].copy()
    positions[:, :2] = np.mod(positions[:, :2], wavelength_A)
    pairs = KDTree(positions, boxsize=box).query_pairs(cutoff_A, output_type="ndarray")
    mixed = pairs[is_cation[pairs[:, 0]] != is_cation[pairs[:, 1]]]
    return set(map(tuple, mixed.tolist()))


def _top(frame: Frame, geometry: Geometry) -> float:
    """Mean height of the highest atoms about the axis."""
    apart = frame[:, 1:3] - geometry.axis_A
    apart -= geometry.wavelength_A * np.round(apart / geometry.wavelength_A)
    near = np.hypot(apart[:, 0], apart[:, 1]) <= geometry.top_radius_A
    return float(np.mean(np.sort(frame[near, 3])[-TOP_ATOMS:]))


def slice_rows(frames: list[tuple[int, Frame]], geometry: Geometry) -> Rows:
    """Atoms of a 0.8 nm slice through the axis, of every relaxed snapshot."""
    rows = []
    for step, frame in frames:
        off = np.abs(frame[:, 2] - geometry.axis_A) < SLICE_A
        for kind, x, y, z in frame[off].tolist():
            rows.append({"step": step, "type": int(kind), "x_nm": x / 10, "y_nm": y / 10, "z_nm": z / 10})
    return rows
