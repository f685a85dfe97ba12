"""The compact force-separation law (paper section 5, eqs 10-13).

With h0 the mean separation and <x> = max(x, 0), per unit area,

    attraction = -A_H / (6 pi d_s^3) - C_a <d_c + rho_a - h0>        (eq. 10) d_s = (h0^3 +
    alpha^3)^(1/3) for h0 > 0, else alpha              (eq. 12; the printed -alpha is a slip)
    repulsion = C_r [exp(<d_c - h0> / rho_r) - 1]                    (eq. 13)
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Law:
    """Parameters of the law; each a number or an array, all broadcasting with the separation.

    Attributes
    ----------
    d_c_nm : mean separation at initial contact (nm).
    C_a_GPa_nm : attraction per penetration (GPa/nm).
    C_r_GPa : repulsion prefactor (GPa).
    rho_r_nm : repulsion length (nm).
    hamaker : Hamaker constant (1e-18 J = nN nm).
    rho_a_nm : attraction length (nm), fixed by the paper.
    shield_nm : alpha of eq. 12 (nm), which the paper does not give: as long as rho_a. It acts where
        the attraction is that of C_a.
    """

    d_c_nm: ArrayLike
    C_a_GPa_nm: ArrayLike
    C_r_GPa: ArrayLike
    rho_r_nm: ArrayLike
    hamaker: ArrayLike
    rho_a_nm: float = 2.0
    shield_nm: float = 2.0


def pressure(separation_nm: ArrayLike, law: Law) -> tuple[Array, Array]:
    """Attraction and repulsion of the law per unit area (eqs 10-13).

    Parameters
    ----------
    separation_nm : mean separation h0 (nm), any shape that broadcasts with the law's parameters.

    Returns
    -------
    attractive_GPa, repulsive_GPa : attraction is negative.
    """
    h0 = np.asarray(separation_nm, float)
    d_c = np.asarray(law.d_c_nm, float)
    attractive = shielded_hamaker(h0, law.hamaker, law.shield_nm)
    attractive = attractive - np.asarray(law.C_a_GPa_nm) * np.maximum(d_c + law.rho_a_nm - h0, 0.0)
    approach = np.maximum(d_c - h0, 0.0)
    repulsive = np.asarray(law.C_r_GPa) * np.expm1(approach / np.asarray(law.rho_r_nm))
    return attractive, repulsive


def force(separation_nm: ArrayLike, law: Law, cell_area_nm2: float) -> tuple[Array, Array]:
    """Attractive (negative) and repulsive force in nN on `cell_area_nm2` (1 GPa nm^2 = 1 nN)."""
    attractive, repulsive = pressure(separation_nm, law)
    return attractive * cell_area_nm2, repulsive * cell_area_nm2


def shielded_hamaker(separation_nm: ArrayLike, hamaker: ArrayLike, shield_nm: float) -> Array:
    """Attraction of two flat half spaces per area (GPa), the distance shielded as in eq. 12."""
    h0 = np.maximum(np.asarray(separation_nm, float), 0.0)
    return -np.asarray(hamaker) / (6 * np.pi * (h0**3 + shield_nm**3))
