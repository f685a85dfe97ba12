"""A film of oxide glass on another body: force field, how it is laid, how it must look.

Nobody published how atoms of the two potentials act on each other. The file of the base states an
assumption (`film_base`): Morse bonds of some pairs and a short-range repulsion of the others.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np

from asperity.guards.errors import InputError
from atomistic.hardness.asperity import cut_asperity, formula_of, neutralise, profile
from atomistic.hardness.film_base import NEIGHBOURS, Base
from atomistic.hardness.metal import Metal
from atomistic.hardness.network import Network
from atomistic.lammps import Atoms
from atomistic.materials import Material
from atomistic.potentials import Morse, Potential, pair_table

GAP_A = 1.6  # between the surfaces that are laid on each other


@dataclass(frozen=True)
class Stack:
    """Oxide on a base, as a force field: the base's types come first, then the oxide's."""

    oxide: Potential
    base: Base

    @property
    def masses_u(self) -> Mapping[str, float]:
        """Mass of each element."""
        return {**self.oxide.masses_u, **self.base.masses_u}

    def files(self, elements: tuple[str, ...], energy_scale: float) -> dict[str, str]:
        """What LAMMPS needs, as `Potential.files`; the scale is on the oxide and its bonds.

        Raises
        ------
        InputError : an ion without cross terms to the base.
        """
        below = len(self.base.elements)
        end = self.oxide.cutoff_A
        ions = elements[below:]
        check_ions(self.base.material, ions)
        lines = [
            f"pair_style hybrid/overlay table linear 4000 {' '.join(self.base.styles)}",
            *self.base.commands(len(ions)),
        ]
        for i, first in enumerate(elements, 1):
            for j, second in enumerate(elements[i - 1 :], i):
                if i > below:
                    lines.append(f"pair_coeff {i} {j} table table {first}_{second} {end}")
                elif j > below:
                    name = f"{first}-{second}"
                    section = name if name in self.base.below_films.bonds else "contact"
                    lines.append(f"pair_coeff {i} {j} table cross {section} {end}")
        return {
            **self.base.tables(),
            "table": self.oxide.table(ions, energy_scale),
            "cross": self._cross(energy_scale),
            "pairs": "\n".join([*lines, *NEIGHBOURS]) + "\n",
        }

    def _cross(self, energy_scale: float) -> str:
        """Table of the base with each ion that it binds, and of the repulsion of the others."""
        sections = {pair: partial(self.bond, pair) for pair in self.base.below_films.bonds}
        return pair_table(
            "base with the ions of a film", sections, self.oxide.cutoff_A, energy_scale
        )

    def bond(self, pair: str, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Energy (eV) and force (eV/Å) of a base atom and an ion, zero at the cut-off."""
        below = self.base.below_films
        end = np.array([self.oxide.cutoff_A])
        parameters = below.bonds[pair].model_dump()
        morse = Morse(term="morse", **parameters, source=below.source, confidence="low")
        (energy, slope) = morse.energy_and_slope(r)
        (energy_end, slope_end) = morse.energy_and_slope(end)
        return energy - energy_end - slope_end * (r - end), slope_end - slope


def base_of(material: Material) -> Base:
    """The body below a film, by its material's file: a metal, or a glass of covalent bonds.

    Raises
    ------
    InputError : nothing is known of films on the material.
    """
    material.part("film_base")
    if material.eam is not None:
        return Metal(material)
    return Network(material)


def check_ions(base: Material, ions: Iterable[str]) -> None:
    """Refuse a film with an ion whose action on the base's atoms its file does not state.

    Raises
    ------
    InputError : of that ion.
    """
    below = base.part("film_base")
    known = (*below.bonds, *below.repelled)
    missing = [
        f"{element}-{ion}"
        for ion in ions
        for element in base.formula
        if f"{element}-{ion}" not in known
    ]
    if missing:
        raise InputError(
            f"material {base.name}: film_base has no cross terms {missing[0]}, so that no film with"
            f" that ion lies on it; known are {' and '.join(known)}"
        )


