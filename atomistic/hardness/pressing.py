"""Bodies cut and annealed, and pressed against a counterface: what LAMMPS runs, divided into segments."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from atomistic.constants import EV_PER_A3_IN_GPA, KE_EV
from atomistic.hardness.asperity import (
    STRAY_A,
    facing,
    remove_strays,
    with_vacuum,
)
from atomistic.hardness.glass import mass_u, write_forcefield
from atomistic.hardness.plateau import RULES
from atomistic.hardness.readout import Geometry
from atomistic.hardness.runs import PROTOCOL, ClosingRun, Protocol
from atomistic.lammps import Atoms, Progress, Workspace, load_data, run_lammps, write_data
from atomistic.potentials import CONTACT_A, ForceField, Potential, masses_u
from atomistic.settings import ClosingSettings

SINKS_A = 5.0  # a piston of atoms sinks a little at first; one that left its box would stop the run


@dataclass(frozen=True)
class Plan:
    """Steps and lengths of a closing in LAMMPS units (Å, ps).

    Attributes
    ----------
    speed : of the counterface (Å/ps); 0 where the force is controlled.
    segments : pieces of the closing, each with a restart file at its end.
    dwell_steps : rest at each force; 0 where the force is not controlled.
    """

    timestep: float
    speed: float
    sample_steps: int
    segment_steps: int
    segments: int
    anneal_steps: int
    dwell_steps: int

    @property
    def total_steps(self) -> int:
        """MD steps."""
        return self.segments * self.segment_steps + 2 * self.anneal_steps


def plan_closing(closing: ClosingSettings, run: ClosingRun, protocol: Protocol = PROTOCOL) -> Plan:
    """Divide the run into samples (for averages) and segments (for restart files)."""
    timestep = protocol.timestep_fs / 1000 / np.sqrt(run.energy_scale)  # the same share of a vibration's period
    anneal = round(closing.anneal_ps / timestep)
    if closing.control == "force":
        sample = max(5, 5 * round(closing.dwell_ps / timestep / protocol.samples / 5))
        dwell = sample * protocol.samples
        force_steps = np.ceil(1000 * protocol.max_stress_GPa / protocol.force_step_MPa)
        segments = int(np.ceil(force_steps / protocol.segment_force_steps))
        return Plan(timestep, 0.0, sample, dwell * protocol.segment_force_steps, segments, anneal, dwell)
    travel = clearance_A(closing, protocol) + 10 * closing.depth_over_amplitude * run.asperity.amplitude_nm
    speed = closing.speed_m_s / 100
    per_sample = protocol.averaged_travel_A / protocol.samples / (speed * timestep)
    sample = max(5, 5 * round(per_sample / 5))
    # rounded down: a segment as long as the approach ends before contact, where its bonds are the background
    segment = sample * max(1, int(10 * protocol.segment_nm / (sample * speed * timestep) + 1e-9))
    segments = int(np.ceil(travel / (segment * speed * timestep) - 1e-9))
    return Plan(timestep, speed, sample, segment, segments, anneal, 0)


def clearance_A(closing: ClosingSettings, protocol: Protocol = PROTOCOL) -> float:
    """Gap at the start: above the highest atom; two rough surfaces, which may adhere, start a little farther apart."""
    return 10 * protocol.approach_nm + (STRAY_A if closing.counterface != "flat" else 0.0)


def base_thickness_nm(closing: ClosingSettings, wavelength_nm: float, protocol: Protocol = PROTOCOL) -> float:
    """Thickness of the base under an asperity, so that the rigid bottom is not felt by the largest contact."""
    largest_nm = np.sqrt(RULES.max_area_fraction) * wavelength_nm
    return max(closing.base_nm, protocol.base_over_contact * float(largest_nm))


def prepare_body(
    run: ClosingRun,
    cut: Atoms,
    formula: np.ndarray,
    potential: ForceField,
    closing: ClosingSettings,
    protocol: Protocol,
    workspace: Workspace,
    place: tuple[int, ...],
    progress: Progress | None = None,
) -> Atoms:
    """Anneal the surface of a body that was cut, which welds a film on it; remove strays.

    Parameters
    ----------
    formula : of `neutralise`.
    """
    plan = plan_closing(closing, run, protocol)
    done = workspace.segments_done(2)
    write_forcefield(workspace, potential, cut.elements, run.energy_scale)
    if not done:
        write_data(workspace / "cut.data", cut, masses_u(potential, cut.elements))
    hot = max(protocol.temperature_K, protocol.anneal_temperature_K * run.energy_scale)

    def on_step(step: int) -> None:
        if progress is not None:
            progress(step / plan.total_steps, "annealing the surface")

    if done < 2:
        variables = {
            "data": "cut.data",
            "pairs": "pairs",
            "seed": lammps_seed(*place, 4),
            "timestep": plan.timestep,
            "frozen": 10 * protocol.frozen_nm,
            "segment": range(done + 1, 3),
            "previous": range(done, 2),
            "from": [hot, hot][done:],
            "to": [hot, protocol.temperature_K][done:],
            "steps": [plan.anneal_steps] * (2 - done),
        }
        run_lammps("anneal.in", workspace, variables, on_step, closing.processes)
    annealed = load_data(workspace / "annealed.data", cut.elements)
    kept = remove_strays(annealed, formula)
    return with_vacuum(kept, float(annealed.cell_A[2]))


def lammps_seed(*entropy: int) -> int:
    """A seed that LAMMPS accepts; neighbouring ones (it adds the segment's number) stay distinct."""
    return 1000 * (1 + int(np.random.SeedSequence(entropy).generate_state(1)[0] % 800_000))


def press_bodies(
    run: ClosingRun,
    bodies: list[Atoms],
    potential: ForceField,
    closing: ClosingSettings,
    protocol: Protocol,
    plan: Plan,
    place: tuple[int, ...],
    workspace: Workspace,
    complete: Callable[[Geometry, int], bool],
    progress: Progress | None = None,
    counter_potential: Potential | None = None,
) -> tuple[Geometry, Plan]:
    """Press a prepared body against the counterface (or the second body); what was measured stays in `workspace`.

    Parameters
    ----------
    complete : asked after every segment whether the run may end before its plan does.
    counter_potential : of a second body that only repels the first; None: both adhere by one potential.

    Returns
    -------
    geometry, and the plan with the segments that were run.
    """
    lower = bodies[0]
    if len(bodies) == 2:
        atoms, ceiling = facing(lower, bodies[1], clearance_A(closing, protocol) + CONTACT_A)
    else:
        atoms, ceiling = lower, float(lower.cell_A[2]) + 1
    wavelength = float(lower.cell_A[0])
    geometry = Geometry(wavelength, len(lower), len(atoms), len(bodies))
    masses = masses_u(potential, lower.elements)
    if counter_potential is not None:
        upper = (counter_potential, bodies[1].elements)
        write_forcefield(workspace, potential, lower.elements, run.energy_scale, repelled=upper)
        masses |= masses_u(*upper)
    else:
        write_forcefield(workspace, potential, atoms.elements, run.energy_scale)
        masses |= masses_u(potential, atoms.elements)
    if not workspace.segments_done(1):
        write_data(workspace / "annealed.data", atoms, masses, SINKS_A if closing.control == "force" else 0.0)

    def on_step(step: int) -> None:
        if progress is not None:
            progress((2 * plan.anneal_steps + step) / plan.total_steps, f"closing, {step * plan.timestep:.0f} ps")

    variables = {
        "data": "annealed.data",
        "pairs": "pairs",
        "seed": lammps_seed(*place, 5),
        "timestep": plan.timestep,
        "lower": len(lower),
        "frozen": 10 * protocol.frozen_nm,
        "bath": 10 * (protocol.frozen_nm + protocol.thermostat_nm),
        "grip": float(ceiling) - 10 * protocol.frozen_nm * (len(bodies) == 2),
        "grip_bath": float(ceiling) - 10 * (protocol.frozen_nm + protocol.thermostat_nm) * (len(bodies) == 2),
        "temperature": protocol.temperature_K,
        "stiffness": protocol.wall_stiffness_eV_A3 * run.energy_scale,
        "counterface": "body" if len(bodies) == 2 else closing.counterface,
        "control": closing.control,
        "force_step": protocol.force_step_MPa / 1000 / EV_PER_A3_IN_GPA * wavelength**2,
        "dwell": max(1, plan.dwell_steps),
        "damping": KE_EV * mass_u(potential, lower) / protocol.damping_ps,
        "start": float(np.max(lower.positions_A[:, 2]) + clearance_A(closing, protocol)),
        "sample": plan.sample_steps,
        "steps": plan.segment_steps,
        "speed": plan.speed,
    }
    reached = 0
    while reached < plan.segments and not (reached and complete(geometry, reached)):
        reached += 1
        if workspace.segments_done(reached) < reached:
            of_segment = {"segment": reached, "previous": reached - 1}
            run_lammps("closing.in", workspace, {**variables, **of_segment}, on_step, closing.processes)
    return geometry, replace(plan, segments=reached)
