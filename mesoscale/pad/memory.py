"""The pressure of a pad as a function of separation and of the deepest closing."""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import ndtri

from mesoscale.contact.attraction import wall_offset_nm
from mesoscale.errors import NotComputed
from mesoscale.inputs.contact import ContactInputs
from mesoscale.pad.curves import PadCells
from mesoscale.pad.numerics import PAD
from mesoscale.settings import ContactSettings

Array = NDArray[np.float64]

FLOOR = 1e-11
"""A repulsion of this part of the largest, 0.1 mPa of 10 MPa, counts as none: it keeps logarithms
finite beyond the last contact."""


@dataclass(frozen=True)
class Flats:
    """What a pad is from far away: two flats.

    Attributes
    ----------
    hamaker : Hamaker constant (1e-18 J).
    offset_nm : distance of the walls less the separation: D0 of the law `offset`, else 0.
    """

    hamaker: float
    offset_nm: float

    def pull_GPa(self, separation_nm: ArrayLike) -> Array:
        """Attraction (positive), A_H / (6 pi s^3) with s the distance of the walls; any shape."""
        walls = np.maximum(np.asarray(separation_nm, float), 1.0) + self.offset_nm
        return self.hamaker / (6.0 * np.pi * walls**3)

    def energy_J_m2(self, separation_nm: ArrayLike) -> Array:
        """Work per area of this attraction from a separation to infinity, A_H / (12 pi s^2); any
        shape.
        """
        walls = np.maximum(np.asarray(separation_nm, float), 1.0) + self.offset_nm
        return self.hamaker / (12.0 * np.pi * walls**2)


def flats_of(inputs: ContactInputs, contact: ContactSettings) -> Flats:
    """The flats of a contact."""
    return Flats(inputs.hamaker, wall_offset_nm(contact))


@dataclass(frozen=True)
class PadLaw:
    """Mean pressure of a pad: one closing curve, and an opening curve for each depth.

    Between depths, repulsion and attraction are interpolated in logarithm at equal distance from
    the depth: an exponential repulsion, which rough contacts come near to, is interpolated exactly.

    Attributes
    ----------
    separation_nm : from near to far, shape (n,).
    closing : repulsive and attractive pressure (GPa, attraction negative), shape (2, n).
    depth_nm : separations from which the pad was opened, rising, shape (k,).
    opening : as `closing`, from each depth, shape (k, 2, n); NaN below the depth.
    flats : for separations beyond the table.
    """

    separation_nm: Array
    closing: Array
    depth_nm: Array
    opening: Array
    flats: Flats

    @property
    def floor_GPa(self) -> float:
        """Pressure that counts as none; positive also where nothing repels, as in cells of a pad
        that others carry.
        """
        return max(FLOOR * float(self.closing[0].max()), float(np.finfo(float).tiny))

    def closing_GPa(self, separation_nm: ArrayLike) -> Array:
        """Net pressure while closing (GPa, positive: pushed apart), any shape.

        Raises
        ------
        NotComputed : a separation below the deepest that was computed.
        """
        s = np.asarray(separation_nm, float)
        self._check(s)
        return self._extended(s, np.sum(rows_at(s, self.separation_nm, self.closing), axis=0))

    def opening_GPa(self, separation_nm: ArrayLike, deepest_nm: float) -> Array:
        """Net pressure while opening from `deepest_nm` (GPa), any shape; separations below it count
        as it.

        Raises
        ------
        NotComputed : a depth that was not computed; the message has the range.
        """
        low, high = float(self.depth_nm[0]), float(self.depth_nm[-1])
        if not low <= deepest_nm <= high:
            raise NotComputed(
                f"deepest closing {deepest_nm:.4g} nm: the pad was computed for {low:.4g} .."
                f" {high:.4g} nm ({self.closing_GPa(high) * 1e3:.3g} .."
                f" {self.closing_GPa(low) * 1e3:.3g} MPa)"
            )
        s = np.maximum(np.asarray(separation_nm, float), deepest_nm)
        return self._extended(s, self.opened(s - deepest_nm, np.array([deepest_nm]))[0].sum(axis=0))

    def opened(self, risen_nm: Array, deepest_nm: Array) -> Array:
        """Repulsive and attractive pressure (GPa) that far above depths in the range, while
        opening.

        Of the shape (depths, 2) + that of the rises.
        """
        upper = np.clip(
            np.searchsorted(self.depth_nm, deepest_nm), min(1, self.depth_nm.size - 1), None
        )
        lower = np.maximum(upper - 1, 0)
        apart = self.depth_nm[upper] - self.depth_nm[lower]  # 0: a pad of one depth
        share = np.divide(
            deepest_nm - self.depth_nm[lower], apart, out=np.zeros(upper.size), where=apart > 0
        )
        curves = {
            number: rows_at(self.depth_nm[number] + risen_nm, *self._logarithms[number])
            for number in {*upper.tolist(), *lower.tolist()}
        }
        shallow, deep = (
            np.array([curves[number] for number in of]) for of in (upper.tolist(), lower.tolist())
        )
        share = share.reshape(-1, *[1] * (deep.ndim - 1))
        rows = np.exp((1.0 - share) * deep + share * shallow)
        rows[:, 0][rows[:, 0] <= 2.0 * self.floor_GPa] = 0.0
        rows[:, 1] *= -1.0
        return rows

    @cached_property
    def _logarithms(self) -> list[tuple[Array, Array]]:
        """Separations, and logarithms of repulsion and attraction there, while opening from each
        depth.
        """
        ways = [np.isfinite(opening[0]) for opening in self.opening]
        return [
            (
                self.separation_nm[way],
                np.log(np.maximum(opening[:, way] * [[1.0], [-1.0]], self.floor_GPa)),
            )
            for way, opening in zip(ways, self.opening, strict=True)
        ]

    def _check(self, separation_nm: Array) -> None:
        if (separation_nm < self.separation_nm[0]).any():
            raise NotComputed(
                f"separation {separation_nm.min():.4g} nm: the pad was closed to"
                f" {self.separation_nm[0]:.4g} nm ({self.closing[:, 0].sum() * 1e3:.3g} MPa)"
            )

    def _extended(self, separation_nm: Array, pressure: Array) -> Array:
        """Beyond the table, two flats."""
        far = separation_nm > self.separation_nm[-1]
        return np.where(far, -self.flats.pull_GPa(separation_nm), pressure)


