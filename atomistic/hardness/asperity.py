"""Bodies cut from a tiling of a glass cell: asperities (eq. 6 of Kim et al. 2013), flats, and a pair."""

from dataclasses import replace

import numpy as np

from atomistic.lammps import Atoms

VACUUM_A = 15.0
STRAY_A = 2.5  # atoms this far above the eighth-highest one belong to no surface
TOP_ATOMS = 8
MEAN_HEIGHT = -4 / np.pi**2  # in amplitudes: of the smaller of two sines


def profile(x: np.ndarray, y: np.ndarray, wavelength: float, amplitude: float) -> np.ndarray:
    """Height Z = min[A sin(2πx/λ), A sin(2πy/λ)] (eq. 6), in the unit of `amplitude`; its peak is at (λ/4, λ/4)."""
    k = 2 * np.pi / wavelength
    return amplitude * np.minimum(np.sin(k * x), np.sin(k * y))


def cut_asperity(glass: Atoms, tiles: int, amplitude_A: float, base_A: float, seed: int) -> Atoms:
    """Cut an asperity out of `tiles` x `tiles` glass cells.

    The cut is placed at random (by `seed`) in the tiling, so that runs from one glass differ; a thicker base adds
    atoms below and leaves those of the asperity.  Surplus atoms of the cut are removed at the rigid bottom, where it
    does not matter: the sample stays neutral.

    Returns
    -------
    Atoms with the bottom at z = 0 and the zero of `profile` at z = base_A.
    """
    wavelength = tiles * glass.cell_A[0]
    below, above = (int(np.ceil(height / glass.cell_A[2])) for height in (base_A, amplitude_A))
    rng = np.random.default_rng(np.random.SeedSequence([seed, 3]))
    shifted = np.mod(glass.positions_A + rng.uniform(0, 1, 3) * glass.cell_A, glass.cell_A)
    repeats = (np.arange(tiles), np.arange(tiles), np.arange(-below, above))
    offsets = np.stack(np.meshgrid(*repeats, indexing="ij"), axis=-1).reshape(-1, 3)
    positions = (shifted[None] + (offsets * glass.cell_A)[:, None]).reshape(-1, 3)
    positions[:, 2] += base_A
    types = np.tile(glass.types, len(offsets))
    top = base_A + profile(positions[:, 0], positions[:, 1], wavelength, amplitude_A)
    inside = (positions[:, 2] >= 0) & (positions[:, 2] < top)
    cell = np.array([wavelength, wavelength, base_A + amplitude_A + VACUUM_A])
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
    """Remove atoms that stand alone above the surface, keeping the sample neutral."""
    height = atoms.positions_A[:, 2]
    return neutralise(atoms.take(height <= top_height(height) + STRAY_A), formula)


def top_height(height: np.ndarray) -> float:
    """Height of the eighth-highest atom."""
    return float(np.partition(height, -TOP_ATOMS)[-TOP_ATOMS])


def with_vacuum(atoms: Atoms, height_A: float) -> Atoms:
    """The same atoms in a cell of another height."""
    return replace(atoms, cell_A=np.array([*atoms.cell_A[:2], height_A]))


def facing(lower: Atoms, upper: Atoms, gap_A: float) -> tuple[Atoms, float]:
    """`upper` turned over and placed above `lower`, as one set of atoms with types of its own.

    The gap is that of the two highest atoms.

    Returns
    -------
    atoms : those of `lower` first; elements and types of `upper` follow those of `lower`.
    ceiling : height at which the (rigid) bottom of `upper` now lies, Å.
    """
    ceiling = float(np.max(lower.positions_A[:, 2]) + gap_A + np.max(upper.positions_A[:, 2]))
    turned = upper.positions_A * [1, 1, -1] + [0, 0, ceiling]
    positions = np.concatenate([lower.positions_A, turned])
    velocities = None
    if lower.velocities_A_ps is not None and upper.velocities_A_ps is not None:
        velocities = np.concatenate([lower.velocities_A_ps, upper.velocities_A_ps * [1, 1, -1]])
    types = np.concatenate([lower.types, upper.types + len(lower.elements)])
    cell = np.array([*lower.cell_A[:2], ceiling + VACUUM_A])
    return Atoms(lower.elements + upper.elements, types, positions, cell, velocities), ceiling
