"""Metals by an embedded-atom potential in closed form: its file for LAMMPS, and bodies of one and of many crystals.

The functions are those of X. W. Zhou, R. A. Johnson and H. N. G. Wadley, Phys. Rev. B 69, 144113 (2004).
"""

import io
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial import KDTree
from scipy.spatial.transform import Rotation

from atomistic.lammps import Atoms, Workspace, load_data, run_lammps, write_data
from atomistic.materials import Eam, Material

POINTS = 5000
CUTOFF_A = 7.0  # all functions of titanium are below 2e-6 eV there; at the authors' 6.56 A lies a shell of neighbours
MOST_DENSITY = 4.0  # end of the table of embedding, over the density of the crystal
TOO_NEAR = 0.75  # of the nearest distance: of two atoms of different grains that are nearer one is left out
ANNEAL_K, ANNEAL_PS, TIMESTEP_FS = 900.0, 10.0, 3.0
PLACES = np.array([[0, 0, 0], [1 / 2, 1 / 2, 0], [1 / 2, 5 / 6, 1 / 2], [0, 1 / 3, 1 / 2]])
"""Atoms of the cell with edges a, a sqrt(3) and c."""


def pair_energy(eam: Eam, r: np.ndarray) -> np.ndarray:
    """Energy of a pair (eV) at a distance (Å)."""
    x = r / eam.r_A
    repulsion = eam.A_eV * np.exp(-eam.alpha * (x - 1)) / (1 + (x - eam.kappa) ** 20)
    return repulsion - eam.B_eV * np.exp(-eam.beta * (x - 1)) / (1 + (x - eam.lambda_) ** 20)


def electron_density(eam: Eam, r: np.ndarray) -> np.ndarray:
    """Electron density of an atom at a distance (Å)."""
    x = r / eam.r_A
    return eam.f * np.exp(-eam.beta * (x - 1)) / (1 + (x - eam.lambda_) ** 20)


def embedding_energy(eam: Eam, density: np.ndarray) -> np.ndarray:
    """Energy (eV) of an atom in an electron density."""
    inner = np.polyval(eam.F_inner_eV[::-1], density / (0.85 * eam.rho) - 1)
    middle = np.polyval(eam.F_middle_eV[::-1], density / eam.rho - 1)
    power = np.maximum(density / eam.rho, 1e-9) ** eam.eta
    outer = eam.F_outer_eV * (1 - np.log(power)) * power
    return np.where(density < 0.85 * eam.rho, inner, np.where(density < 1.15 * eam.rho, middle, outer))


@dataclass(frozen=True)
class Metal:
    """A metal, pressed by the hardness stage as the oxide of a `Potential` is."""

    material: Material

    @property
    def element(self) -> str:
        """Its chemical symbol."""
        return next(iter(self.material.formula))

    @property
    def eam(self) -> Eam:
        """Its potential."""
        return self.material.part("eam")

    @property
    def species(self) -> Mapping[str, Any]:
        """What has the mass of its atoms, by element."""
        return {self.element: self.eam}

    def setfl(self, energy_scale: float = 1.0) -> str:
        """The potential for LAMMPS's `pair_style eam/alloy`, all energies scaled."""
        eam = self.eam
        density, r = np.linspace(0, MOST_DENSITY * eam.rho, POINTS), np.linspace(0, CUTOFF_A, POINTS)
        text = io.StringIO()
        text.write(f"{self.material.name}, energies x {energy_scale:g}\n{eam.source}\n\n1 {self.element}\n")
        text.write(f"{POINTS} {density[1]:.16g} {POINTS} {r[1]:.16g} {CUTOFF_A}\n0 {eam.mass_u} {eam.r_A} any\n")
        np.savetxt(text, energy_scale * embedding_energy(eam, density), fmt="%.16g")
        np.savetxt(text, electron_density(eam, r), fmt="%.16g")
        np.savetxt(text, energy_scale * r * pair_energy(eam, r), fmt="%.16g")
        return text.getvalue()

    def files(self, elements: tuple[str, ...], energy_scale: float, repelled: None = None) -> dict[str, str]:
        """What LAMMPS needs, as `Potential.files`."""
        lines = ("pair_style eam/alloy", f"pair_coeff * * metal.eam {' '.join(elements)}", *NEIGHBOURS)
        return {"metal.eam": self.setfl(energy_scale), "pairs": "\n".join(lines) + "\n"}


NEIGHBOURS = ("neighbor 1.0 bin", "neigh_modify every 2 delay 0 check yes")


def crystal(metal: Metal, repeats: tuple[int, int, int]) -> Atoms:
    """A hexagonal crystal with its axis upright, in cells of a, a sqrt(3) and c."""
    a, c = metal.eam.lattice_A
    cell = np.array([a, a * np.sqrt(3), c])
    offsets = np.stack(np.meshgrid(*map(np.arange, repeats), indexing="ij"), axis=-1).reshape(-1, 3)
    positions = (offsets[:, None] + PLACES).reshape(-1, 3) * cell
    return Atoms((metal.element,), np.ones(len(positions), int), positions, cell * repeats)


