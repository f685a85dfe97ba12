"""Bodies cut and annealed, and pressed by a rigid flat: what LAMMPS runs, divided into segments."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from atomistic.hardness.asperity import remove_strays
from atomistic.hardness.glass import write_forcefield
from atomistic.hardness.plateau import RULES
from atomistic.hardness.readout import PressedCell
from atomistic.hardness.runs import PROTOCOL, ClosingRun, Protocol
from atomistic.lammps import Atoms, LammpsFolder, Progress, load_data, run_lammps, write_data
from atomistic.potentials import ForceField
from atomistic.settings import ClosingSettings


@dataclass(frozen=True)
class Plan:
    """Steps and lengths of a closing in LAMMPS units (Å, ps).

    Attributes
    ----------
    speed : of the flat (Å/ps).
    segments : pieces of the closing, each with a restart file at its end.
    """

    timestep: float
    speed: float
    sample_steps: int
    segment_steps: int
    segments: int
    anneal_steps: int

    @property
    def total_steps(self) -> int:
        """MD steps."""
        return self.segments * self.segment_steps + 2 * self.anneal_steps


def plan_closing(closing: ClosingSettings, run: ClosingRun, protocol: Protocol = PROTOCOL) -> Plan:
    """Divide the run into samples (for averages) and segments (for restart files)."""
    # the same share of a vibration's period
    timestep = protocol.timestep_fs / 1000 / np.sqrt(run.energy_scale)
    anneal = round(closing.anneal_ps / timestep)
    travel = (
        10 * protocol.approach_nm + 10 * protocol.depth_over_amplitude * run.asperity.amplitude_nm
    )
    speed = closing.speed_m_s / 100
    per_sample = protocol.averaged_travel_A / protocol.samples / (speed * timestep)
    sample = max(5, 5 * round(per_sample / 5))
    # rounded down: a segment as long as the approach ends before contact, where its bonds are the
    # background
    segment = sample * max(1, int(10 * protocol.segment_nm / (sample * speed * timestep) + 1e-9))
    segments = int(np.ceil(travel / (segment * speed * timestep) - 1e-9))
    return Plan(timestep, speed, sample, segment, segments, anneal)


def base_thickness_nm(
    closing: ClosingSettings, wavelength_nm: float, protocol: Protocol = PROTOCOL
) -> float:
    """Thickness of the base, so that the largest contact does not feel the rigid bottom."""
    largest_nm = np.sqrt(RULES.max_area_fraction) * wavelength_nm
    return max(closing.base_nm, protocol.base_over_contact * float(largest_nm))


def prepare_body(
    run: ClosingRun,
    cut: Atoms,
    formula: np.ndarray,
    potential: ForceField,
    closing: ClosingSettings,
    protocol: Protocol,
    workspace: LammpsFolder,
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
        write_data(workspace / "cut.data", cut, potential.masses_u)
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
    return remove_strays(load_data(workspace / "annealed.data", cut.elements), formula)


def lammps_seed(*entropy: int) -> int:
    """A seed that LAMMPS accepts; neighbouring ones (it adds the segment's number) differ."""
    return 1000 * (1 + int(np.random.SeedSequence(entropy).generate_state(1)[0] % 800_000))


def press_body(
    run: ClosingRun,
    body: Atoms,
    potential: ForceField,
    closing: ClosingSettings,
    protocol: Protocol,
    plan: Plan,
    place: tuple[int, ...],
    workspace: LammpsFolder,
    complete: Callable[[PressedCell, int], bool],
    progress: Progress | None = None,
) -> tuple[PressedCell, Plan]:
    """Press a prepared body by a flat; what was measured stays in `workspace`.

    Parameters
    ----------
    complete : asked after every segment whether the run may end before its plan does.

    Returns
    -------
    the cell, and the plan with the segments that were run.
    """
    cell = PressedCell(float(body.cell_A[0]), len(body))
    write_forcefield(workspace, potential, body.elements, run.energy_scale)
    if not workspace.segments_done(1):
        write_data(workspace / "annealed.data", body, potential.masses_u)

    def on_step(step: int) -> None:
        if progress is not None:
            progress(
                (2 * plan.anneal_steps + step) / plan.total_steps,
                f"closing, {step * plan.timestep:.0f} ps",
            )

    variables = {
        "data": "annealed.data",
        "pairs": "pairs",
        "seed": lammps_seed(*place, 5),
        "timestep": plan.timestep,
        "frozen": 10 * protocol.frozen_nm,
        "bath": 10 * (protocol.frozen_nm + protocol.thermostat_nm),
        "temperature": protocol.temperature_K,
        "stiffness": protocol.wall_stiffness_eV_A3 * run.energy_scale,
        "start": float(np.max(body.positions_A[:, 2]) + 10 * protocol.approach_nm),
        "sample": plan.sample_steps,
        "steps": plan.segment_steps,
        "speed": plan.speed,
    }
    reached = 0
    while reached < plan.segments and not (reached and complete(cell, reached)):
        reached += 1
        if workspace.segments_done(reached) < reached:
            of_segment = {"segment": reached, "previous": reached - 1}
            run_lammps(
                "closing.in", workspace, {**variables, **of_segment}, on_step, closing.processes
            )
    return cell, replace(plan, segments=reached)
