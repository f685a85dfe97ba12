"""The adhesion well by the law and by the curve it was fitted to.

`LawFit.residual` is relative to the largest repulsion, beside which a misfit of the attraction cannot show. Release and
stiction hang on the well alone, so the attraction is judged here by itself.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.law.compact import Law, pressure

Array = NDArray[np.float64]

MOST_MISSED = 0.25
"""Relative distance of the law's well depth from the curve's beyond which the law misses it."""
MICRO = 1e6
"""GPa to kPa, and GPa nm, which is J/m^2, to uJ/m^2."""


@dataclass(frozen=True)
class Well:
    """The deepest net attraction of a branch.

    Attributes
    ----------
    depth_GPa : largest net attractive pressure, positive; times the area, the pull-off force.
    at_nm : separation where it is.
    energy_GPa_nm : work per area (1 GPa nm = 1 J/m^2) from the balance of both forces outward, positive.
    """

    depth_GPa: float
    at_nm: float
    energy_GPa_nm: float


def well_of(separation_nm: Array, net_GPa: Array) -> Well:
    """The well of a net pressure, shape (n,), at rising separations."""
    lowest = int(np.argmin(net_GPa))
    pushes = np.flatnonzero(net_GPa[: lowest + 1] > 0)
    start = int(pushes[-1]) + 1 if pushes.size else 0
    energy = -np.trapezoid(np.minimum(net_GPa[start:], 0.0), separation_nm[start:])
    return Well(max(-float(net_GPa[lowest]), 0.0), float(separation_nm[lowest]), float(energy))


def well_of_law(law: Law, low_nm: float, high_nm: float) -> Well:
    """The well of a law between two separations, its two kinks among the points."""
    at = np.linspace(low_nm, high_nm, 2000)  # 40 nm in steps of 0.02 nm, a hundredth of rho_a
    kinks = np.array([float(np.asarray(law.d_c_nm)), float(np.asarray(law.d_c_nm)) + law.rho_a_nm])
    at = np.unique(np.concatenate([at, kinks[(kinks > low_nm) & (kinks < high_nm)]]))
    attractive, repulsive = pressure(at, law)
    return well_of(at, attractive + repulsive)


def attraction_status(by_law: Well, by_curve: Well) -> str:
    """`ok`, `no_well`, or by how much the law misses the well of its curve."""
    if by_curve.depth_GPa <= 0:
        return "no_well"
    ratio = by_law.depth_GPa / by_curve.depth_GPa
    if abs(ratio - 1.0) <= MOST_MISSED:
        return "ok"
    return f"misses_well: {ratio:.3g} times the curve's"


def well_row(law: Law | None, curve: tuple[Array, Array, Array] | None) -> dict[str, Any]:
    """Row of law/wells.csv without run, seed and branch; empty where there is no curve or it gave no law.

    Parameters
    ----------
    law : fitted to the curve, None if that gave no numbers.
    curve : separation (nm, rising), repulsive and attractive pressure (GPa) of the branch, shapes (n,).
    """
    if curve is None:
        return {"attraction_status": "no_curve"}
    separation_nm, repulsive_GPa, attractive_GPa = curve
    by_curve = well_of(separation_nm, repulsive_GPa + attractive_GPa)
    row: dict[str, Any] = {
        "attraction_status": "no_law",
        "well_curve_kPa": by_curve.depth_GPa * MICRO,
        "well_curve_at_nm": by_curve.at_nm,
        "energy_curve_uJ_m2": by_curve.energy_GPa_nm * MICRO,
    }
    if law is not None:
        ours = well_of_law(law, float(separation_nm[0]), float(separation_nm[-1]))
        row |= {
            "attraction_residual": attraction_residual(law, separation_nm, attractive_GPa),
            "attraction_status": attraction_status(ours, by_curve),
            "well_law_kPa": ours.depth_GPa * MICRO,
            "well_law_at_nm": ours.at_nm,
            "energy_law_uJ_m2": ours.energy_GPa_nm * MICRO,
        }
    return row


def attraction_residual(law: Law, separation_nm: Array, attractive_GPa: Array) -> float:
    """Root mean square misfit of the attraction up to d_c + rho_a, over its largest value there (1)."""
    top = float(np.asarray(law.d_c_nm)) + law.rho_a_nm
    at = np.linspace(separation_nm[0], max(min(top, separation_nm[-1]), separation_nm[0]), 200)
    curve = np.interp(at, separation_nm, attractive_GPa)
    misfit = pressure(at, law)[0] - curve
    largest = float(np.abs(curve).max())
    return float(np.sqrt(np.mean(misfit**2))) / largest if largest > 0 else 0.0


def missed_wells(rows: Iterable[Mapping[str, str]]) -> tuple[int, int]:
    """Branches whose law misses the well of its curve, and branches with a law and a well."""
    known = [
        row["attraction_status"] for row in rows if row["attraction_status"] not in ("no_curve", "no_law", "no_well")
    ]
    return sum(status != "ok" for status in known), len(known)
