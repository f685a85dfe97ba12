"""One closing run: cut, anneal, press against the flat, relax without it; returns the measured curve."""

import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.spatial import cKDTree

from atomistic.asperity import cut_asperity, formula_of, remove_strays, top_height, with_vacuum
from atomistic.contact_area import contact_area
from atomistic.glass import REFERENCES, cations, write_forcefield
from atomistic.lammps import (
    Atoms,
    Progress,
    Workspace,
    read_averages,
    read_data,
    read_dump,
    run_lammps,
    write_data,
)
from atomistic.potentials import Potential
from atomistic.runs import ClosingRun
from atomistic.settings import AreaSettings, AsperitySettings, HardnessSettings

EV_A3_GPA = 160.21766  # 1 eV/Å^3 in GPa
NEAR, FAR = 0.9, 1.2  # bond lengths in units of the first minimum of g(r)


@dataclass(frozen=True)
class Plan:
    """Steps and lengths of a closing in LAMMPS units (Å, ps)."""

    timestep: float
    speed: float
    sample_steps: int
    segment_steps: int
    segments: int
    anneal_steps: int

    @property
    def total_steps(self) -> int:
        return self.segments * self.segment_steps + 2 * self.anneal_steps


def plan_closing(settings: HardnessSettings, asperity: AsperitySettings) -> Plan:
    """Divide the travel into samples (for averages) and segments (for restart files)."""
    closing, area = settings.closing, settings.area
    timestep, speed = closing.timestep_fs / 1000, closing.speed_m_s / 100
    per_sample = area.travel_A / area.snapshots / (speed * timestep)
    sample = max(5, 5 * round(per_sample / 5))
    segment = sample * max(1, round(10 * closing.segment_nm / (sample * speed * timestep)))
    travel = 10 * (closing.approach_nm + closing.depth_over_amplitude * asperity.amplitude_nm)
    segments = int(np.ceil(travel / (segment * speed * timestep)))
    return Plan(timestep, speed, sample, segment, segments, round(closing.anneal_ps / timestep))


@dataclass(frozen=True)
class Closing:
    """Result of a closing run.

    curve : one row per average over `travel_A` (columns as in docs/hardness.md).
    witness : one row per relaxed snapshot: bond exchanges and lasting lowering against the first.
    snapshots : slices through the contact of the relaxed snapshots, for pictures.
    """

    curve: list[dict[str, float]]
    witness: list[dict[str, float]]
    snapshots: list[dict[str, float]]
    summary: dict[str, float]


def run_closing(
    run: ClosingRun,
    glass: Atoms,
    potential: Potential,
    settings: HardnessSettings,
    work: Path,
    progress: Progress | None = None,
) -> Closing:
    """Carry out a run, or go on with it if `work` holds its restart files; `work` is deleted at the end."""
    closing, plan = settings.closing, plan_closing(settings, run.asperity)
    identity = {
        "potential": potential.model_dump(),
        "run": [run.asperity.model_dump(), run.seed, run.energy_scale],
        "settings": settings.model_dump(include={"closing": True, "area": True, "material": True}),
        "glass": [glass.cell_A.tolist(), glass.positions_A.sum(axis=0).tolist()],
    }
    place = (run.seed, run.asperity.tiles, round(1000 * run.asperity.amplitude_nm))
    atoms = _prepare(
        run,
        glass,
        potential,
        settings,
        Workspace(work / "anneal", identity, "anneal.in"),
        plan,
        place,
        progress,
    )
    workspace = Workspace(work / "closing", identity, "closing_flat.in")
    start = top_height(atoms.positions_A[:, 2]) + 10 * closing.approach_nm
    done = workspace.segments_done(plan.segments)
    if not done:
        write_forcefield(workspace, potential, glass.elements, run.energy_scale)
        write_data(workspace / "annealed.data", atoms, _masses(potential, glass.elements))

    def on_step(step: int) -> None:
        if progress is not None:
            travelled = step * plan.timestep * plan.speed / 10
            progress((2 * plan.anneal_steps + step) / plan.total_steps, f"closed by {travelled:.2f} nm")

    if done < plan.segments:
        variables = {
            "data": "annealed.data",
            "pairs": "pairs",
            "seed": _lammps_seed(*place, 5),
            "timestep": plan.timestep,
            "frozen": 10 * closing.frozen_nm,
            "bath": 10 * (closing.frozen_nm + closing.thermostat_nm),
            "temperature": closing.temperature_K,
            "stiffness": closing.wall_stiffness_eV_A3 * run.energy_scale,
            "plane_start": float(start),
            "speed": plan.speed,
            "sample": plan.sample_steps,
            "steps": plan.segment_steps,
            "segment": range(done + 1, plan.segments + 1),
            "previous": range(done, plan.segments),
        }
        run_lammps("closing_flat.in", workspace, variables, on_step, closing.processes, closing.launcher)
    relaxed = [n for n in range(1, plan.segments + 1) if not (workspace / f"relaxed.{n}").exists()]
    if relaxed:
        run_lammps("relax.in", workspace, {"pairs": "pairs", "segment": relaxed})
    frames = list(_relaxed(workspace, plan.segments))
    result = Closing(
        curve=_curve(workspace, plan, settings.area, glass.cell_A[0] * run.asperity.tiles, len(atoms)),
        witness=_witness(frames, plan, settings.material, potential, glass.elements, atoms.cell_A),
        snapshots=_slices(frames, atoms.cell_A),
        summary={
            "atoms": len(atoms),
            "steps": plan.total_steps,
            "wavelength_nm": float(atoms.cell_A[0]) / 10,
        },
    )
    shutil.rmtree(work)
    return result


