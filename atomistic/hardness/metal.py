"""A metal below an oxide film: its embedded-atom potential, and dense bodies of grains.

The functions are those of X. W. Zhou, R. A. Johnson and H. N. G. Wadley, Phys. Rev. B 69, 144113
(2004).
"""

import io
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.spatial import KDTree
from scipy.spatial.transform import Rotation

from asperity.guards.errors import InputError
from atomistic.hardness.film_base import Base
from atomistic.hardness.glass import run_segments
from atomistic.lammps import Atoms, LammpsFolder, Progress
from atomistic.materials import Eam


@dataclass(frozen=True)
class MetalNumerics:
    """How the potential is tabulated and a body of grains is made."""

    points: int = 5000
    """Of a table."""

    cutoff_A: float = 7.0
    """Titanium's functions are below 2e-6 eV here; the authors' 6.56 Å is a shell of neighbours."""

    most_density: float = 4.0
    """End of the table of embedding, over the density of the crystal."""

    too_near: float = 0.75
    """Of the nearest distance: of two atoms of different grains that are nearer one is left out."""

    anneal_K: float = 900.0
    """Of the anneal."""

    anneal_ps: float = 10.0
    """Of the anneal, and as long of the cooling after it."""

    final_K: float = 300.0
    """After the cooling."""

    timestep_fs: float = 3.0
    """Of anneal, cooling and rest."""

    max_strain: float = 0.01
    """Of the dense body, brought to the width of the asperity."""

    annealed_density: float = 0.972
    """Of grains after the anneal, over the crystal at 0 K (study `hardness.metal`)."""

    widenings: int = 3
    """Steps in which the number of atoms follows the width, to 0.1 %."""


METAL = MetalNumerics()
PLACES = np.array([[0, 0, 0], [1 / 2, 1 / 2, 0], [1 / 2, 5 / 6, 1 / 2], [0, 1 / 3, 1 / 2]])
"""Atoms of the cell with edges a, a sqrt(3) and c."""


def pair_energy(eam: Eam, r: np.ndarray) -> np.ndarray:
    """Energy of a pair (eV) at a distance (Å)."""
    x = r / eam.r_A
    repulsion = eam.A_eV * np.exp(-eam.alpha * (x - 1)) / (1 + (x - eam.kappa) ** 20)
    attraction = eam.B_eV * np.exp(-eam.beta * (x - 1)) / (1 + (x - eam.lambda_) ** 20)
    return repulsion - attraction


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
    beyond_inner = np.where(density < 1.15 * eam.rho, middle, outer)
    return np.where(density < 0.85 * eam.rho, inner, beyond_inner)


@dataclass(frozen=True)
class Metal(Base):
    """A metal below films, or by itself."""

    styles = ("eam/alloy",)

    @property
    def eam(self) -> Eam:
        """Its potential."""
        return self.material.part("eam")

    @property
    def masses_u(self) -> Mapping[str, float]:
        """Mass of its element."""
        return {self.elements[0]: self.eam.mass_u}

    @property
    def atoms_per_nm3(self) -> float:
        """Of the hexagonal crystal."""
        a, c = self.eam.lattice_A
        return 4e3 / (a**2 * np.sqrt(3) * c)

    def commands(self, above: int) -> list[str]:
        """Commands of its own atoms, type 1."""
        return [
            f"pair_coeff * * eam/alloy metal.eam {' '.join([*self.elements, *['NULL'] * above])}"
        ]

    def tables(self) -> dict[str, str]:
        """The potential for LAMMPS's `pair_style eam/alloy`."""
        eam = self.eam
        count, end_A = METAL.points, METAL.cutoff_A
        density = np.linspace(0, METAL.most_density * eam.rho, count)
        r = np.linspace(0, end_A, count)
        text = io.StringIO()
        text.write(f"{self.material.name}\n{eam.source}\n\n1 {self.elements[0]}\n")
        text.write(
            f"{count} {density[1]:.16g} {count} {r[1]:.16g} {end_A}\n0 {eam.mass_u} {eam.r_A} any\n"
        )
        np.savetxt(text, embedding_energy(eam, density), fmt="%.16g")
        np.savetxt(text, electron_density(eam, r), fmt="%.16g")
        np.savetxt(text, r * pair_energy(eam, r), fmt="%.16g")
        return {"metal.eam": text.getvalue()}

    def make(
        self, edge_A: float, tiles: int, seed: int, work: Path, progress: Progress | None = None
    ) -> Atoms:
        """A cube of grains as wide as the asperity, annealed at zero pressure, cooled to 300 K.

        Grain boundaries are cut too wide and close in the anneal, so that the cube starts wider
        than it comes out.

        Raises
        ------
        InputError : the material has no potential or no grains, or its cube came out of another
            width than foreseen.
        """
        wide_A = tiles * edge_A
        segments = _segments()
        identity = {
            "metal": self.material.model_dump(),
            "edge": wide_A,
            "seed": seed,
            "segments": segments,
        }
        body = run_segments(
            LammpsFolder(work, identity, "glass.in"),
            self,
            self.elements,
            lambda: _wide_enough(self, wide_A, seed),
            segments,
            1 + seed,
            METAL.timestep_fs,
            "annealing the metal",
            progress,
        )
        factor = wide_A / body.cell_A[0]
        if abs(factor - 1) > METAL.max_strain:
            raise InputError(
                f"{self.material.name}: its cube would be strained by {factor - 1:+.1%} to the"
                f" {wide_A:.1f} A of the asperity (gate {METAL.max_strain:.0%}); take a wider"
                " asperity (tiles)"
            )
        return replace(body, positions_A=factor * body.positions_A, cell_A=factor * body.cell_A)