def deepened(law: PadLaw, times: float = 2.0) -> PadLaw:
    """The pad continued below its deepest closing, until the repulsion has grown so many times.

    Closing goes on as the exponential of its last e-fold, repulsion and attraction apart. An
    opening from there is that from the deepest depth, in proportion to where it starts."""
    s, ends = law.separation_nm, law.closing[:, 0]
    last = int(np.argmax(law.closing[0] < ends[0] / np.e)) or s.size - 1
    slopes = [
        np.log(max(row[0] / row[last], 1.0)) / (s[last] - s[0]) if row[last] else 0.0
        for row in law.closing
    ]
    if slopes[0] <= 0.0:
        raise NotComputed(f"separation {s[0]:.4g} nm: the repulsion of the pad does not grow there")
    reach = np.log(times) / slopes[0]
    if reach >= s[0]:
        raise NotComputed(
            f"separation {s[0]:.4g} nm: the pad is closed to its mean plane before its repulsion"
            " doubles"
        )
    deeper = np.linspace(s[0] - reach, s[0], PAD.deepened + 1)[:-1]
    growth = np.exp(np.outer(slopes, s[0] - deeper))
    start = int(np.flatnonzero(np.isfinite(law.opening[0, 0]))[0])
    opening = np.full((len(law.opening) + 1, 2, PAD.deepened + s.size), np.nan)
    opening[1:, :, PAD.deepened :] = law.opening
    at = np.concatenate([deeper, s])
    risen = np.minimum(at - at[0] + s[start], s[-1])
    opening[0] = rows_at(risen, s[start:], law.opening[0][:, start:]) * growth[:, :1]
    closing = np.hstack([ends[:, None] * growth, law.closing])
    return PadLaw(at, closing, np.concatenate([at[:1], law.depth_nm]), opening, law.flats)


def attracting(law: PadLaw, times: float) -> PadLaw:
    """The pad with `times` its attraction."""
    scale = np.array([[1.0], [times]])
    flats = replace(law.flats, hamaker=times * law.flats.hamaker)
    return replace(law, closing=scale * law.closing, opening=scale * law.opening, flats=flats)


def rows_at(wanted: Array | float, known: Array, rows: Array) -> Array:
    """Rows, given at `known`, at other places, the ends held; shape (rows,) + that of `wanted`."""
    return np.stack([np.interp(wanted, known, row) for row in rows])


