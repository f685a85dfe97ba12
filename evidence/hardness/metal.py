"""How hard is titanium by itself: a crystal, one with dislocations, a polycrystal? Does its
potential give its crystal?

The potential is that of `config/materials/titanium.yaml`. Gates come first: lattice and elastic
constants at 0 K by a sum over neighbours, the same energy by LAMMPS, the drift of the energy, the
density of the polycrystal. Then asperities are pressed as the hardness stage presses them; hardness
is the mean stress while the contact is judged. Dislocations are loops about discs of missing basal
planes, closed by an anneal; `disordered_share` of the atoms have not the twelve neighbours of a
hexagonal crystal.
"""

import tempfile
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import minimize
from scipy.spatial import KDTree

from atomistic.constants import EV_PER_A3_IN_GPA
from atomistic.hardness.closing import run_closing
from atomistic.hardness.glass import run_segments
from atomistic.hardness.metal import (
    METAL,
    PLACES,
    Metal,
    crystal,
    electron_density,
    embedding_energy,
    pair_energy,
)
from atomistic.hardness.motion import drift_meV_atom_ps, free_motion, heated
from atomistic.hardness.plateau import RULES
from atomistic.hardness.runs import PROTOCOL, ClosingRun
from atomistic.lammps import Atoms, LammpsFolder
from atomistic.materials import Eam, load_material
from atomistic.settings import AsperitySettings, ClosingSettings
from evidence.hardness.choices import silica_and
from evidence.record import ROOT

STRAIN = 4e-3
STEEPNESS = 0.1  # amplitude over wavelength, as in scene reduced
# in a crystal twice as high as wide ones are; radius
LOOPS, LOOP_A, LOOP_K, LOOP_PS = (2, 10.0, 600.0, 15.0)
FIRST_SHELL_A = 3.5  # between the first and the second neighbours of the crystal at 300 K
# height of its cell, which is tiled; its edges at 300 K over those at 0 K
CRYSTAL_A, EXPANDED = (20.0, 1.0043)
KINDS = ("crystal", "dislocated", "polycrystal")
MEASURED = {
    "a_A": 2.951,
    "c_A": 4.684,
    "C11_GPa": 162.4,
    "C12_GPa": 92.0,
    "C13_GPa": 69.0,
    "C33_GPa": 180.7,
}
"""Experiment at room temperature: Fisher and Renken (1964), and the lattice of any handbook."""


