"""Asperities (eq. 6 of Kim et al. 2013) cut from a tiling of a glass cell."""

import numpy as np

from atomistic.lammps import Atoms

TOP_ATOMS = 8  # the highest atoms, whose height is that of the top


def profile(x: np.ndarray, y: np.ndarray, wavelength: float, amplitude: float) -> np.ndarray:
    """Height Z = min[A sin(2πx/λ), A sin(2πy/λ)] (eq. 6), unit of `amplitude`; peak (λ/4, λ/4)."""
    k = 2 * np.pi / wavelength
    return amplitude * np.minimum(np.sin(k * x), np.sin(k * y))


def cut_asperity(glass: Atoms, tiles: int, amplitude_A: float, base_A: float, seed: int) -> Atoms:
    """Cut an asperity out of `tiles` x `tiles` glass cells.

    The cut is placed at random (by `seed`) in the tiling, so that runs from one glass differ; a
    thicker base adds atoms below and leaves those of the asperity.  Surplus atoms of the cut are
    removed at the rigid bottom, where it does not matter: the sample stays neutral.

    Returns
    -------
    Atoms with the bottom at z = 0 and the zero of `profile` at z = base_A.
    """
    wavelength = tiles * glass.cell_A[0]
    below, above = (int(np.ceil(height / glass.cell_A[2])) for height in (base_A, amplitude_A))
    rng = np.random.default_rng(np.random.SeedSequence([seed, 3]))
    shifted = np.mod(glass.positions_A + rng.uniform(0, 1, 3) * glass.cell_A, glass.cell_A)
    repeats = (np.arange(tiles), np.arange(tiles), np.arange(-below, above))
    offsets = np.stack(np.meshgrid(*repeats, indexing="ij"), axis=-1)
    offsets = offsets.reshape(-1, 3)
    positions = (shifted[None] + (offsets * glass.cell_A)[:, None]).reshape(-1, 3)
    positions[:, 2] += base_A
    types = np.tile(glass.types, len(offsets))
    top = base_A + profile(positions[:, 0], positions[:, 1], wavelength, amplitude_A)
    inside = (positions[:, 2] >= 0) & (positions[:, 2] < top)
    cell = np.array([wavelength, wavelength, base_A + amplitude_A + 15.0])
    cut = Atoms(glass.elements, types[inside], positions[inside], cell)
    return neutralise(cut, formula_of(glass))


def formula_of(glass: Atoms) -> np.ndarray:
    """Atoms of each type per formula unit."""
    counts = np.bincount(glass.types, minlength=len(glass.elements) + 1)[1:]
    return counts // np.gcd.reduce(counts)


def neutralise(atoms: Atoms, formula: np.ndarray) -> Atoms:
    """Remove the lowest atoms of each species that is in surplus of whole formula units.

    Parameters
    ----------
    formula : atoms of each type per unit; 0: of a metal, which is not in any.
    """
    counts = np.bincount(atoms.types, minlength=len(formula) + 1)[1:]
    ions = formula > 0
    units = int(np.min(counts[ions] // formula[ions], initial=len(atoms)))
    keep = np.ones(len(atoms), dtype=bool)
    for kind, surplus in enumerate(np.where(ions, counts - units * formula, 0), 1):
        of_kind = np.flatnonzero(atoms.types == kind)
        lowest = of_kind[np.argsort(atoms.positions_A[of_kind, 2], kind="stable")[:surplus]]
        keep[lowest] = False
    return atoms.take(keep)


def remove_strays(atoms: Atoms, formula: np.ndarray) -> Atoms:
    """Remove atoms over 2.5 Å above the eighth-highest, neutrally: they are no surface."""
    height = atoms.positions_A[:, 2]
    eighth = float(np.partition(height, -TOP_ATOMS)[-TOP_ATOMS])
    return neutralise(atoms.take(height <= eighth + 2.5), formula)
