"""Molecular dynamics in hard cases, on a glass of some hundred atoms: invariant checks."""

import shutil
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from atomistic.constants import BOLTZMANN_EV_PER_K, COULOMB_EV_A, KE_EV
from atomistic.errors import InputError
from atomistic.hardness.asperity import cut_asperity
from atomistic.hardness.closing import run_closing
from atomistic.hardness.glass import make_glass, write_forcefield
from atomistic.hardness.runs import planned_runs
from atomistic.lammps import (
    Atoms,
    Workspace,
    load_averages,
    load_data,
    load_dump,
    run_lammps,
    write_data,
)
from atomistic.materials import Material
from atomistic.potentials import Potential
from atomistic.settings import GlassSettings, HardnessSettings

QUICK = GlassSettings(atoms=150, melt_ps=1, quench_rate_K_ps=1000, rest_ps=0.5, segment_steps=500)
MAX_DRIFT = 0.2  # meV per atom and ps, the gate of the closing runs
MAX_DRIFT_CLOSING = 1.0  # the same for closings of some ps, in which a cut surface has hardly come to rest
MAX_COULOMB = 0.1  # of a bond's force


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


def stability_checks(potentials: list[Potential], oxides: Mapping[str, Material], work: Path) -> list[Check]:
    """Checks of every potential on a glass made here, and of closings with the first one that knows silica.

    Parameters
    ----------
    oxides : materials with an oxide glass by formula.
    work : folder for LAMMPS, which the caller removes in the end.
    """
    glasses = {
        potential.name: make_glass(oxides[next(iter(potential.materials))], potential, QUICK, 1, work / potential.name)
        for potential in potentials
    }
    checks = [check for potential in potentials for check in _of_potential(potential, glasses[potential.name], work)]
    asperity = oxides[HardnessSettings().material]
    first = next(potential for potential in potentials if asperity.formula_text in potential.materials)
    return checks + _of_closing(asperity, first, glasses[first.name], work)


def _of_potential(potential: Potential, glass: Atoms, work: Path) -> list[Check]:
    checks: list[Check] = [
        (
            f"{label}_{potential.name}",
            f"{kelvin} K, energies x {scale}, {step} fs, 4 ps at constant energy",
            f"drift below {MAX_DRIFT} meV per atom and ps",
            lambda k=kelvin, s=scale, h=step: _drift(glass, potential, work, k, s, h),
        )
        for label, kelvin, scale, step in (
            ("room", 300, 1.0, 2.0),
            ("halved", 300, 0.5, 2.0),
            ("cold", 10, 1.0, 2.0),
            ("melt", 4000, 1.0, 2.0),
            ("long_step", 300, 1.0, 4.0),
        )
    ]
    checks.append(
        (
            f"half_energy_identity_{potential.name}",
            "halved energies at T against full at 2T, time x sqrt 2",
            "same path to 1e-5 A after 100 steps",
            lambda: half_energy_identity(glass, potential, work),
        )
    )
    checks += [
        (
            f"coulomb_{shape}_{potential.name}",
            f"forces on a {shape}: damped sum in the table against PPPM",
            f"rms difference below {MAX_COULOMB:.0%} of a bond's Coulomb force; no net force on the sample",
            lambda flat=shape == "slab": coulomb_difference(glass, potential, work, flat),
        )
        for shape in ("glass", "slab")
    ]
    return checks


def _of_closing(material: Material, potential: Potential, glass: Atoms, work: Path) -> list[Check]:
    body = {"counterface": "oxide", "interface": "adhesive"}
    force = {"control": "force", "dwell_ps": 0.2, "max_stress_GPa": 3, "segment_force_steps": 5}
    return [
        (
            "overlapping_start",
            "two atoms 0.2 A apart",
            "one-line error that names the cause",
            lambda: _overlap(glass, potential, work),
        ),
        *(
            (
                case,
                description,
                f"no atom lost, energy balance within {MAX_DRIFT_CLOSING} meV per atom and ps",
                lambda settings=changes: _closing(material, glass, potential, work, settings),
            )
            for case, description, changes in (
                ("snap_in", "an adhesive oxide is let snap onto the asperity", body),
                ("hot", "closing at 1200 K", {"temperature_K": 1200}),
                ("cold", "closing at 10 K", {"temperature_K": 10}),
                ("fast", "closing at 1000 m/s", {"speed_m_s": 1000}),
                ("force_step", "controlled force, 60 MPa a step", {**force, "force_step_MPa": 60}),
                ("force_step_tenfold", "controlled force, 600 MPa a step", {**force, "force_step_MPa": 600}),
            )
        ),
    ]


