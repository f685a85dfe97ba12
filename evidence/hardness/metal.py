"""How hard is titanium by itself, as a crystal and as a polycrystal, and does its potential give its crystal?

The potential is that of `config/materials/titanium.yaml`. Gates come first: lattice and elastic constants at 0 K by a
sum over neighbours, the same energy by LAMMPS, the drift of the energy, the density of the polycrystal. Then
asperities are pressed as the hardness stage presses those of oxide. Metals change no bonds that could be counted, so
there is no witness of plasticity: hardness is the mean stress of the contact from 2 nm to 0.4 of the cell.
"""

import tempfile
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import minimize

from atomistic.constants import EV_PER_A3_IN_GPA
from atomistic.hardness.contact_area import Area
from atomistic.hardness.pressing import base_thickness_nm, plan_closing, prepare_body, press_bodies
from atomistic.hardness.readout import Readout
from atomistic.hardness.runs import PROTOCOL, ClosingRun
from atomistic.hardness.stability import drift_meV_atom_ps, free_motion, heated
from atomistic.lammps import Atoms, Workspace
from atomistic.materials import Eam, load_material
from atomistic.settings import AsperitySettings, ClosingSettings
from evidence.hardness import area as section
from evidence.hardness.metals import PLACES, Metal, annealed, crystal, lattice_energy, polycrystal, square_crystal
from evidence.record import ROOT

STRAIN = 4e-3
STEEPNESS = 0.1  # amplitude over wavelength, as in scene reduced
CLOSING = ClosingSettings(speed_m_s=100, depth_over_amplitude=2.0)
CRYSTAL_A, CRYSTAL_PS = 20.0, 3.0  # height of its cell, which is tiled, and anneal: it need only expand
LEAST_NM, MOST_SHARE = 2.0, 0.4
BINS_NM, BIN_NM = (1.5, 2.0, 2.5, 3.0, 3.5), 0.5  # of contact length
DEPTHS_A = (0.5, 1.0, 1.5)
MEASURED = {"a_A": 2.951, "c_A": 4.684, "C11_GPa": 162.4, "C12_GPa": 92.0, "C13_GPa": 69.0, "C33_GPa": 180.7}
"""Experiment at room temperature: Fisher and Renken (1964), and the lattice of any handbook."""


def arguments(parser: ArgumentParser) -> None:
    """Which parts."""
    parser.add_argument("parts", nargs="*", default=["gates", "area", "crystal", "polycrystal"])
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--wavelength", type=float, default=5.6, help="of the asperity, nm")
    parser.add_argument("--grain", type=float, default=3.0, help="nm")


