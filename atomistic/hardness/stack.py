"""A film of oxide glass on a metal: its force field, how it is laid and welded, and what it must look like.

Nobody published how atoms of the two potentials act on each other. The file of the metal states an assumption
(`film_base`): a Morse bond with oxygen and a short-range repulsion of the cation. Target `accuracy` varies its depth.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from itertools import combinations_with_replacement
from typing import Any

import numpy as np

from atomistic.errors import InputError
from atomistic.hardness.asperity import cut_asperity, formula_of, neutralise, profile
from atomistic.hardness.metal import METAL_FILE, NEIGHBOURS, Metal
from atomistic.lammps import Atoms
from atomistic.materials import Material
from atomistic.potentials import Morse, Potential, Repelled, pair_table

GAP_A = 1.6  # between the surfaces that are laid on each other
COLUMN_A = 4.0  # of the map of gaps
LEAST_FILM_NM = 0.3  # one layer of tetrahedra
METAL_TYPE = 1
SLIP_DEPTH_A = 6.0  # of the metal below the contact whose way is compared with that of the film


@dataclass(frozen=True)
class Stack:
    """Oxide on metal, as a force field: type 1 is the metal, the types of the oxide follow.

    Attributes
    ----------
    bond_factor : on the depth of the bonds between both.
    """

    oxide: Potential
    metal: Metal
    bond_factor: float = 1.0

    @property
    def species(self) -> Mapping[str, Any]:
        """What has the mass of each element."""
        return {**self.oxide.species, **self.metal.species}

    def files(
        self,
        elements: tuple[str, ...],
        energy_scale: float,
        repelled: Repelled | None = None,
    ) -> dict[str, str]:
        """What LAMMPS needs, as `Potential.files`; the scale is on the oxide and its bonds, the metal keeps its own.

        Raises
        ------
        InputError : an ion without cross terms to the metal.
        """
        _, *ions = elements
        above, of_above = repelled or (self.oxide, ())
        base, end = self.metal.below_films, self.oxide.cutoff_A
        check_ions(self.metal.material, ions)

        def pair(i: int, j: int) -> str:
            (below, first), (other, second) = types[i - 1], types[j - 1]
            if below != other:
                return f"table contact {end}"
            if below == "table" and i == METAL_TYPE:
                return f"cross {second if second in base.bonds else 'contact'} {end}"
            order, within = (ions, self.oxide) if below == "table" else (list(of_above), above)
            first, second = sorted((first, second), key=order.index)
            return f"{below} {first}_{second} {within.cutoff_A}"

        types = [("table", element) for element in elements] + [("table_above", element) for element in of_above]
        nothing = " ".join(["NULL"] * (len(types) - 1))
        lines = [
            "pair_style hybrid table linear 4000 eam/alloy",
            f"pair_coeff * * eam/alloy {METAL_FILE} {self.metal.element} {nothing}",
        ]
        for i, j in combinations_with_replacement(range(1, len(types) + 1), 2):
            if j > METAL_TYPE:
                lines.append(f"pair_coeff {i} {j} table {pair(i, j)}")
        files = {
            METAL_FILE: self.metal.setfl(),
            "table": self.oxide.table(tuple(dict.fromkeys(ions)), energy_scale),
            "cross": self._cross(energy_scale),
            "pairs": "\n".join([*lines, *NEIGHBOURS]) + "\n",
        }
        return files | ({"table_above": above.table(tuple(dict.fromkeys(of_above)), energy_scale)} if of_above else {})

    def _cross(self, energy_scale: float) -> str:
        """Table of the metal with each ion that it binds, and of the repulsion of the others."""
        sections = {ion: partial(self.bond, ion) for ion in self.metal.below_films.bonds}
        return pair_table("metal with the ions of a film", sections, self.oxide.cutoff_A, energy_scale)

    def bond(self, ion: str, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Energy (eV) and force (eV/Å) of the metal and an ion, shifted so that both vanish at the cut-off."""
        base, end = self.metal.below_films, np.array([self.oxide.cutoff_A])
        given = base.bonds[ion].model_dump() | {"D_eV": self.bond_factor * base.bonds[ion].D_eV}
        morse = Morse(term="morse", **given, source=base.source, confidence="low")
        (energy, slope), (energy_end, slope_end) = morse.energy_and_slope(r), morse.energy_and_slope(end)
        return energy - energy_end - slope_end * (r - end), slope_end - slope