def check_film(film_nm: float, widest_nm: float) -> None:
    """Refuse a film that is no layer, or so thick that no contact of its asperity feels the base.

    Parameters
    ----------
    widest_nm : largest contact length of the asperity that is judged.

    Raises
    ------
    InputError : of those two.
    """
    least_nm = 0.3  # one layer of tetrahedra
    if not least_nm <= film_nm <= widest_nm:
        raise InputError(
            f"film_nm = {film_nm:g}: on an asperity whose widest judged contact is {widest_nm:.1f}"
            f" nm, accepted are {least_nm:g} (one layer) to {widest_nm:.1f} nm, beyond which no"
            " contact feels the base; or take more tiles"
        )


def lay(
    base: Atoms,
    glass: Atoms,
    tiles: int,
    amplitude_A: float,
    film_A: float,
    base_A: float,
    seed: int,
) -> Atoms:
    """An asperity of a base under a film of glass of the same shape, not yet welded.

    Parameters
    ----------
    base, glass : cells of the base (one wavelength wide, or as many to it as those of the glass)
        and of the glass (`tiles` to the wavelength).
    """
    below = cut_base(base, glass, tiles, amplitude_A, base_A, seed)
    film = cut_asperity(glass, tiles, amplitude_A, base_A + GAP_A + film_A, seed)
    x, y, z = film.positions_A.T
    floor = base_A + GAP_A + profile(x, y, float(film.cell_A[0]), amplitude_A)
    film = neutralise(film.take(z > floor), formula_of(glass))
    types = np.concatenate([below.types, film.types + len(base.elements)])
    positions_A = np.concatenate([below.positions_A, film.positions_A])
    return Atoms((*base.elements, *film.elements), types, positions_A, film.cell_A)


def cut_base(
    base: Atoms, glass: Atoms, tiles: int, amplitude_A: float, base_A: float, seed: int
) -> Atoms:
    """An asperity of the base by itself, as wide as so many cells of the glass."""
    of_base = round(tiles * float(glass.cell_A[0] / base.cell_A[0]))
    return cut_asperity(base, of_base, amplitude_A, base_A, seed)


def film_properties(
    start: np.ndarray, end: np.ndarray, wavelength_A: float, below: int
) -> dict[str, float]:
    """How the film lies on its base before the closing, and how far it has slid over it at the end.

    Parameters
    ----------
    start, end : rows (type, x, y, z) of the same atoms, relaxed without their counterface; Å.
    below : the types of the base.

    Returns
    -------
    covered_share, gap_95_A (95 % quantile over columns of atoms), slid_A.
    """
    number = max(1, int(wavelength_A // 4.0))  # columns of 4 Å map the gaps
    places = (np.mod(start[:, 1:3] / wavelength_A, 1) * number).astype(int)
    column = places[:, 0] + number * places[:, 1]
    z = start[:, 3]
    film = start[:, 0] > below
    low = np.full(number**2, np.inf)
    top = np.full(number**2, -np.inf)
    np.minimum.at(low, column[film], z[film])
    np.maximum.at(top, column[~film], z[~film])
    both = np.isfinite(low) & np.isfinite(top)
    moved = end[:, 1:3] - start[:, 1:3]
    moved -= wavelength_A * np.round(moved / wavelength_A)
    near = np.hypot(*(start[:, 1:3] - wavelength_A / 4).T) < wavelength_A / 4
    # its way is compared with that of the film
    beneath = near & ~film & (z > z[near & ~film].max() - 6.0)
    film_moved = np.median(moved[near & film], axis=0)
    slid = film_moved - np.median(moved[beneath], axis=0)
    gaps = (low - top)[both]
    return {
        "covered_share": float(np.mean(np.isfinite(low))),
        "gap_95_A": float(np.quantile(gaps, 0.95)),
        "slid_A": float(np.hypot(*slid)),
    }
