"""Accuracy and stability of the hardness stage: choices of the smallest run varied, and hard cases of the dynamics."""

import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from atomistic.constants import BOLTZMANN_EV_PER_K, KE_EV
from atomistic.hardness.glass import MELT_K, TIMESTEP_FS, write_forcefield
from atomistic.hardness.plateau import RULES, Rows, find_hardness
from atomistic.hardness.runs import PROTOCOL, ClosingRun, Protocol
from atomistic.lammps import Atoms, Workspace, load_averages, load_data, run_lammps, write_data
from atomistic.potentials import ForceField, Potential
from atomistic.settings import ClosingSettings

VARIATIONS = {  # choice and factor on it
    "default": ("speed_m_s", 1.0),
    "speed_double": ("speed_m_s", 2.0),
    "speed_fourfold": ("speed_m_s", 4.0),
    "timestep_half": ("timestep_fs", 0.5),
    "wall_stiffness_fourfold": ("wall_stiffness_eV_A3", 4.0),
    "temperature_tenth": ("temperature_K", 0.1),
    "base_larger": ("base_over_contact", 1.5),
    "bonds_weaker": ("bond_factor", 0.5),
    "bonds_stronger": ("bond_factor", 1.5),
}
Check = tuple[str, str, str, Callable[[], tuple[bool, str]]]  # case, description, what is checked, the check


def variations(run: ClosingRun) -> list[str]:
    """Those that mean something for a run: bonds of film and metal are of films only."""
    return [name for name, (key, _) in VARIATIONS.items() if key != "bond_factor" or run.asperity.film_nm]


def varied(name: str, closing: ClosingSettings) -> tuple[ClosingSettings, Protocol]:
    """Settings and protocol of a closing with one choice changed."""
    key, factor = VARIATIONS[name]
    if key == "speed_m_s":
        return closing.model_copy(update={key: factor * closing.speed_m_s}), PROTOCOL
    return closing, PROTOCOL.model_copy(update={key: factor * getattr(PROTOCOL, key)})


def compare(
    curves: Mapping[str, Rows], witnesses: Mapping[str, Rows], runs: Mapping[str, Mapping], closing: ClosingSettings
) -> Iterator[dict]:
    """Accuracy points of the variations: plateau stress of each against the default's.

    The scatter of a single run (`hardness_lo`, `hardness_hi`) limits what a difference means.
    """
    hardnesses = {
        name: find_hardness(
            curves[name], witnesses[name], run["wavelength_nm"] ** 2, on_base=run.get("film_nm") is not None
        )
        for name, run in runs.items()
    }
    for name, hardness in hardnesses.items():
        key, run = VARIATIONS[name][0], runs[name]
        settings, protocol = varied(name, closing)
        yield {
            "case": name,
            "knob": key,
            "value": getattr(settings if key == "speed_m_s" else protocol, key),
            "error": hardness.hardness_GPa / hardnesses["default"].hardness_GPa - 1,
            "error_metric": "relative difference of the plateau stress",
            "reference": "default",
            "hardness_GPa": hardness.hardness_GPa,
            "wall_s": run["wall_s"],
            "cpu_s": run["lammps_cpu_s"] + run["python_cpu_s"],
            "peak_rss_MB": run.get("peak_rss_MB"),
            "hardness_lo": hardness.hardness_lo,
            "hardness_hi": hardness.hardness_hi,
            "status": hardness.status,
            "atom_steps": run["atoms"] * run["steps"],
        }


def glass_checks(potential: Potential, glass: Atoms, energy_scales: Sequence[float], work: Path) -> list[Check]:
    """Checks that a glass of the scene keeps its energy; every closing run, of films too, has a gate on its own drift.

    Parameters
    ----------
    work : folder for LAMMPS, which the caller removes in the end.
    """

    def drift(kelvin: float, step_fs: float, scale: float) -> tuple[bool, str]:
        steps = round(4000 / step_fs)
        record, _ = free_motion(heated(glass, potential, kelvin), potential, work / "nve", step_fs, steps, scale)
        slope = drift_meV_atom_ps(record, len(glass), step_fs)
        return abs(slope) < RULES.max_drift_meV_atom_ps, f"{slope:+.4f} meV per atom and ps"

    closing_fs = PROTOCOL.timestep_fs
    cases = [
        *((f"room_x{scale:g}", PROTOCOL.temperature_K, closing_fs / scale**0.5, scale) for scale in energy_scales),
        ("cold", 10.0, closing_fs, 1.0),
        ("melt", MELT_K, TIMESTEP_FS, 1.0),
    ]
    return [
        (
            f"{label}_{potential.name}_{''.join(glass.elements)}",
            f"{kelvin:g} K, energies x {scale:g}, {step_fs:.3g} fs, 4 ps at constant energy",
            f"drift below {RULES.max_drift_meV_atom_ps} meV per atom and ps",
            partial(drift, kelvin, step_fs, scale),
        )
        for label, kelvin, step_fs, scale in cases
    ]


def free_motion(
    atoms: Atoms, potential: ForceField, work: Path, timestep_fs: float, steps: int, energy_scale: float = 1.0
) -> tuple[np.ndarray, Atoms]:
    """Run at constant energy; rows (step, potential, total energy in eV), and the atoms at the end."""
    shutil.rmtree(work, ignore_errors=True)
    workspace = Workspace(work, {}, "nve.in")
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
    record, end = load_averages(workspace / "energy.dat"), load_data(workspace / "end.data", atoms.elements)
    workspace.remove()
    return record, end


def heated(atoms: Atoms, potential: ForceField, temperature_K: float) -> Atoms:
    """The same atoms with Maxwell velocities."""
    rng = np.random.default_rng(np.random.SeedSequence([17]))
    masses = np.array([potential.masses_u[ion] for ion in atoms.elements])[atoms.types - 1]
    speeds = np.sqrt(BOLTZMANN_EV_PER_K * temperature_K / (KE_EV * masses))
    velocities = rng.normal(size=(len(atoms), 3)) * speeds[:, None]
    momentum = np.sum(velocities * masses[:, None], axis=0) / np.sum(masses)
    return replace(atoms, velocities_A_ps=velocities - momentum)


def drift_meV_atom_ps(record: np.ndarray, atoms: int, timestep_fs: float) -> float:
    """Slope of the total energy."""
    time_ps = record[:, 0] * timestep_fs / 1000
    return float(1000 * np.polyfit(time_ps, record[:, 2], 1)[0] / atoms)
