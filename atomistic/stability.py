"""Molecular dynamics in hard cases, on a glass of some hundred atoms: what must hold does hold."""

import shutil
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from atomistic.errors import InputError
from atomistic.glass import make_glass, write_forcefield
from atomistic.lammps import Atoms, Progress, Workspace, read_averages, read_data, run_lammps, write_data
from atomistic.potentials import Potential
from atomistic.settings import GlassSettings

COLUMNS = ("stage", "case", "description", "checks", "passed", "detail", "wall_s")
QUICK = GlassSettings(atoms=150, melt_ps=1, quench_rate_K_ps=1000, rest_ps=0.5, segment_steps=500)
MAX_DRIFT = 0.2  # meV per atom and ps, the gate of the closing runs
KE_EV = 1.0364269e-4  # u (Å/ps)^2 in eV


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
    record, end = read_averages(workspace / "energy.dat"), read_data(workspace / "end.data", atoms.elements)
    workspace.remove()
    return record, end


def heated(atoms: Atoms, potential: Potential, temperature_K: float) -> Atoms:
    """The same atoms with Maxwell velocities."""
    rng = np.random.default_rng(np.random.SeedSequence([17]))
    masses = np.array([potential.species[ion].mass_u for ion in atoms.elements])[atoms.types - 1]
    velocities = rng.normal(size=(len(atoms), 3)) * np.sqrt(8.617333e-5 * temperature_K / (KE_EV * masses))[:, None]
    momentum = np.sum(velocities * masses[:, None], axis=0) / np.sum(masses)
    return replace(atoms, velocities_A_ps=velocities - momentum)


def drift_meV_atom_ps(record: np.ndarray, atoms: int, timestep_fs: float) -> float:
    """Slope of the total energy."""
    time_ps = record[:, 0] * timestep_fs / 1000
    return float(1000 * np.polyfit(time_ps, record[:, 2], 1)[0] / atoms)


def stability_rows(potentials: list[Potential], work: Path, progress: Progress | None = None) -> list[dict]:
    """All checks; one row each, passed or not, with the number behind it."""
    glasses = {
        potential.name: make_glass("SiO2", potential, QUICK, 1, work / f"glass_{potential.name}")
        for potential in potentials
    }
    checks: list[tuple[str, str, str, Callable[[], tuple[bool, str]]]] = []
    for potential in potentials:
        glass = glasses[potential.name]
        for label, kelvin, scale, step in (
            ("room", 300, 1.0, 2.0),
            ("halved", 300, 0.5, 2.0),
            ("cold", 10, 1.0, 2.0),
            ("melt", 4000, 1.0, 2.0),
            ("long_step", 300, 1.0, 4.0),
        ):
            checks.append(
                (
                    f"{label}_{potential.name}",
                    f"{kelvin} K, energies x {scale}, {step} fs, 4 ps at constant energy",
                    f"drift below {MAX_DRIFT} meV per atom and ps",
                    lambda g=glass, p=potential, k=kelvin, s=scale, h=step: _drift(g, p, work, k, s, h),
                )
            )
        checks.append(
            (
                f"half_energy_identity_{potential.name}",
                "halved energies at T against full at 2T, time x sqrt 2",
                "same path to 1e-5 A after 100 steps",
                lambda g=glass, p=potential: half_energy_identity(g, p, work),
            )
        )
    first = potentials[0]
    checks.append(
        (
            "overlapping_start",
            "two atoms 0.2 A apart",
            "one-line error that names the cause",
            lambda: _overlap(glasses[first.name], first, work),
        )
    )
    rows = []
    for k, (case, description, what, check) in enumerate(checks):
        started = time.perf_counter()
        passed, detail = check()
        rows.append(
            {
                "stage": "hardness",
                "case": case,
                "description": description,
                "checks": what,
                "passed": passed,
                "detail": detail,
                "wall_s": time.perf_counter() - started,
            }
        )
        if progress is not None:
            progress((k + 1) / len(checks), case)
    shutil.rmtree(work, ignore_errors=True)
    return rows


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
    return abs(drift) < MAX_DRIFT, f"{drift:+.4f} meV per atom and ps"


def _overlap(glass: Atoms, potential: Potential, work: Path) -> tuple[bool, str]:
    positions = glass.positions_A.copy()
    positions[1] = positions[0] + [0.2, 0, 0]
    try:
        free_motion(replace(glass, positions_A=positions), potential, work / "nve", 1.0, 10)
    except InputError as error:
        message = str(error).split("; details")[0]
        return "\n" not in message and "inner cutoff" in message, message
    return False, "no error"