def law_of(cells: PadCells, flats: Flats) -> PadLaw:
    """The law of a pad from its cells.

    A pad has 10^4 to 10^5 cells, and they touch first at all separations. The wells of a dozen
    stand apart, so that their mean is too deep. So each cell stands for others that touch first
    nearer or farther out, and whose curves are its own, shifted. The shifts are those of a smoothed
    bootstrap: normal, of Silverman's width, with all cells drawn together so that the variance of
    first contacts stays (Silverman, Density Estimation, 1986, eq. 3.28, sec. 6.4.1). Places of
    another RMS height shift in proportion to it."""
    separation, depth = cells.grid.separation_nm[::-1], cells.grid.depth_nm[::-1]
    laws = [
        PadLaw(separation, closing[:, ::-1], depth, opening[::-1, :, ::-1], flats)
        for closing, opening in zip(cells.closing, cells.opening, strict=True)
    ]
    closing, opening = np.zeros((2, separation.size)), np.zeros((depth.size, 2, separation.size))
    shifts_nm = _shifts_nm(cells)
    for law, weight, of_cell in zip(
        laws, cells.weight / shifts_nm.shape[1], shifts_nm, strict=True
    ):
        closing += weight * sum(_closing(law, separation - shift) for shift in of_cell)
        for number, deepest in enumerate(depth):
            way = separation >= deepest
            opening[number][:, way] += weight * _opened(
                law, separation[way] - deepest, deepest - of_cell
            ).sum(axis=0)
            opening[number][:, ~way] = np.nan
    return PadLaw(separation, closing, depth, opening, flats)


def _shifts_nm(cells: PadCells) -> Array:
    """How much farther out than it the cells touch first for which each cell stands, shape (cells,
    shifts).
    """
    first, count = cells.first_contact_nm / cells.rms_ratio, cells.count
    apart = first - cells.weight @ first
    deviation = math.sqrt(cells.weight @ apart**2 * count / max(count - 1, 1))
    if not deviation > 0.0:
        return np.zeros((count, 1))
    width = PAD.kernel * count**-0.2
    drawn = (
        math.sqrt((1.0 - width**2) * count / (count - 1)) - 1.0
    )  # of the deviations from the mean
    normal = ndtri((np.arange(PAD.shifts) + 0.5) / PAD.shifts)
    kernel = width * deviation * normal / normal.std()
    return cells.rms_ratio[:, None] * (drawn * apart[:, None] + kernel)


def _opened(law: PadLaw, risen_nm: Array, deepest_nm: Array) -> Array:
    """As `PadLaw.opened` from any depths, in proportion to where closing ended; the nearest known
    depth counts.

    The first rise is 0.
    """
    rows = law.opened(risen_nm, np.clip(deepest_nm, law.depth_nm[0], law.depth_nm[-1]))
    start, ended = rows[:, :, 0], _closing(law, deepest_nm).T
    return rows * np.divide(ended, start, out=np.ones_like(start), where=start != 0.0)[:, :, None]


def _closing(law: PadLaw, separation_nm: Array) -> Array:
    """Repulsive and attractive pressure (GPa) while closing; below the table in proportion to its
    last step.
    """
    nearest, farthest = law.separation_nm[[0, -1]]
    rows = rows_at(separation_nm, law.separation_nm, law.closing)
    slope = (law.closing[:, 1] - law.closing[:, 0]) / (law.separation_nm[1] - nearest)
    rows += np.minimum(separation_nm - nearest, 0.0) * slope[:, None]
    return np.where(
        separation_nm > farthest, [np.zeros_like(rows[0]), -law.flats.pull_GPa(separation_nm)], rows
    )


def curve_rows(cells: PadCells, law: PadLaw) -> list[dict[str, Any]]:
    """Rows of pad/curves.csv: the law of a pad, closing and opening from each depth, with its error
    by the cells.
    """
    rows = _branch_rows(cells, law.closing, "closing", None, cells.closing)
    for k, depth in enumerate(cells.grid.depth_nm):
        rows += _branch_rows(
            cells, law.opening[-1 - k], "opening", float(depth), cells.opening[:, k]
        )
    return rows


def _branch_rows(
    cells: PadCells, nearest_first: Array, branch: str, depth: float | None, pressures: Array
) -> list[dict[str, Any]]:
    mean = nearest_first[:, ::-1]
    # of a ratio of weighted sums (Cochran, Sampling Techniques, 1977, eq. 6.13)
    apart = (pressures - cells.mean(pressures)).sum(axis=1) * cells.weight[:, None]
    error = np.sqrt((apart**2).sum(axis=0) * cells.count / max(cells.count - 1, 1))
    return [
        {
            "branch": branch,
            "depth_nm": depth,
            "separation_nm": float(separation),
            "repulsive_MPa": float(mean[0, place] * 1e3),
            "attractive_MPa": float(mean[1, place] * 1e3),
            "net_kPa": float(mean[:, place].sum() * 1e6),
            "standard_error_kPa": float(error[place] * 1e6),
        }
        for place, separation in enumerate(cells.grid.separation_nm)
        if np.isfinite(mean[0, place])
    ]