def rows(given: Namespace) -> Iterator[dict[str, Any]]:
    """The gates, the error of the contact area, then the hardness of each body."""
    metal = titanium()
    edge = 10 * given.wavelength
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        if "gates" in given.parts:
            yield from gates(metal, work)
        if "area" in given.parts:
            yield from area_errors(metal, work)
        for kind in ("crystal", "polycrystal"):
            for seed in given.seeds if kind in given.parts else ():
                body = made(metal, kind, edge, 10 * given.grain, seed, work / "bulk")
                yield row(kind, "density_over_crystal", density(metal, body), seed)
                for name, value in press(metal, body, given.wavelength, seed, work / "press").items():
                    yield row(kind, name, value, seed)


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Lattice and constants; hardness of each kind of body."""
    found: dict[str, list[float]] = {}
    for row in rows:
        found.setdefault(f"{row['body']}_{row['quantity']}", []).append(float(row["value"]))
    shown = ("lattice_a_A", "lattice_c_A", "lattice_C11_GPa", "lattice_C12_GPa", "lattice_C13_GPa", "lattice_C33_GPa")
    texts = {name: f"{found[name][-1]:.4g}" for name in shown if name in found}
    for kind in ("crystal", "polycrystal"):
        if values := found.get(f"{kind}_hardness_GPa"):
            ends = dict.fromkeys(f"{value:.2g}" for value in (min(values), max(values)))
            texts[f"{kind}_hardness_GPa"] = f"{' to '.join(ends)} GPa"
    return texts


def row(body: str, quantity: str, value: float, seed: int | str = "") -> dict[str, Any]:
    """A row of the table; `experiment` where the quantity was measured."""
    measured = MEASURED.get(quantity, "")
    return {"body": body, "seed": seed, "quantity": quantity, "value": float(value), "experiment": measured}


def titanium() -> Metal:
    """Titanium as its file says."""
    return Metal(load_material(ROOT / "config" / "materials" / "titanium.yaml"))


def gates(metal: Metal, work: Path) -> Iterator[dict[str, Any]]:
    """Lattice, constants, LAMMPS's energy less that of the sum, and the drift of the energy at 300 K."""
    (a, c), energy = lattice(metal.eam)
    found = {"a_A": a, "c_A": c, "energy_eV": energy, **constants(metal.eam, a, c)}
    for name, value in found.items():
        yield row("lattice", name, value)
    atoms = crystal(metal, (8, 5, 5))
    record, _ = free_motion(atoms, metal, work / "still", 1.0, 1)  # pyright: ignore[reportArgumentType]
    a, c = metal.eam.lattice_A
    alike = lattice_energy(metal.eam, np.diag([a, a * np.sqrt(3), c]), PLACES)
    yield row("lattice", "LAMMPS_less_sum_eV", record[0, 1] / len(atoms) - alike)
    warm = heated(atoms, metal, 600)  # pyright: ignore[reportArgumentType]
    record, _ = free_motion(warm, metal, work / "warm", PROTOCOL.timestep_fs, 3000)  # pyright: ignore[reportArgumentType]
    yield row("lattice", "drift_meV_atom_ps", drift_meV_atom_ps(record, len(atoms), PROTOCOL.timestep_fs))


def lattice(eam: Eam) -> tuple[tuple[float, float], float]:
    """Edges a and c (Å) of least energy, and the energy of an atom (eV)."""

    def energy(edges: np.ndarray) -> float:
        return lattice_energy(eam, np.diag([edges[0], edges[0] * np.sqrt(3), edges[1]]), PLACES)

    found = minimize(energy, eam.lattice_A, method="Nelder-Mead", options={"xatol": 1e-6, "fatol": 1e-12})
    return (float(found.x[0]), float(found.x[1])), float(found.fun)


def constants(eam: Eam, a: float, c: float) -> dict[str, float]:
    """Elastic constants (GPa) by second differences of the energy, with atoms that follow."""
    cell = np.diag([a, a * np.sqrt(3), c])
    volume = float(np.linalg.det(cell)) / len(PLACES)

    def energy(strain: np.ndarray) -> float:
        def shifted(shift: np.ndarray) -> float:
            places = PLACES + np.outer([0, 0, 1, 1], shift)
            return lattice_energy(eam, cell * (1 + strain), places)

        return float(minimize(shifted, np.zeros(3), method="BFGS", options={"gtol": 1e-8}).fun)

    found = {}
    for name, i, j in (("C11", 0, 0), ("C12", 0, 1), ("C13", 0, 2), ("C33", 2, 2)):
        first, second = STRAIN * np.eye(3)[i], STRAIN * np.eye(3)[j]
        mixed = energy(first + second) - energy(first - second) - energy(second - first) + energy(-first - second)
        found[f"{name}_GPa"] = mixed / (4 * STRAIN**2 * volume) * EV_PER_A3_IN_GPA
    return found


def made(metal: Metal, kind: str, edge_A: float, grain_A: float, seed: int, work: Path) -> Atoms:
    """A body at 300 K in a cell of square section."""
    if kind == "crystal":
        return annealed(metal, square_crystal(metal, edge_A, CRYSTAL_A), work, seed, CRYSTAL_PS)
    return annealed(metal, polycrystal(metal, edge_A, grain_A, seed), work, seed)