def check_ions(metal: Material, ions: Iterable[str]) -> None:
    """Refuse a film with an ion of which the metal's file does not say how it acts on the metal.

    Raises
    ------
    InputError : of that ion.
    """
    base = metal.part("film_base")
    known = (*base.bonds, *base.repelled)
    if foreign := [ion for ion in ions if ion not in known]:
        raise InputError(
            f"material {metal.name}: film_base has no cross terms with {foreign[0]}, so that no film with it lies on "
            f"the metal; known are those with {' and '.join(known)}"
        )


def check_film(film_nm: float, widest_nm: float) -> None:
    """Refuse a film that is no layer, or so thick that no contact of its asperity feels the metal.

    Parameters
    ----------
    widest_nm : largest contact length of the asperity that is judged.

    Raises
    ------
    InputError : of those two.
    """
    if not LEAST_FILM_NM <= film_nm <= widest_nm:
        raise InputError(
            f"film_nm = {film_nm:g}: on an asperity whose widest judged contact is {widest_nm:.1f} nm, accepted are "
            f"{LEAST_FILM_NM:g} (one layer) to {widest_nm:.1f} nm, beyond which no contact feels the metal; or take "
            "more tiles"
        )


def lay(metal: Atoms, glass: Atoms, tiles: int, amplitude_A: float, film_A: float, base_A: float, seed: int) -> Atoms:
    """An asperity of metal under a film of glass of the same shape, not yet welded.

    Parameters
    ----------
    metal, glass : cells of the metal (one wavelength wide) and of the glass (`tiles` to the wavelength).
    """
    below = cut_asperity(metal, 1, amplitude_A, base_A, seed)
    film = cut_asperity(glass, tiles, amplitude_A, base_A + GAP_A + film_A, seed)
    x, y, z = film.positions_A.T
    floor = base_A + GAP_A + profile(x, y, float(film.cell_A[0]), amplitude_A)
    film = neutralise(film.take(z > floor), formula_of(glass))
    return Atoms(
        (*metal.elements, *film.elements),
        np.concatenate([below.types, film.types + len(metal.elements)]),
        np.concatenate([below.positions_A, film.positions_A]),
        film.cell_A,
    )


def film_properties(start: np.ndarray, end: np.ndarray, wavelength_A: float) -> dict[str, float]:
    """How the film lies on its metal before the closing, and how far it has slid over it at the end.

    Parameters
    ----------
    start, end : rows (type, x, y, z) of the same atoms, relaxed without their counterface; Å.

    Returns
    -------
    covered_share, gap_95_A (95 % quantile over columns of atoms), slid_A.
    """
    number = max(1, int(wavelength_A // COLUMN_A))
    places = (np.mod(start[:, 1:3] / wavelength_A, 1) * number).astype(int)
    column = places[:, 0] + number * places[:, 1]
    z, film = start[:, 3], start[:, 0] > METAL_TYPE
    low, top = np.full(number**2, np.inf), np.full(number**2, -np.inf)
    np.minimum.at(low, column[film], z[film])
    np.maximum.at(top, column[~film], z[~film])
    both = np.isfinite(low) & np.isfinite(top)
    moved = end[:, 1:3] - start[:, 1:3]
    moved -= wavelength_A * np.round(moved / wavelength_A)
    near = np.hypot(*(start[:, 1:3] - wavelength_A / 4).T) < wavelength_A / 4
    below = near & ~film & (z > z[near & ~film].max() - SLIP_DEPTH_A)
    slid = np.median(moved[near & film], axis=0) - np.median(moved[below], axis=0)
    return {
        "covered_share": float(np.mean(np.isfinite(low))),
        "gap_95_A": float(np.quantile((low - top)[both], 0.95)),
        "slid_A": float(np.hypot(*slid)),
    }


def lifted(body: Atoms, height_A: float) -> Atoms:
    """The stack with its film lifted off by a height: for checks."""
    shift = np.where(body.types > METAL_TYPE, height_A, 0.0)[:, None] * [0, 0, 1]
    return replace(body, positions_A=body.positions_A + shift, cell_A=body.cell_A + np.array([0, 0, height_A]))
