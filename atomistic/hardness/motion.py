"""Atoms left to move at constant energy: heating, motion, and the drift of the energy."""

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.constants import atomic_mass, k

from atomistic.hardness.glass import write_forcefield
from atomistic.lammps import Atoms, LammpsFolder, load_averages, load_data, run_lammps, write_data
from atomistic.potentials import ForceField


def free_motion(
    atoms: Atoms,
    potential: ForceField,
    work: Path,
    timestep_fs: float,
    steps: int,
    energy_scale: float = 1.0,
) -> tuple[np.ndarray, Atoms]:
    """Run at constant energy; rows (step, potential, total energy in eV), atoms at the end."""
    shutil.rmtree(work, ignore_errors=True)
    workspace = LammpsFolder(work, {}, "nve.in")
    write_forcefield(workspace, potential, atoms.elements, energy_scale)
    write_data(workspace / "start.data", atoms, potential.masses_u)
    variables = {
        "data": "start.data",
        "pairs": "pairs",
        "timestep": timestep_fs / 1000,
        "steps": steps,
        "every": max(1, steps // 50),
    }
    run_lammps("nve.in", workspace, variables)
    record = load_averages(workspace / "energy.dat")
    end = load_data(workspace / "end.data", atoms.elements)
    workspace.remove()
    return record, end


def heated(atoms: Atoms, potential: ForceField, temperature_K: float, seed: int = 17) -> Atoms:
    """The same atoms with Maxwell velocities."""
    rng = np.random.default_rng(np.random.SeedSequence([seed]))
    masses = np.array([potential.masses_u[ion] for ion in atoms.elements])[atoms.types - 1]
    speeds = np.sqrt(k * temperature_K / (atomic_mass * masses)) / 100  # from m/s to Å/ps
    velocities = rng.normal(size=(len(atoms), 3)) * speeds[:, None]
    momentum = np.sum(velocities * masses[:, None], axis=0) / np.sum(masses)
    return replace(atoms, velocities_A_ps=velocities - momentum)


def drift_meV_atom_ps(record: np.ndarray, atoms: int, timestep_fs: float) -> float:
    """Slope of the total energy."""
    time_ps = record[:, 0] * timestep_fs / 1000
    return float(1000 * np.polyfit(time_ps, record[:, 2], 1)[0] / atoms)