def _closing(
    material: Material, glass: Atoms, potential: Potential, work: Path, changes: Mapping[str, object]
) -> tuple[bool, str]:
    """A closing of some hundred atoms: LAMMPS stops if it loses one, the curve tells the energy balance."""
    quick = {"base_nm": 1.4, "base_over_contact": 0, "counter_base_nm": 1.4, "speed_m_s": 200, "anneal_ps": 0.5}
    settings = HardnessSettings.model_validate(
        {
            "seeds": [1],
            "energy_scales": [1.0],
            "asperities": [{"name": "tiny", "tiles": 2, "amplitude_nm": 0.2}],
            "closing": {**quick, **changes},
        }
    )
    [run] = planned_runs(settings)
    try:
        curve = run_closing(run, material, glass, potential, settings, work / "closing").curve
    except InputError as error:
        return False, str(error).split("; details")[0]
    elapsed_ps = curve[-1]["time_ps"] - curve[0]["time_ps"]
    drift = (curve[-1]["energy_drift_meV_per_atom"] - curve[0]["energy_drift_meV_per_atom"]) / elapsed_ps
    hottest = max(row["temperature_K"] for row in curve)
    return abs(drift) < MAX_DRIFT_CLOSING, f"{drift:+.3f} meV per atom and ps; up to {hottest:.0f} K"


def coulomb_difference(glass: Atoms, potential: Potential, work: Path, slab: bool) -> tuple[bool, str]:
    """Forces of the table (damped, shifted-force Coulomb) against those of PPPM, in bulk or as a neutral slab.

    A neutral cut still has a dipole, whose uniform field PPPM keeps and the damped sum leaves out, as charges
    that compensate the surface would.  It is told apart from the rest.
    """
    atoms = cut_asperity(glass, 2, 0.0, 14.0, 1) if slab else glass
    forces = []
    for method in ("none", "pppm"):
        workspace = Workspace(work / "forces", {"method": method}, "forces.in")
        write_forcefield(workspace, potential, atoms.elements, 1.0, long_range=method == "pppm")
        write_data(workspace / "start.data", atoms, {ion: potential.species[ion].mass_u for ion in atoms.elements})
        charges = [f"set type {k} charge {potential.species[ion].charge_e}" for k, ion in enumerate(atoms.elements, 1)]
        (workspace / "charges").write_text("\n".join(charges) + "\n", encoding="utf-8")
        variables = {
            "data": "start.data",
            "pairs": "pairs",
            "charges": "charges",
            "kspace": method,
            "slab": "yes" if slab else "no",
        }
        run_lammps("forces.in", workspace, variables)
        [(_, table)] = load_dump(workspace / "forces.dump")
        forces.append(table[:, 2:5])
        workspace.remove()
    difference = forces[0] - forces[1]
    charge = np.array([potential.species[ion].charge_e for ion in atoms.elements])[atoms.types - 1]
    field = float(np.sum(charge * difference[:, 2]) / np.sum(charge**2)) if slab else 0.0
    difference[:, 2] -= charge * field
    typical = _bond_force(potential)
    rest = float(np.sqrt(np.mean(difference**2))) / typical
    net = float(np.abs(forces[0].sum(axis=0)).max()) / len(atoms) / typical
    detail = f"rms difference {rest:.1%} of a bond's force; net {net:.0e}"
    return rest < MAX_COULOMB and net < 1e-6, detail + (f"; field of the cut's dipole {field:+.2f} V/A" * slab)


def _bond_force(potential: Potential) -> float:
    """The Coulomb force of two ions 2 Å apart, the scale that the forces in a glass balance on, eV/Å."""
    charges = [abs(ion.charge_e) for ion in potential.species.values()]
    return COULOMB_EV_A * max(charges) * min(charges) / 4


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
