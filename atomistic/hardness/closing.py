"""One closing run: cut, anneal, press against the counterface, relax without it; returns the measured curve."""

import shutil
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from atomistic.constants import EV_PER_A3_IN_GPA, KE_EV
from atomistic.errors import InputError
from atomistic.hardness.asperity import (
    STRAY_A,
    cut_asperity,
    facing,
    formula_of,
    remove_strays,
    top_height,
    with_vacuum,
)
from atomistic.hardness.glass import cations, write_forcefield
from atomistic.hardness.readout import Geometry, Rows, load_curve, load_relaxed, slice_rows, witness_rows
from atomistic.hardness.runs import ClosingRun
from atomistic.lammps import Atoms, Progress, Workspace, load_data, run_lammps, write_data
from atomistic.materials import Material
from atomistic.potentials import CONTACT_A, Potential
from atomistic.settings import AsperitySettings, HardnessSettings

MAX_STRAIN = 0.01  # of a counterface whose cell differs from the asperity's


@dataclass(frozen=True)
class Plan:
    """Steps and lengths of a closing in LAMMPS units (Å, ps).

    Attributes
    ----------
    speed : of the counterface (Å/ps); 0 where the force is controlled.
    segments : pieces of the closing, each with a restart file at its end.
    back : pieces of the unloading after them.
    dwell_steps : rest at each force; 0 where the speed is controlled.
    """

    timestep: float
    speed: float
    sample_steps: int
    segment_steps: int
    segments: int
    back: int
    anneal_steps: int
    dwell_steps: int

    @property
    def total_steps(self) -> int:
        return (self.segments + self.back) * self.segment_steps + 2 * self.anneal_steps


def plan_closing(settings: HardnessSettings, asperity: AsperitySettings) -> Plan:
    """Divide the run into samples (for averages) and segments (for restart files)."""
    closing, area = settings.closing, settings.area
    timestep = closing.timestep_fs / 1000
    anneal = round(closing.anneal_ps / timestep)
    if closing.control == "force":
        sample = max(5, 5 * round(closing.dwell_ps / timestep / area.snapshots / 5))
        dwell = sample * area.snapshots
        force_steps = np.ceil(1000 * closing.max_stress_GPa / closing.force_step_MPa)
        segments = int(np.ceil(force_steps / closing.segment_force_steps))
        return Plan(timestep, 0.0, sample, dwell * closing.segment_force_steps, segments, 0, anneal, dwell)
    speed = closing.speed_m_s / 100
    per_sample = area.travel_A / area.snapshots / (speed * timestep)
    sample = max(5, 5 * round(per_sample / 5))
    segment = sample * max(1, round(10 * closing.segment_nm / (sample * speed * timestep)))
    size = closing.sphere_radius_nm if closing.counterface == "sphere" else asperity.amplitude_nm
    travel = clearance_A(settings) + 10 * closing.depth_over_amplitude * size
    per_segment = segment * speed * timestep
    segments, back = (int(np.ceil(way / per_segment - 1e-9)) for way in (travel, 10 * closing.unload_nm))
    return Plan(timestep, speed, sample, segment, segments, back, anneal, 0)


def clearance_A(settings: HardnessSettings) -> float:
    """Gap at the start, beyond the distance at which atoms touch; two rough surfaces need a little more."""
    closing = settings.closing
    return 10 * closing.approach_nm + (STRAY_A if closing.counterface in ("oxide", "asperity") else 0.0)


@dataclass(frozen=True)
class Closing:
    """Result of a closing run.

    curve : one row per average (columns as in docs/hardness.md).
    witness : one row per relaxed snapshot: bond exchanges and lasting lowering against the first.
    snapshots : slices through the contact of the relaxed snapshots, for pictures.
    unloading : rows like those of `curve` while the counterface goes back.
    """

    curve: Rows
    witness: Rows
    snapshots: Rows
    unloading: Rows
    summary: dict[str, float]


