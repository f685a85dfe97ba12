"""Bodies cut and annealed, and pressed against a counterface: what LAMMPS runs, divided into segments."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from atomistic.constants import EV_PER_A3_IN_GPA, KE_EV
from atomistic.hardness.asperity import (
    STRAY_A,
    cut_asperity,
    facing,
    formula_of,
    remove_strays,
    with_vacuum,
)
from atomistic.hardness.glass import write_forcefield
from atomistic.hardness.readout import Geometry
from atomistic.hardness.runs import ClosingRun
from atomistic.lammps import Atoms, Progress, Workspace, load_data, run_lammps, write_data
from atomistic.potentials import CONTACT_A, Potential
from atomistic.settings import HardnessSettings

FORCE_TOLERANCE_EV_A = 0.02  # norm of all forces at which a quasi-static step is at rest


@dataclass(frozen=True)
class Plan:
    """Steps and lengths of a closing in LAMMPS units (Å, ps).

    Attributes
    ----------
    speed : of the counterface (Å/ps); 0 where the force is controlled or the run is quasi-static.
    segments : pieces of the closing, each with a restart file at its end.
    back : pieces of the unloading after them.
    dwell_steps : rest at each force; 0 where the force is not controlled.
    step : travel before each minimisation of a quasi-static run; 0 where time runs.
    """

    timestep: float
    speed: float
    sample_steps: int
    segment_steps: int
    segments: int
    back: int
    anneal_steps: int
    dwell_steps: int
    step: float = 0.0

    @property
    def total_steps(self) -> int:
        """MD steps; of a quasi-static run those of the anneal and the minimisations."""
        return (self.segments + self.back) * self.segment_steps + 2 * self.anneal_steps


def plan_closing(settings: HardnessSettings, run: ClosingRun) -> Plan:
    """Divide the run into samples (for averages) and segments (for restart files)."""
    closing, area = settings.closing, settings.area
    timestep = closing.timestep_fs / 1000 / np.sqrt(run.energy_scale)  # the same share of a vibration's period
    anneal = round(closing.anneal_ps / timestep)
    if closing.control == "force":
        sample = max(5, 5 * round(closing.dwell_ps / timestep / area.snapshots / 5))
        dwell = sample * area.snapshots
        force_steps = np.ceil(1000 * closing.max_stress_GPa / closing.force_step_MPa)
        segments = int(np.ceil(force_steps / closing.segment_force_steps))
        return Plan(timestep, 0.0, sample, dwell * closing.segment_force_steps, segments, 0, anneal, dwell)
    size = closing.sphere_radius_nm if closing.counterface == "sphere" else run.asperity.amplitude_nm
    travel = clearance_A(settings) + 10 * closing.depth_over_amplitude * size
    if closing.control == "steps":
        step = area.travel_A / area.snapshots
        segment = max(1, round(10 * closing.segment_nm / step))
        return Plan(timestep, 0.0, 1, segment, int(np.ceil(travel / (segment * step) - 1e-9)), 0, anneal, 0, step)
    speed = closing.speed_m_s / 100
    per_sample = area.travel_A / area.snapshots / (speed * timestep)
    sample = max(5, 5 * round(per_sample / 5))
    # rounded down: a segment as long as the approach ends before contact, where its bonds are the background
    segment = sample * max(1, int(10 * closing.segment_nm / (sample * speed * timestep) + 1e-9))
    per_segment = segment * speed * timestep
    segments, back = (int(np.ceil(way / per_segment - 1e-9)) for way in (travel, 10 * closing.unload_nm))
    return Plan(timestep, speed, sample, segment, segments, back, anneal, 0)


def clearance_A(settings: HardnessSettings) -> float:
    """Gap at the start: above the highest atom; two rough surfaces, which may adhere, start a little farther apart."""
    closing = settings.closing
    return 10 * closing.approach_nm + (STRAY_A if closing.counterface in ("oxide", "asperity") else 0.0)


def base_thickness_nm(settings: HardnessSettings, wavelength_nm: float) -> float:
    """Thickness of the base under an asperity, so that the rigid bottom is not felt by the largest contact."""
    largest_nm = np.sqrt(settings.plasticity.max_area_fraction) * wavelength_nm
    return max(settings.closing.base_nm, settings.closing.base_over_contact * float(largest_nm))


def prepare_body(
    run: ClosingRun,
    glass: Atoms,
    potential: Potential,
    settings: HardnessSettings,
    workspace: Workspace,
    place: tuple[int, ...],
    amplitude_nm: float,
    base_nm: float,
    progress: Progress | None = None,
) -> Atoms:
    """Cut a body, anneal its surface, remove strays."""
    closing, plan = settings.closing, plan_closing(settings, run)
    done = workspace.segments_done(2)
    if not done:
        tiles, shape = run.asperity.tiles, run.asperity.shape
        cut = cut_asperity(glass, tiles, 10 * amplitude_nm, 10 * base_nm, _lammps_seed(*place, 3), shape)
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


def press_bodies(
    run: ClosingRun,
    bodies: list[Atoms],
    potential: Potential,
    settings: HardnessSettings,
    plan: Plan,
    place: tuple[int, ...],
    workspace: Workspace,
    progress: Progress | None = None,
    complete: Callable[[Geometry, int], bool] | None = None,
    counter_potential: Potential | None = None,
) -> tuple[Geometry, Plan]:
    """Press a prepared body against the counterface (or the second body); what was measured stays in `workspace`.

    Parameters
    ----------
    complete : asked after every segment whether the run may end (None: it goes on as planned).
    counter_potential : of the second body, where it is another; the bodies then only repel each other.

    Returns
    -------
    geometry, and the plan with the segments that were run.
    """
    closing, lower = settings.closing, bodies[0]
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
    if not workspace.segments_done(1):
        masses = _masses(potential, lower.elements)
        if len(bodies) == 2 and closing.interface == "repulsive":
            upper = (counter_potential or potential, bodies[1].elements)
            write_forcefield(workspace, potential, lower.elements, run.energy_scale, repelled=upper)
            masses |= _masses(*upper)
        else:
            write_forcefield(workspace, potential, atoms.elements, run.energy_scale)
            masses |= _masses(potential, atoms.elements)
        write_data(workspace / "annealed.data", atoms, masses)

    def on_step(step: int) -> None:
        if progress is not None:
            progress((2 * plan.anneal_steps + step) / plan.total_steps, f"closing, {step * plan.timestep:.0f} ps")

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
        "start": float(np.max(lower.positions_A[:, 2]) + clearance_A(settings)),
        "sample": plan.sample_steps,
        "steps": plan.segment_steps,
        "speed": plan.speed,
        "step": plan.step,
        "force_tolerance": FORCE_TOLERANCE_EV_A * run.energy_scale,
    }

    def advance(last: int, closing_segments: int) -> None:
        done = workspace.segments_done(last)
        if done < last:
            pieces = {"closing": closing_segments, "segment": range(done + 1, last + 1), "previous": range(done, last)}
            run_lammps(script_of(settings), workspace, {**variables, **pieces}, on_step, closing.processes)

    reached = 0
    while reached < plan.segments and not (reached and complete is not None and complete(geometry, reached)):
        reached = plan.segments if complete is None else reached + 1
        advance(reached, plan.segments)
    advance(reached + plan.back, reached)
    return geometry, replace(plan, segments=reached)


def script_of(settings: HardnessSettings) -> str:
    return "quasistatic.in" if settings.closing.control == "steps" else "closing.in"