def density(metal: Metal, body: Atoms) -> float:
    """Density over that of the crystal at 0 K."""
    a, c = metal.eam.lattice_A
    return float(len(body) * a**2 * np.sqrt(3) * c / 4 / np.prod(body.cell_A))


def area_errors(metal: Metal, work: Path) -> Iterator[dict[str, Any]]:
    """Found over known area, minus 1, by the depth within which atoms touch (study `hardness.area`)."""
    body = annealed(metal, polycrystal(metal, 28.0, 20.0, 1), work / "bulk", 1)
    layers = section.pressed_layers([(metal, body)], 1.0, Area(), work / "area")  # pyright: ignore[reportArgumentType]
    for depth in DEPTHS_A:
        errors = [row["error"] for row in section.cut_bodies(layers, Area(depth_A=depth))]
        for name, value in (("mean", np.mean(errors)), ("lowest", min(errors)), ("highest", max(errors))):
            yield row("slab", f"area_error_{name}_depth_{depth:g}_A", float(value))


def press(metal: Metal, body: Atoms, wavelength_nm: float, seed: int, work: Path) -> dict[str, float]:
    """Cut an asperity, anneal it, press it by a flat; hardness by each depth of the contact area."""
    run = ClosingRun(
        name="metal",
        asperity=AsperitySettings(name="metal", tiles=1, amplitude_nm=STEEPNESS * wavelength_nm),
        seed=seed,
        energy_scale=1.0,
    )
    base_nm = base_thickness_nm(CLOSING, float(body.cell_A[0]) / 10)
    aside = Workspace(work / "anneal", identity(body), "anneal.in")
    force: Any = metal  # has what of a `Potential` is used
    cut = prepare_body(run, body, force, CLOSING, PROTOCOL, aside, (seed, 7), run.asperity.amplitude_nm, base_nm)
    return pressed(run, cut, force, seed, work)


def identity(body: Atoms) -> dict[str, Any]:
    """What tells a body from the one pressed before in the same folder."""
    return {"body": body.positions_A.tolist()}


def pressed(run: ClosingRun, body: Atoms, force: Any, seed: int, work: Path) -> dict[str, float]:
    """Press a prepared body by a flat, as deep as the plan goes."""
    plan, workspace = plan_closing(CLOSING, run), Workspace(work / "closing", identity(body), "closing.in")
    geometry, plan = press_bodies(run, [body], force, CLOSING, PROTOCOL, plan, (seed, 8), workspace, lambda *_: False)
    found: dict[str, float] = {"atoms": len(body)}
    for depth in DEPTHS_A:
        readout = Readout(
            workspace, plan.segment_steps, plan.timestep, PROTOCOL.samples, Area(depth_A=depth), geometry, [1], 3.0
        )
        curve = readout.curve(range(1, plan.segments + 1))
        length, stress = (np.array([row[f"contact_{key}"] for row in curve]) for key in ("length_nm", "stress_GPa"))
        share = length**2 / (geometry.wavelength_A / 10) ** 2
        used = (length > LEAST_NM) & (share < MOST_SHARE)
        label = "" if depth == DEPTHS_A[0] else f"_depth_{depth:g}_A"
        found[f"hardness{label}_GPa"] = float(np.mean(stress[used]))
        found[f"exponent{label}"] = float(np.polyfit(np.log(length[used]), np.log(stress[used]), 1)[0])
        found[f"length{label}_nm"] = float(np.mean(length[used]))
        for low in BINS_NM:
            here = (length >= low) & (length < low + BIN_NM)
            if here.any():
                found[f"stress{label}_{low + BIN_NM / 2:g}_nm_GPa"] = float(np.mean(stress[here]))
        if depth == DEPTHS_A[0]:
            found["averages"] = int(used.sum())
            found["drift_meV_atom"] = float(max(abs(row["energy_drift_meV_per_atom"]) for row in curve))
            found["hottest_K"] = float(max(row["temperature_K"] for row in curve))
    return found