def _prepare(
    run: ClosingRun,
    glass: Atoms,
    potential: Potential,
    settings: HardnessSettings,
    workspace: Workspace,
    plan: Plan,
    place: tuple[int, int, int],
    progress: Progress | None,
) -> Atoms:
    """Cut the asperity, anneal its surface, remove strays."""
    closing = settings.closing
    done = workspace.segments_done(2)
    if not done:
        cut = cut_asperity(
            glass,
            run.asperity.tiles,
            10 * run.asperity.amplitude_nm,
            10 * closing.base_nm,
            _lammps_seed(*place, 3),
        )
        write_forcefield(workspace, potential, glass.elements, run.energy_scale)
        write_data(workspace / "cut.data", cut, _masses(potential, glass.elements))
    hot = max(closing.temperature_K, closing.anneal_temperature_K * run.energy_scale)

    def on_step(step: int) -> None:
        if progress is not None:
            progress(step / plan.total_steps, "annealing the surface")

    if done < 2:
        variables = {
            "data": "cut.data",
            "pairs": "pairs",
            "seed": _lammps_seed(*place, 4),
            "timestep": plan.timestep,
            "frozen": 10 * closing.frozen_nm,
            "segment": range(done + 1, 3),
            "previous": range(done, 2),
            "from": [hot, hot][done:],
            "to": [hot, closing.temperature_K][done:],
            "steps": [plan.anneal_steps] * (2 - done),
        }
        run_lammps("anneal.in", workspace, variables, on_step, closing.processes, closing.launcher)
    annealed = read_data(workspace / "annealed.data", glass.elements)
    kept = remove_strays(annealed, formula_of(glass))
    return with_vacuum(kept, float(annealed.cell_A[2]))


def _masses(potential: Potential, elements: tuple[str, ...]) -> dict[str, float]:
    return {ion: potential.species[ion].mass_u for ion in elements}


def _lammps_seed(*entropy: int) -> int:
    """A seed that LAMMPS accepts; neighbouring ones (it adds the segment's number) stay distinct."""
    return 1000 * (1 + int(np.random.SeedSequence(entropy).generate_state(1)[0] % 800_000))


def _curve(
    workspace: Workspace, plan: Plan, area: AreaSettings, wavelength_A: float, atoms: int
) -> list[dict[str, float]]:
    """Averages over `area.travel_A` of force, contact area and temperature, with the energy balance."""
    rows: dict[int, np.ndarray] = {}
    near: dict[int, np.ndarray] = {}
    for n in range(1, plan.segments + 1):
        rows |= {int(row[0]): row for row in read_averages(workspace / f"averages.{n}")}
        near |= dict(read_dump(workspace / f"near.{n}"))
    steps = sorted(rows)
    cell = (wavelength_A, wavelength_A)
    peak = (wavelength_A / 4, wavelength_A / 4)

    def areas(depth_A: float) -> np.ndarray:
        return np.array(
            [
                contact_area(near[step][near[step][:, 4] > -depth_A, 2:4], cell, area.disc_A, area.grid_A, peak)
                for step in steps
            ]
        )

    contact_areas = areas(area.depth_A)
    other_areas = {depth: areas(depth) for depth in area.other_depths_A}
    table = np.array([rows[step] for step in steps])
    plane, force, temperature, energy = table[:, 1:].T
    # energy balance: what the plane has done is the only energy that may come in; segments start afresh
    # because the count of the thermostat's energy does
    gained = np.zeros(len(steps))
    for k in range(1, len(steps)):
        new_segment = (steps[k] - 1) // plan.segment_steps != (steps[k - 1] - 1) // plan.segment_steps
        work = 0.5 * (force[k] + force[k - 1]) * (plane[k - 1] - plane[k])
        gained[k] = gained[k - 1] + (0.0 if new_segment else energy[k] - energy[k - 1] - work)
    curve = []
    per = area.snapshots
    for k in range(0, len(steps) - per + 1, per):
        part = slice(k, k + per)
        contact, push = float(np.mean(contact_areas[part])), float(np.mean(force[part]))
        curve.append(
            {
                "step": steps[k + per - 1],
                "displacement_nm": float(plane[0] - np.mean(plane[part])) / 10,
                "force_nN": push * EV_A3_GPA / 100,
                "nominal_stress_GPa": push / wavelength_A**2 * EV_A3_GPA,
                "contact_area_nm2": contact / 100,
                "contact_length_nm": float(np.sqrt(contact)) / 10,
                "contact_stress_GPa": push / contact * EV_A3_GPA if contact > 0 else float("nan"),
                "temperature_K": float(np.mean(temperature[part])),
                "energy_drift_meV_per_atom": 1000 * float(np.mean(gained[part])) / atoms,
                "contact_atoms": float(np.mean([np.sum(near[step][:, 4] > -area.depth_A) for step in steps[part]])),
                "atoms": atoms,
                **{
                    f"contact_area_nm2_depth_{depth:g}A": float(np.mean(values[part])) / 100
                    for depth, values in other_areas.items()
                },
            }
        )
    return curve


