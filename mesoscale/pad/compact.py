"""A closed form for a pad that closes, opens and remembers how deep it was closed.

With s the separation, D the deepest closing so far, r = s - D and p_0 = 1 MPa,

    closing     p_c(s) = exp(-c0 - c1 s - c2 s^2)                      heights with a Gaussian tail
    opening     p_c(D) g,   g = exp(-(b0 + b1 D) r - b2 r^2)           elastic rebound, stiffer the less was pressed
    attraction  -A_H / (6 pi (s + offset)^3) - beta p_0 (p_c(D) / p_0)^m g^n (1 + lifted (1 - g)^3)

(while closing, D = s and g = 1). The near attraction of a rough contact is in proportion to its load, so m is near 1.
On opening it falls as the rim of what still touches, n near 1/2. Coupled asperities lift off together, and places that
were pressed flat, which do not attract while they touch, then do: `lifted` is 2 to 10 for them, and 0 for single ones.
Without it and the far attraction the well on opening is at g^(1-n) = n a, with a the attraction over the load at D; its
depth is a^2 p_c(D) / 4 for n = 1/2.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import least_squares

from mesoscale.errors import InputError
from mesoscale.law.wells import MOST_MISSED
from mesoscale.pad.memory import Flats, PadLaw

Array = NDArray[np.float64]

UNIT_GPa = 1e-3
"""p_0 of the attraction."""
CLOSING_FLOOR = 1e-4
"""Closing is fitted down to this share of its largest repulsion: beyond, few of the computed cells touch."""
OPENING_FLOOR = 1e-2
"""Opening is fitted down to this share of the repulsion at the depth."""
FEWEST = 8


@dataclass(frozen=True)
class CompactPad:
    """The closed form.

    Attributes
    ----------
    c0, c1_per_nm, c2_per_nm2 : closing, p_c in GPa.
    b0_per_nm, b1_per_nm2, b2_per_nm2 : opening.
    beta, m, n, lifted : attraction.
    hamaker, offset_nm : far attraction, of `Flats`.
    """

    c0: float
    c1_per_nm: float
    c2_per_nm2: float
    b0_per_nm: float
    b1_per_nm2: float
    b2_per_nm2: float
    beta: float
    m: float
    n: float
    lifted: float
    hamaker: float
    offset_nm: float

    @property
    def flats(self) -> Flats:
        """What the pad is from far away."""
        return Flats(self.hamaker, self.offset_nm)

    def log_load(self, separation_nm: ArrayLike) -> Array:
        """Logarithm of the repulsion while closing (GPa)."""
        s = np.asarray(separation_nm, float)
        return -self.c0 - self.c1_per_nm * s - self.c2_per_nm2 * s**2

    def decay(self, separation_nm: ArrayLike, deepest_nm: ArrayLike) -> Array:
        """Logarithm of what the repulsion has fallen by since the deepest closing."""
        deep = np.asarray(deepest_nm, float)
        risen = np.asarray(separation_nm, float) - deep
        return (self.b0_per_nm + self.b1_per_nm2 * deep) * risen + self.b2_per_nm2 * risen**2

    def closing_GPa(self, separation_nm: ArrayLike) -> tuple[Array, Array]:
        """Repulsion and attraction (negative) while closing."""
        s = np.asarray(separation_nm, float)
        return self.opening_GPa(s, s)

    def opening_GPa(self, separation_nm: ArrayLike, deepest_nm: ArrayLike) -> tuple[Array, Array]:
        """Repulsion and attraction (negative) at separations not below the deepest closing."""
        s, deep = np.asarray(separation_nm, float), np.asarray(deepest_nm, float)
        load, decay = np.exp(self.log_load(deep)), self.decay(s, deep)
        rim = self.beta * UNIT_GPa * (load / UNIT_GPa) ** self.m * np.exp(-self.n * decay)
        left = np.exp(-decay)
        return load * left, -self.flats.pull_GPa(s) - rim * lift(left, self.lifted)

    def well_kPa(self, deepest_nm: float) -> float:
        """Largest net attraction on opening from a depth (kPa)."""
        s = deepest_nm + np.linspace(0.0, 30.0, 3001)
        return max(-float(np.add(*self.opening_GPa(s, deepest_nm)).min()), 0.0) * 1e6


def lift(left: Array, lifted: float) -> Array:
    """Factor on the attraction of the rim, from the share of the load that is left on opening."""
    return 1.0 + lifted * np.maximum(1.0 - left, 0.0) ** 3


@dataclass(frozen=True)
class Residuals:
    """Root mean square misfits: of the logarithm for each part (1)."""

    closing: float
    opening: float
    attraction_closing: float
    attraction_opening: float


def fit_compact(law: PadLaw) -> tuple[CompactPad, Residuals]:
    """The closed form fitted to the curves of a pad, part by part by least squares of logarithms.

    Raises
    ------
    InputError : too few separations or depths in contact.
    """
    s, repulsive = law.separation_nm, law.closing[0]
    far = law.flats.pull_GPa(s)
    near = -law.closing[1] - far
    used = (repulsive > CLOSING_FLOOR * repulsive.max()) & (near > 0)
    if used.sum() < FEWEST or law.depth_nm.size < 3:
        raise InputError(
            f"pad: {int(used.sum())} separations in contact and {law.depth_nm.size} depths; accepted for a closed form "
            f"are at least {FEWEST} and 3; raise pad.cells or pad.grid.depths"
        )
    at = s[used]
    c, closing = _solve(np.stack([np.ones(at.size), at, at**2], axis=1), -np.log(repulsive[used]))
    load = np.exp(-c[0] - c[1] * at - c[2] * at**2)
    (log_beta, m), attraction = _solve(
        np.stack([np.ones(at.size), np.log(load / UNIT_GPa)], axis=1), np.log(near[used] / UNIT_GPa)
    )
    rows, decays, kept, fallen = [], [], [], []
    for depth, (pushes, pulls) in zip(law.depth_nm, law.opening, strict=True):
        above = np.isfinite(pushes)
        risen, share = s[above] - depth, pushes[above] / pushes[above][0]
        pull = -pulls[above] - far[above]
        use = (risen > 0) & (share > OPENING_FLOOR) & (pull > 0)
        rows.append(np.stack([risen, depth * risen, risen**2], axis=1)[use])
        decays.append(-np.log(share[use]))
        fallen.append(-np.log(pull[use] / pull[0]))
        kept.append(rows[-1])
    b, opening = _solve(np.concatenate(rows), np.concatenate(decays))
    decay = np.concatenate(kept) @ b
    fall = np.concatenate(fallen)
    # what lifts off never attracts the more the farther it is: neither number is negative
    opened = least_squares(
        lambda at: np.log(lift(np.exp(-decay), at[1])) - at[0] * decay + fall, (0.5, 1.0), bounds=(0.0, np.inf)
    )
    (n, lifted), attraction_opening = opened.x, float(np.sqrt(np.mean(opened.fun**2)))
    c0, c1, c2 = (float(value) for value in c)
    b0, b1, b2 = (float(value) for value in b)
    attracts = float(np.exp(log_beta)), float(m), float(n), float(lifted)
    fitted = CompactPad(c0, c1, c2, b0, b1, b2, *attracts, law.flats.hamaker, law.flats.offset_nm)
    return fitted, Residuals(closing, opening, attraction, attraction_opening)


def _solve(columns: Array, wanted: Array) -> tuple[Array, float]:
    """Least squares and its root mean square misfit."""
    best = np.asarray(np.linalg.lstsq(columns, wanted, rcond=None)[0], float)
    return best, float(np.sqrt(np.mean((columns @ best - wanted) ** 2)))


def compact_summary(law: PadLaw) -> dict[str, Any]:
    """Content of pad/compact.json: the closed form, its residuals, and its well beside the curves' for each depth.

    Curves that give no closed form leave the reason.
    """
    try:
        fitted, residuals = fit_compact(law)
    except InputError as error:
        return {"parameters": None, "status": str(error)}
    wells = wells_of(fitted, law)
    return {
        "parameters": asdict(fitted),
        "status": well_status(wells),
        "residuals": asdict(residuals),
        "wells": wells,
    }


def wells_of(fitted: CompactPad, law: PadLaw) -> list[dict[str, float]]:
    """The well on opening of the closed form beside that of the curves, for each depth."""
    return [
        {
            "depth_nm": float(depth),
            "closed_to_MPa": float(law.closing_GPa(depth)) * 1e3,
            "well_compact_kPa": fitted.well_kPa(float(depth)),
            "well_curve_kPa": max(-float(np.nanmin(branch.sum(axis=0))), 0.0) * 1e6,
        }
        for depth, branch in zip(law.depth_nm, law.opening, strict=True)
    ]


def well_status(wells: Sequence[Mapping[str, float]]) -> str:
    """`ok`, or at how many depths the closed form misses the well of the curves, and by how much."""
    ratios = [row["well_compact_kPa"] / row["well_curve_kPa"] for row in wells if row["well_curve_kPa"] > 0]
    missed = [ratio for ratio in ratios if abs(ratio - 1.0) > MOST_MISSED]
    if not missed:
        return "ok"
    return (
        f"misses_well: {min(missed):.2g} to {max(missed):.2g} times the curves' at {len(missed)} of {len(ratios)} "
        "depths; for release and sticking use the curves (pad/curves.h5)"
    )
