"""Molecular dynamics with the potentials of a scene on its own glasses, in hard cases: invariant checks."""

import shutil
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from atomistic.constants import BOLTZMANN_EV_PER_K, KE_EV
from atomistic.hardness.glass import MELT_K, TIMESTEP_FS, write_forcefield
from atomistic.hardness.plateau import RULES
from atomistic.hardness.runs import PROTOCOL
from atomistic.lammps import Atoms, Workspace, load_averages, load_data, run_lammps, write_data
from atomistic.potentials import Potential


def free_motion(
    atoms: Atoms, potential: Potential, work: Path, timestep_fs: float, steps: int, energy_scale: float = 1.0
) -> tuple[np.ndarray, Atoms]:
    """Run at constant energy; rows (step, potential, total energy in eV), and the atoms at the end."""
    shutil.rmtree(work, ignore_errors=True)
    workspace = Workspace(work, {}, "nve.in")
    write_forcefield(workspace, potential, atoms.elements, energy_scale)
    write_data(workspace / "start.data", atoms, {ion: potential.species[ion].mass_u for ion in atoms.elements})
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


def heated(atoms: Atoms, potential: Potential, temperature_K: float) -> Atoms:
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
    glass: Atoms, potential: Potential, work: Path, kelvin: float, scale: float, step_fs: float
) -> tuple[bool, str]:
    record, _ = free_motion(
        heated(glass, potential, kelvin), potential, work / "nve", step_fs, round(4000 / step_fs), scale
    )
    drift = drift_meV_atom_ps(record, len(glass), step_fs)
    return abs(drift) < RULES.max_drift_meV_atom_ps, f"{drift:+.4f} meV per atom and ps"