def arguments(parser: ArgumentParser) -> None:
    """Which parts."""
    parser.add_argument("parts", nargs="*", default=["gates", *KINDS])
    parser.add_argument("--seeds", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--wavelength", type=float, default=5.6, help="of the asperity, nm")


def rows(given: Namespace) -> Iterator[dict[str, Any]]:
    """The gates, then the hardness of each body."""
    metal = titanium()
    edge = 10 * given.wavelength
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        if "gates" in given.parts:
            yield from gates(metal, work)
        for kind in KINDS:
            for seed in given.seeds if kind in given.parts else ():
                if kind == "polycrystal":
                    body = metal.make(edge, 1, seed, work / "bulk")
                elif kind == "dislocated":
                    body = dislocated(
                        metal, square_crystal(metal, edge, 2 * CRYSTAL_A), seed, work / "bulk"
                    )
                else:
                    body = square_crystal(metal, edge, CRYSTAL_A)
                yield row(kind, "density_over_crystal", density(metal, body), seed)
                yield row(kind, "disordered_share", disordered_share(body), seed)
                for name, value in press(metal, body, seed, work / "press").items():
                    yield row(kind, name, value, seed)


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Lattice and constants; hardness of each kind of body."""
    found: dict[str, list[float]] = {}
    for row in rows:
        found.setdefault(f"{row['body']}_{row['quantity']}", []).append(float(row["value"]))
    shown = (
        "lattice_a_A",
        "lattice_c_A",
        "lattice_C11_GPa",
        "lattice_C12_GPa",
        "lattice_C13_GPa",
        "lattice_C33_GPa",
    )
    texts = {name: f"{found[name][-1]:.4g}" for name in shown if name in found}
    for kind in KINDS:
        if values := found.get(f"{kind}_hardness_GPa"):
            ends = dict.fromkeys(f"{value:.2g}" for value in (min(values), max(values)))
            texts[f"{kind}_hardness_GPa"] = f"{' to '.join(ends)} GPa"
    return texts


def row(body: str, quantity: str, value: float, seed: int | str = "") -> dict[str, Any]:
    """A row of the table; `experiment` where the quantity was measured."""
    measured = MEASURED.get(quantity, "")
    return {
        "body": body,
        "seed": seed,
        "quantity": quantity,
        "value": float(value),
        "experiment": measured,
    }


def titanium() -> Metal:
    """Titanium as its file says."""
    return Metal(load_material(ROOT / "config" / "materials" / "titanium.yaml"))


def gates(metal: Metal, work: Path) -> Iterator[dict[str, Any]]:
    """Lattice, constants, LAMMPS's energy less that of the sum, and the drift of the energy at 300
    K.
    """
    (a, c), energy = lattice(metal.eam)
    found = {"a_A": a, "c_A": c, "energy_eV": energy, **constants(metal.eam, a, c)}
    for name, value in found.items():
        yield row("lattice", name, value)
    atoms = crystal(metal, (8, 5, 5))
    record, _ = free_motion(atoms, metal, work / "still", 1.0, 1)
    a, c = metal.eam.lattice_A
    alike = lattice_energy(metal.eam, np.diag([a, a * np.sqrt(3), c]), PLACES)
    yield row("lattice", "LAMMPS_less_sum_eV", record[0, 1] / len(atoms) - alike)
    warm = heated(atoms, metal, 600)
    record, _ = free_motion(warm, metal, work / "warm", PROTOCOL.timestep_fs, 3000)
    yield row(
        "lattice", "drift_meV_atom_ps", drift_meV_atom_ps(record, len(atoms), PROTOCOL.timestep_fs)
    )


def lattice(eam: Eam) -> tuple[tuple[float, float], float]:
    """Edges a and c (Å) of least energy, and the energy of an atom (eV)."""

    def energy(edges: np.ndarray) -> float:
        return lattice_energy(eam, np.diag([edges[0], edges[0] * np.sqrt(3), edges[1]]), PLACES)

    found = minimize(
        energy, eam.lattice_A, method="Nelder-Mead", options={"xatol": 1e-6, "fatol": 1e-12}
    )
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
        mixed = (
            energy(first + second)
            - energy(first - second)
            - energy(second - first)
            + energy(-first - second)
        )
        found[f"{name}_GPa"] = mixed / (4 * STRAIN**2 * volume) * EV_PER_A3_IN_GPA
    return found


def square_crystal(metal: Metal, edge_A: float, height_A: float) -> Atoms:
    """One crystal as wide as at 300 K, strained into a square cell by less than 0.5 %, about as
    wide as asked for.

    Raises
    ------
    ValueError : no width within 15 % is that near a square.
    """
    a, c = metal.eam.lattice_A
    pairs = [(n, round(n / np.sqrt(3))) for n in range(1, 80) if abs(n * a / edge_A - 1) < 0.15]
    n, m = min(pairs, key=lambda pair: abs(pair[1] * np.sqrt(3) / pair[0] - 1))
    if abs(m * np.sqrt(3) / n - 1) > 0.01:
        raise ValueError(f"{edge_A:.1f} A: no crystal of a square section of about this width")
    atoms = crystal(metal, (n, m, max(1, round(height_A / c))))
    cell = EXPANDED * atoms.cell_A
    cell[:2] = np.sqrt(cell[0] * cell[1])
    return Atoms(atoms.elements, atoms.types, atoms.positions_A * cell / atoms.cell_A, cell)


def dislocated(metal: Metal, whole: Atoms, seed: int, work: Path) -> Atoms:
    """A crystal from which discs of basal planes are missing, annealed so that they close and leave
    loops.
    """
    rng = np.random.default_rng(np.random.SeedSequence([seed, 53]))
    # of basal planes
    spacing = whole.cell_A[2] / round(whole.cell_A[2] / (EXPANDED * metal.eam.lattice_A[1] / 2))
    plane = np.round(whole.positions_A[:, 2] / spacing).astype(int)
    missing = np.zeros(len(whole), bool)
    for k in range(LOOPS):
        centre = rng.uniform(0, whole.cell_A)
        apart = whole.positions_A[:, :2] - centre[:2]
        apart -= whole.cell_A[:2] * np.round(apart / whole.cell_A[:2])
        at = round((k + 0.5) / LOOPS * whole.cell_A[2] / spacing)
        missing |= (np.hypot(*apart.T) < LOOP_A) & (plane == at)
    steps = round(1000 * LOOP_PS / METAL.timestep_fs)
    parts = [(LOOP_K, LOOP_K), (LOOP_K, METAL.final_K), (METAL.final_K, METAL.final_K)]
    segments = [
        {"ensemble": "npt_height", "from": start, "to": end, "steps": steps} for start, end in parts
    ]
    workspace = LammpsFolder(work, {"seed": seed}, "glass.in")
    start = whole.take(~missing)
    return run_segments(
        workspace,
        metal,
        whole.elements,
        lambda: start,
        segments,
        seed,
        METAL.timestep_fs,
        "anneal",
        None,
    )


def disordered_share(body: Atoms) -> float:
    """Share of the atoms without twelve nearest neighbours."""
    places = np.mod(body.positions_A, body.cell_A)
    neighbours = KDTree(places, boxsize=body.cell_A).query_ball_point(
        places, FIRST_SHELL_A, return_length=True
    )
    return float(np.mean(neighbours != 13))  # itself among them


def press(metal: Metal, body: Atoms, seed: int, work: Path) -> dict[str, float]:
    """Mean stress of an asperity cut out of a body and pressed by a flat, while the contact is
    judged.
    """
    silica, oxide = silica_and("pmmcs")
    wavelength_nm = float(body.cell_A[0]) / 10
    asperity = AsperitySettings(
        name="metal", tiles=1, amplitude_nm=STEEPNESS * wavelength_nm, film_nm=0.0
    )
    run = ClosingRun(name="metal", asperity=asperity, seed=seed, energy_scale=1.0)
    no_glass = Atoms(("Si", "O"), np.zeros(0, int), np.zeros((0, 3)), body.cell_A)
    closing = ClosingSettings(stop="window")
    made = run_closing(run, silica, no_glass, oxide, closing, work, base=(metal, body))
    length, stress = (
        np.array([row[f"contact_{key}"] for row in made.curve])
        for key in ("length_nm", "stress_GPa")
    )
    used = (length > RULES.min_length_nm) & (length < RULES.max_area_fraction**0.5 * wavelength_nm)
    return {"hardness_GPa": float(np.mean(stress[used])), "averages": int(used.sum())}


def density(metal: Metal, body: Atoms) -> float:
    """Density over that of the crystal at 0 K."""
    a, c = metal.eam.lattice_A
    return float(len(body) * a**2 * np.sqrt(3) * c / 4 / np.prod(body.cell_A))


def lattice_energy(eam: Eam, cell_A: np.ndarray, places: np.ndarray) -> float:
    """Energy of an atom (eV) of a periodic cell by the sum over all neighbours: for gates, beside
    LAMMPS.

    Parameters
    ----------
    cell_A : rows are its edges, (3, 3). places : fractions of them, (atoms, 3).
    """
    heights = 1 / np.linalg.norm(np.linalg.inv(cell_A), axis=0)
    ranges = [np.arange(-n, n + 1) for n in np.ceil(METAL.cutoff_A / heights).astype(int)]
    shifts = np.stack(np.meshgrid(*ranges, indexing="ij"), axis=-1).reshape(-1, 3)
    apart = (places[None, :, None] - places[:, None, None] + shifts) @ cell_A
    r = np.linalg.norm(apart, axis=-1)
    met = (r > 1e-6) & (r < METAL.cutoff_A)
    r = np.where(met, r, 1.0)
    density = np.where(met, electron_density(eam, r), 0.0).sum(axis=(1, 2))
    pairs = np.where(met, pair_energy(eam, r), 0.0).sum() / 2
    return float((embedding_energy(eam, density).sum() + pairs) / len(places))