def _relaxed(workspace: Workspace, segments: int) -> Iterator[tuple[int, np.ndarray]]:
    """Types and positions of each relaxed snapshot, ordered by atom id: rows (type, x, y, z)."""
    for n in range(1, segments + 1):
        [(step, table)] = read_dump(workspace / f"relaxed.{n}")
        yield step, table[:, 1:5]


def _witness(
    frames: list[tuple[int, np.ndarray]],
    plan: Plan,
    material: str,
    potential: Potential,
    elements: tuple[str, ...],
    cell_A: np.ndarray,
) -> list[dict[str, float]]:
    """Bonds exchanged and lowering of the top since the first snapshot (no contact yet).

    A bond counts as broken (formed) when its length passes from below `NEAR` to above `FAR` times the first
    minimum of g(r) (or back): bonds that flicker about one cutoff do not count.
    """
    kinds = [elements.index(ion) + 1 for ion in cations(material, potential)]
    cutoff = REFERENCES[material].cutoff_A
    bonds = [
        (_bonds(frame, kinds, NEAR * cutoff, cell_A), _bonds(frame, kinds, FAR * cutoff, cell_A)) for _, frame in frames
    ]
    top = _mean_top(frames[0][1])
    rows = []
    for k, (step, frame) in enumerate(frames):
        rows.append(
            {
                "step": step,
                "displacement_nm": step * plan.timestep * plan.speed / 10,
                "exchanged_bonds": _exchanges(bonds[0], bonds[k]),
                "new_exchanges": _exchanges(bonds[max(0, k - 1)], bonds[k]),
                "lowering_nm": (top - _mean_top(frame)) / 10,
            }
        )
    return rows


Bonds = set[tuple[int, int]]


def _exchanges(before: tuple[Bonds, Bonds], after: tuple[Bonds, Bonds]) -> int:
    """Broken and formed bonds, given the (near, far) pairs before and after."""
    return len(before[0] - after[1]) + len(after[0] - before[1])


def _bonds(frame: np.ndarray, cation_types: list[int], cutoff_A: float, cell_A: np.ndarray) -> Bonds:
    is_cation = np.isin(frame[:, 0], cation_types)
    box = np.array([cell_A[0], cell_A[1], 0.0])  # 0: not periodic
    positions = frame[:, 1:4].copy()
    positions[:, :2] = np.mod(positions[:, :2], cell_A[:2])
    pairs = cKDTree(positions, boxsize=box).query_pairs(cutoff_A, output_type="ndarray")
    mixed = pairs[is_cation[pairs[:, 0]] != is_cation[pairs[:, 1]]]
    return set(map(tuple, mixed.tolist()))


def _mean_top(frame: np.ndarray) -> float:
    height = frame[:, 3]
    return float(np.mean(np.sort(height)[-8:]))


def _slices(frames: list[tuple[int, np.ndarray]], cell_A: np.ndarray) -> list[dict[str, float]]:
    """Atoms of a 0.8 nm slice through the peak, of every relaxed snapshot."""
    rows = []
    for step, frame in frames:
        off = np.abs(frame[:, 2] - cell_A[1] / 4) < 4.0
        for kind, x, y, z in frame[off].tolist():
            rows.append({"step": step, "type": int(kind), "x_nm": x / 10, "y_nm": y / 10, "z_nm": z / 10})
    return rows