def crystal(metal: Metal, repeats: tuple[int, int, int]) -> Atoms:
    """A hexagonal crystal with its axis upright, in cells of a, a sqrt(3) and c."""
    a, c = metal.eam.lattice_A
    cell = np.array([a, a * np.sqrt(3), c])
    numbers = np.meshgrid(*map(np.arange, repeats), indexing="ij")
    offsets = np.stack(numbers, axis=-1).reshape(-1, 3)
    positions = (offsets[:, None] + PLACES).reshape(-1, 3) * cell
    return Atoms(metal.elements, np.ones(len(positions), int), positions, cell * repeats)


def polycrystal(metal: Metal, edge_A: float, grain_A: float, seed: int) -> Atoms:
    """A cube of grains of random place and orientation (Voronoi); dense after `annealed`.

    Parameters
    ----------
    grain_A : diameter of a sphere of the mean volume of a grain.
    """
    rng = np.random.default_rng(np.random.SeedSequence([seed, 41]))
    grains = max(1, round(edge_A**3 / (np.pi / 6 * grain_A**3)))
    centres = rng.uniform(0, edge_A, (grains, 3))
    neighbours = np.meshgrid(*[[-1, 0, 1]] * 3, indexing="ij")
    images = np.stack(neighbours, axis=-1).reshape(-1, 3) * edge_A
    nearest = KDTree((centres[:, None] + images).reshape(-1, 3))
    reach = min(3 * grain_A, 0.9 * edge_A)  # of a grain from its centre
    cells_x, cells_y, cells_z = np.ceil(2 * reach / crystal(metal, (1, 1, 1)).cell_A).astype(int)
    grain = crystal(metal, (int(cells_x), int(cells_y), int(cells_z)))
    grown = []
    for k, centre in enumerate(centres):
        turn = Rotation.random(rng=rng)
        shift = rng.uniform(-1, 1, 3)
        places = turn.apply(grain.positions_A - grain.cell_A / 2 + shift) + centre
        own_image = k * len(images) + len(images) // 2
        grown.append(places[nearest.query(places)[1] == own_image])
    positions = np.mod(np.concatenate(grown), edge_A)
    near = KDTree(positions, boxsize=edge_A).query_pairs(METAL.too_near * metal.eam.r_A)
    positions = np.delete(positions, sorted({max(pair) for pair in near}), axis=0)
    types = np.ones(len(positions), int)
    return Atoms(metal.elements, types, positions, np.full(3, edge_A))


def _segments() -> list[dict[str, Any]]:
    """Anneal, cooling and rest, as `run_segments` takes them."""
    steps = round(1000 * METAL.anneal_ps / METAL.timestep_fs)
    stages = [
        (METAL.anneal_K, METAL.anneal_K, steps),
        (METAL.anneal_K, METAL.final_K, steps),
        (METAL.final_K, METAL.final_K, steps // 3),
    ]
    segments = []
    for start, end, count in stages:
        segments.append({"ensemble": "npt", "from": start, "to": end, "steps": count})
    return segments


def _wide_enough(metal: Metal, edge_A: float, seed: int) -> Atoms:
    """Grains in a cube whose atoms fill one of `edge_A` once they are dense."""
    assert metal.below_films.grain_nm is not None  # of a Material
    grain_A = 10 * metal.below_films.grain_nm
    volume_A3 = 1e3 / (metal.atoms_per_nm3 * METAL.annealed_density)
    start_A = edge_A
    atoms = polycrystal(metal, edge_A, grain_A, seed)
    for _ in range(METAL.widenings):
        start_A *= edge_A / (len(atoms) * volume_A3) ** (1 / 3)
        atoms = polycrystal(metal, start_A, grain_A, seed)
    return atoms