def square_crystal(metal: Metal, edge_A: float, height_A: float) -> Atoms:
    """A crystal strained into a square cell by less than 0.5 %, about as wide as asked for.

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
    cell = atoms.cell_A.copy()
    cell[:2] = np.sqrt(cell[0] * cell[1])
    return Atoms(atoms.elements, atoms.types, atoms.positions_A * cell / atoms.cell_A, cell)


def polycrystal(metal: Metal, edge_A: float, grain_A: float, seed: int) -> Atoms:
    """A cube of grains of random places and orientations (Voronoi cells); dense only after `annealed`.

    Parameters
    ----------
    grain_A : diameter of a sphere of the mean volume of a grain.
    """
    rng = np.random.default_rng(np.random.SeedSequence([seed, 41]))
    grains = max(1, round(edge_A**3 / (np.pi / 6 * grain_A**3)))
    centres = rng.uniform(0, edge_A, (grains, 3))
    images = np.stack(np.meshgrid(*[[-1, 0, 1]] * 3, indexing="ij"), axis=-1).reshape(-1, 3) * edge_A
    nearest = KDTree((centres[:, None] + images).reshape(-1, 3))
    reach = min(3 * grain_A, 0.9 * edge_A)  # of a grain from its centre
    cells = np.ceil(2 * reach / crystal(metal, (1, 1, 1)).cell_A).astype(int)
    one = crystal(metal, (int(cells[0]), int(cells[1]), int(cells[2])))
    grown = []
    for k, centre in enumerate(centres):
        turn = Rotation.random(rng=rng)
        places = turn.apply(one.positions_A - one.cell_A / 2 + rng.uniform(-1, 1, 3)) + centre
        grown.append(places[nearest.query(places)[1] == k * len(images) + len(images) // 2])
    positions = np.mod(np.concatenate(grown), edge_A)
    near = KDTree(positions, boxsize=edge_A).query_pairs(TOO_NEAR * metal.eam.r_A)
    positions = np.delete(positions, sorted({max(pair) for pair in near}), axis=0)
    return Atoms((metal.element,), np.ones(len(positions), int), positions, np.full(3, edge_A))


def annealed(metal: Metal, atoms: Atoms, work: Path, seed: int, anneal_ps: float = ANNEAL_PS) -> Atoms:
    """The body after an anneal at zero pressure, cooled to 300 K in the same time; its cell keeps its shape."""
    workspace = Workspace(work, {"seed": seed, "atoms": atoms.positions_A.tolist()}, "glass.in")
    for name, text in metal.files(atoms.elements, 1.0).items():
        (workspace / name).write_text(text, encoding="utf-8")
    write_data(workspace / "start.data", atoms, {metal.element: metal.eam.mass_u})
    steps = round(1000 * anneal_ps / TIMESTEP_FS)
    variables = {
        "data": "start.data",
        "pairs": "pairs",
        "seed": 1 + seed,
        "timestep": TIMESTEP_FS / 1000,
        "segment": [1, 2, 3],
        "previous": [0, 1, 2],
        "ensemble": ["npt"] * 3,
        "from": [ANNEAL_K, ANNEAL_K, 300.0],
        "to": [ANNEAL_K, 300.0, 300.0],
        "steps": [steps, steps, steps // 3],
    }
    run_lammps("glass.in", workspace, variables)
    done = load_data(workspace / "glass.data", atoms.elements)
    workspace.remove()
    return done


def lattice_energy(eam: Eam, cell_A: np.ndarray, places: np.ndarray) -> float:
    """Energy of an atom (eV) of a periodic cell by the sum over all neighbours: for gates, beside LAMMPS.

    Parameters
    ----------
    cell_A : rows are its edges, (3, 3). places : fractions of them, (atoms, 3).
    """
    heights = 1 / np.linalg.norm(np.linalg.inv(cell_A), axis=0)
    ranges = [np.arange(-n, n + 1) for n in np.ceil(CUTOFF_A / heights).astype(int)]
    shifts = np.stack(np.meshgrid(*ranges, indexing="ij"), axis=-1).reshape(-1, 3)
    apart = (places[None, :, None] - places[:, None, None] + shifts) @ cell_A
    r = np.linalg.norm(apart, axis=-1)
    met = (r > 1e-6) & (r < CUTOFF_A)
    r = np.where(met, r, 1.0)
    density = np.where(met, electron_density(eam, r), 0.0).sum(axis=(1, 2))
    pairs = np.where(met, pair_energy(eam, r), 0.0).sum() / 2
    return float((embedding_energy(eam, density).sum() + pairs) / len(places))
