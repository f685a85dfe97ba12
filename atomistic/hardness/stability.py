"""Molecular dynamics with the potentials of a scene on its own glasses, in hard cases: invariant checks."""

import shutil
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from atomistic.constants import BOLTZMANN_EV_PER_K, EV_PER_A3_IN_GPA, KE_EV
from atomistic.hardness.glass import MELT_K, TIMESTEP_FS, write_forcefield
from atomistic.hardness.plateau import RULES
from atomistic.hardness.runs import PROTOCOL
from atomistic.hardness.stack import Stack, lifted
from atomistic.lammps import Atoms, Workspace, load_averages, load_data, run_lammps, write_data
from atomistic.potentials import ForceField, Potential, masses_u


def free_motion(
    atoms: Atoms, potential: ForceField, work: Path, timestep_fs: float, steps: int, energy_scale: float = 1.0
) -> tuple[np.ndarray, Atoms]:
    """Run at constant energy; rows (step, potential, total energy in eV), and the atoms at the end."""
    shutil.rmtree(work, ignore_errors=True)
    workspace = Workspace(work, {}, "nve.in")
    write_forcefield(workspace, potential, atoms.elements, energy_scale)
    write_data(workspace / "start.data", atoms, masses_u(potential, atoms.elements))
    every = max(1, steps // 50)
    variables = {
        "data": "start.data",
        "pairs": "pairs",
        "timestep": timestep_fs / 1000,
        "steps": steps,
        "every": every,
    }
    run_lammps("nve.in", workspace, variables)
    record, end = load_averages(workspace / "energy.dat"), load_data(workspace / "end.data", atoms.elements)
    workspace.remove()
    return record, end


def heated(atoms: Atoms, potential: ForceField, temperature_K: float) -> Atoms:
    """The same atoms with Maxwell velocities."""
    rng = np.random.default_rng(np.random.SeedSequence([17]))
    masses = np.array([potential.species[ion].mass_u for ion in atoms.elements])[atoms.types - 1]
    speeds = np.sqrt(BOLTZMANN_EV_PER_K * temperature_K / (KE_EV * masses))
    velocities = rng.normal(size=(len(atoms), 3)) * speeds[:, None]
    momentum = np.sum(velocities * masses[:, None], axis=0) / np.sum(masses)
    return replace(atoms, velocities_A_ps=velocities - momentum)


def drift_meV_atom_ps(record: np.ndarray, atoms: int, timestep_fs: float) -> float:
    """Slope of the total energy."""
    time_ps = record[:, 0] * timestep_fs / 1000
    return float(1000 * np.polyfit(time_ps, record[:, 2], 1)[0] / atoms)


Check = tuple[str, str, str, Callable[[], tuple[bool, str]]]  # case, description, what is checked, the check


def stability_checks(
    bodies: Sequence[tuple[Potential, Atoms]], energy_scales: Sequence[float], work: Path
) -> list[Check]:
    """Checks of the potentials of a scene on the glasses that it made with them.

    Parameters
    ----------
    bodies : potential and glass of the asperity, and of a counterface where that is of another oxide or potential.
    work : folder for LAMMPS, which the caller removes in the end.
    """
    return [check for potential, glass in bodies for check in _of_body(potential, glass, energy_scales, work)]


def _of_body(potential: Potential, glass: Atoms, energy_scales: Sequence[float], work: Path) -> list[Check]:
    name = f"{potential.name}_{''.join(glass.elements)}"
    closing_fs = [(PROTOCOL.timestep_fs / np.sqrt(scale), scale) for scale in energy_scales]
    checks: list[Check] = [
        (
            f"{label}_{name}",
            f"{kelvin:g} K, energies x {scale:g}, {step:.3g} fs, 4 ps at constant energy",
            f"drift below {RULES.max_drift_meV_atom_ps} meV per atom and ps",
            lambda k=kelvin, s=scale, h=float(step): _drift(glass, potential, work, k, s, h),
        )
        for label, kelvin, step, scale in (
            *((f"room_x{scale:g}", PROTOCOL.temperature_K, step, scale) for step, scale in closing_fs),
            ("cold", 10.0, PROTOCOL.timestep_fs, 1.0),
            ("melt", MELT_K, TIMESTEP_FS, 1.0),
        )
    ]
    checks.append(
        (
            f"half_energy_identity_{name}",
            "halved energies at T against full at 2T, time x sqrt 2",
            "same path to 1e-5 A after 100 steps",
            lambda: half_energy_identity(glass, potential, work),
        )
    )
    return checks


LIFT_A = 60.0  # beyond the cut-off of every pair, also of ions that went into the base
SOFTER, SOLID_K = 1e-3, 1.0  # a body with such energies is a gas where it is warmer
SEPARATION_J_M2 = (0.1, 10.0)  # weaker films fall off, stronger ones are part of the base


def film_checks(stack: Stack, body: Atoms, energy_scales: Sequence[float], work: Path) -> list[Check]:
    """Checks of a film on its base: the scene's thinnest one, welded.

    Parameters
    ----------
    work : of `stability_checks`.
    """
    base = stack.base
    factor = base.below_films.timestep_factor
    closing_fs = factor * PROTOCOL.timestep_fs
    cases = [
        *(
            (f"room_x{scale:g}", stack, PROTOCOL.temperature_K, closing_fs / np.sqrt(scale), scale)
            for scale in energy_scales
        ),
        ("cold", stack, 10.0, closing_fs, 1.0),
        ("hot_as_in_anneal", stack, PROTOCOL.anneal_temperature_K, closing_fs, 1.0),
        ("molten_base", stack, base.molten_K, factor * TIMESTEP_FS, 1.0),
        ("base_softer_by_1000", replace(stack, base=base.softened(SOFTER)), SOLID_K, closing_fs, 1.0),
        ("sliding_interface", replace(stack, bond_factor=SOFTER), PROTOCOL.temperature_K, closing_fs, 1.0),
        ("bonds_fourfold", replace(stack, bond_factor=4.0), PROTOCOL.temperature_K, closing_fs, 1.0),
    ]
    checks: list[Check] = [
        (
            f"film_{label}",
            f"film on {base.material.name}, {kelvin:g} K, energies x {scale:g}, {step:.3g} fs, 4 ps",
            f"drift below {RULES.max_drift_meV_atom_ps} meV per atom and ps",
            lambda f=force, k=kelvin, s=scale, h=float(step): _drift(body, f, work, k, s, h),
        )
        for label, force, kelvin, step, scale in cases
    ]
    low, high = SEPARATION_J_M2
    checks += [
        (
            "film_off_its_base",
            f"film lifted by {LIFT_A:g} A and by 2 A more",
            "energies equal to 1e-6 eV: nothing holds it",
            lambda: _off_its_base(stack, body, work),
        ),
        (
            "film_work_of_separation",
            f"film lifted off as it is, by {LIFT_A:g} A",
            f"{low:g} to {high:g} J/m2",
            lambda: _separation(stack, body, work),
        ),
    ]
    return checks


def _off_its_base(stack: Stack, body: Atoms, work: Path) -> tuple[bool, str]:
    first, second = (
        _energy(stack, lifted(body, height, len(stack.base.elements)), work) for height in (LIFT_A, LIFT_A + 2)
    )
    return abs(first - second) < 1e-6, f"differ by {abs(first - second):.1e} eV"


def _separation(stack: Stack, body: Atoms, work: Path) -> tuple[bool, str]:
    bound, free = (_energy(stack, lifted(body, height, len(stack.base.elements)), work) for height in (0.0, LIFT_A))
    separation = (free - bound) / float(np.prod(body.cell_A[:2])) * EV_PER_A3_IN_GPA / 10
    return SEPARATION_J_M2[0] < separation < SEPARATION_J_M2[1], f"{separation:.2f} J/m2"


def _energy(stack: Stack, body: Atoms, work: Path) -> float:
    """Of atoms at rest, eV."""
    at_rest = replace(body, velocities_A_ps=None)
    return float(free_motion(at_rest, stack, work / "lifted", 0.01, 1)[0][0, 1])


def half_energy_identity(glass: Atoms, potential: Potential, work: Path) -> tuple[bool, str]:
    """E/2 at T moves like E at 2T with time x sqrt 2: checks table, masses, units and time step at once."""
    hot = heated(glass, potential, 600)
    assert hot.velocities_A_ps is not None
    slow = replace(hot, velocities_A_ps=hot.velocities_A_ps / np.sqrt(2))
    _, full = free_motion(hot, potential, work / "nve", 1.0, 100)
    _, halved = free_motion(slow, potential, work / "nve", float(np.sqrt(2)), 100, 0.5)
    apart = full.positions_A - halved.positions_A
    apart -= full.cell_A * np.round(apart / full.cell_A)
    largest = float(np.abs(apart).max())
    return largest < 1e-5, f"largest distance {largest:.1e} A"


def _drift(
    glass: Atoms, potential: ForceField, work: Path, kelvin: float, scale: float, step_fs: float
) -> tuple[bool, str]:
    record, _ = free_motion(
        heated(glass, potential, kelvin), potential, work / "nve", step_fs, round(4000 / step_fs), scale
    )
    drift = drift_meV_atom_ps(record, len(glass), step_fs)
    return abs(drift) < RULES.max_drift_meV_atom_ps, f"{drift:+.4f} meV per atom and ps"