def run_closing(
    run: ClosingRun,
    material: Material,
    glass: Atoms,
    potential: Potential,
    settings: HardnessSettings,
    work: Path,
    progress: Progress | None = None,
    counter_glass: Atoms | None = None,
) -> Closing:
    """Carry out a run, or go on with it if `work` holds its restart files; `work` is deleted at the end.

    Parameters
    ----------
    material, glass : oxide of the asperity, and a cell of its glass.
    counter_glass : glass of a counterface of oxide; None: that of the asperity.
    """
    closing, plan = settings.closing, plan_closing(settings, run.asperity)
    identity = {
        "potential": potential.model_dump(),
        "run": [run.asperity.model_dump(), run.seed, run.energy_scale],
        "settings": settings.model_dump(include={"closing": True, "area": True, "material": True}),
        "glass": [[g.cell_A.tolist(), g.positions_A.sum(axis=0).tolist()] for g in (glass, counter_glass or glass)],
    }
    place = (run.seed, run.asperity.tiles, round(1000 * run.asperity.amplitude_nm))
    bodies = [
        _prepare(run, glass, potential, settings, Workspace(work / "anneal", identity, "anneal.in"), plan, place,
                 run.asperity.amplitude_nm, closing.base_nm, progress)
    ]  # fmt: skip
    if closing.counterface in ("oxide", "asperity"):
        amplitude = run.asperity.amplitude_nm if closing.counterface == "asperity" else 0.0
        counter = _commensurate(counter_glass or glass, glass)
        bodies.append(
            _prepare(run, counter, potential, settings, Workspace(work / "anneal_counter", identity, "anneal.in"), plan,
                     (*place, 6), amplitude, closing.counter_base_nm, progress)
        )  # fmt: skip
    workspace = Workspace(work / "closing", identity, "closing.in")
    lower = bodies[0]
    if len(bodies) == 2:
        atoms, ceiling = facing(lower, bodies[1], clearance_A(settings) + CONTACT_A)
    else:
        atoms, ceiling = lower, float(lower.cell_A[2]) + 1
    wavelength = float(lower.cell_A[0])
    on_flat = closing.counterface == "sphere"
    geometry = Geometry(
        wavelength_A=wavelength,
        axis_A=wavelength / (2 if on_flat else 4),
        lower=len(lower),
        atoms=len(atoms),
        bodies=len(bodies),
        top_radius_A=5 * closing.sphere_radius_nm if on_flat else np.inf,
    )
    done = workspace.segments_done(plan.segments + plan.back)
    if not done:
        apart = len(lower.elements) + 1 if closing.interface == "repulsive" and len(bodies) == 2 else None
        write_forcefield(workspace, potential, atoms.elements, run.energy_scale, apart)
        write_data(workspace / "annealed.data", atoms, _masses(potential, atoms.elements))

    def on_step(step: int) -> None:
        if progress is not None:
            progress((2 * plan.anneal_steps + step) / plan.total_steps, f"closing, {step * plan.timestep:.0f} ps")

    if done < plan.segments + plan.back:
        start = top_height(lower.positions_A[:, 2]) + clearance_A(settings)
        variables = {
            "data": "annealed.data",
            "pairs": "pairs",
            "seed": _lammps_seed(*place, 5),
            "timestep": plan.timestep,
            "lower": len(lower),
            "frozen": 10 * closing.frozen_nm,
            "bath": 10 * (closing.frozen_nm + closing.thermostat_nm),
            "grip": float(ceiling) - 10 * closing.frozen_nm * (len(bodies) == 2),
            "grip_bath": float(ceiling) - 10 * (closing.frozen_nm + closing.thermostat_nm) * (len(bodies) == 2),
            "temperature": closing.temperature_K,
            "stiffness": closing.wall_stiffness_eV_A3 * run.energy_scale,
            "counterface": "body" if len(bodies) == 2 else closing.counterface,
            "control": closing.control,
            "axis": geometry.axis_A,
            "radius": 10 * closing.sphere_radius_nm,
            "force_step": closing.force_step_MPa / 1000 / EV_PER_A3_IN_GPA * wavelength**2,
            "dwell": max(1, plan.dwell_steps),
            "damping": KE_EV * _mass_u(potential, lower) / closing.damping_ps,
            "start": float(start),
            "sample": plan.sample_steps,
            "steps": plan.segment_steps,
            "speed": plan.speed,
            "closing": plan.segments,
            "segment": range(done + 1, plan.segments + plan.back + 1),
            "previous": range(done, plan.segments + plan.back),
        }
        run_lammps("closing.in", workspace, variables, on_step, closing.processes)
    relaxed = range(1, plan.segments + plan.back + 1)
    if missing := [n for n in relaxed if not (workspace / f"relaxed.{n}").exists()]:
        run_lammps("relax.in", workspace, {"pairs": "pairs", "segment": missing})
    result = _read(workspace, plan, settings, material, potential, glass.elements, geometry)
    shutil.rmtree(work)
    return result


def _read(
    workspace: Workspace,
    plan: Plan,
    settings: HardnessSettings,
    material: Material,
    potential: Potential,
    elements: tuple[str, ...],
    geometry: Geometry,
) -> Closing:
    closing_segments = range(1, plan.segments + 1)
    back_segments = range(plan.segments + 1, plan.segments + plan.back + 1)
    curve = load_curve(workspace, closing_segments, plan.segment_steps, settings.area, geometry)
    unloading = load_curve(workspace, back_segments, plan.segment_steps, settings.area, geometry) if plan.back else []

    def displacement_nm(step: int) -> float:
        if plan.dwell_steps:
            return float(np.interp(step, [row["step"] for row in curve], [row["displacement_nm"] for row in curve]))
        return step * plan.timestep * plan.speed / 10

    kinds = [elements.index(ion) + 1 for ion in cations(material, potential)]
    cutoff = material.part("oxide_glass").cutoff_A
    held = 10 * settings.closing.frozen_nm
    frames = [load_relaxed(workspace, n) for n in closing_segments]
    witness = witness_rows(frames, displacement_nm, kinds, cutoff, held, geometry)
    summary: dict[str, float] = {
        "atoms": geometry.atoms,
        "steps": plan.total_steps,
        "restart_steps": plan.segment_steps,
        "wavelength_nm": geometry.wavelength_A / 10,
    }
    if plan.back:
        last = load_relaxed(workspace, plan.segments + plan.back)
        unloaded = witness_rows([frames[0], last], displacement_nm, kinds, cutoff, held, geometry)[-1]
        summary |= {
            "snapshot_exchanged_bonds": witness[-1]["exchanged_bonds"],
            "unloaded_exchanged_bonds": unloaded["exchanged_bonds"],
            "snapshot_lowering_nm": witness[-1]["lowering_nm"],
            "unloaded_lowering_nm": unloaded["lowering_nm"],
            "unloaded_force_nN": unloading[-1]["force_nN"],
        }
    return Closing(curve, witness, slice_rows(frames, geometry), unloading, summary)


def _commensurate(counter: Atoms, glass: Atoms) -> Atoms:
    """The counterface's glass in a cell as wide as the asperity's.

    Raises
    ------
    InputError : that would strain it by more than `MAX_STRAIN`.
    """
    factor = glass.cell_A[0] / counter.cell_A[0]
    if abs(factor - 1) > MAX_STRAIN:
        raise InputError(
            f"the counterface's glass cell of {counter.cell_A[0]:.2f} A would be strained by {factor - 1:+.1%} beside "
            f"one of {glass.cell_A[0]:.2f} A (gate {MAX_STRAIN:.0%}): quench it with the edge of the asperity's cell"
        )
    return replace(counter, positions_A=factor * counter.positions_A, cell_A=factor * counter.cell_A)


def _prepare(
    run: ClosingRun,
    glass: Atoms,
    potential: Potential,
    settings: HardnessSettings,
    workspace: Workspace,
    plan: Plan,
    place: tuple[int, ...],
    amplitude_nm: float,
    base_nm: float,
    progress: Progress | None,
) -> Atoms:
    """Cut a body, anneal its surface, remove strays."""
    closing = settings.closing
    done = workspace.segments_done(2)
    if not done:
        cut = cut_asperity(glass, run.asperity.tiles, 10 * amplitude_nm, 10 * base_nm, _lammps_seed(*place, 3))
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
        run_lammps("anneal.in", workspace, variables, on_step, closing.processes)
    annealed = load_data(workspace / "annealed.data", glass.elements)
    kept = remove_strays(annealed, formula_of(glass))
    return with_vacuum(kept, float(annealed.cell_A[2]))


def _mass_u(potential: Potential, atoms: Atoms) -> float:
    return sum(atoms.count(element) * potential.species[element].mass_u for element in atoms.elements)


def _masses(potential: Potential, elements: tuple[str, ...]) -> dict[str, float]:
    return {ion: potential.species[ion].mass_u for ion in elements}


def _lammps_seed(*entropy: int) -> int:
    """A seed that LAMMPS accepts; neighbouring ones (it adds the segment's number) stay distinct."""
    return 1000 * (1 + int(np.random.SeedSequence(entropy).generate_state(1)[0] % 800_000))
