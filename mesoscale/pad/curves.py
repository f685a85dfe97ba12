"""The curves of a pad: its pressure as a function of separation and of the deepest closing."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mesoscale.errors import NotComputed

Array = NDArray[np.float64]
T = TypeVar("T")

FLOOR = 1e-11
"""A repulsion of this part of the largest, 0.1 mPa of 10 MPa, counts as none: it keeps logarithms
finite beyond the last contact."""
DOUBLINGS = 2
"""Times that the pressure to which a pad was computed is doubled at most by continuing its
curves."""
CONTINUED_POINTS = 20
"""Separations below the deepest closing of a pad that is continued."""


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


@dataclass(frozen=True)
class PadCurves:
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
        low = float(self.depth_nm[0])
        high = float(self.depth_nm[-1])
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
        first_upper = min(1, self.depth_nm.size - 1)
        upper = np.clip(np.searchsorted(self.depth_nm, deepest_nm), first_upper, None)
        lower = np.maximum(upper - 1, 0)
        above_nm = deepest_nm - self.depth_nm[lower]
        apart_nm = self.depth_nm[upper] - self.depth_nm[lower]  # 0: a pad of one depth
        share = np.divide(above_nm, apart_nm, out=np.zeros(upper.size), where=apart_nm > 0)
        curves = {
            number: rows_at(self.depth_nm[number] + risen_nm, *self._logarithms[number])
            for number in {*upper.tolist(), *lower.tolist()}
        }
        shallow = np.array([curves[number] for number in upper.tolist()])
        deep = np.array([curves[number] for number in lower.tolist()])
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
        logarithms = []
        for opening in self.opening:
            known = np.isfinite(opening[0])
            positive = opening[:, known] * [[1.0], [-1.0]]
            logarithm = np.log(np.maximum(positive, self.floor_GPa))
            logarithms.append((self.separation_nm[known], logarithm))
        return logarithms

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


def closing_alone(separation_nm: Array, net_GPa: Array) -> PadCurves:
    """The curves of a pad that was closed and not opened, from near to far; without flats."""
    closing = np.stack([np.maximum(net_GPa, 0.0), np.minimum(net_GPa, 0.0)])
    return PadCurves(separation_nm, closing, separation_nm[:1], closing[None], Flats(0.0, 0.0))


def on_deep_enough(pad: PadCurves, solve: Callable[[PadCurves], T]) -> tuple[T, PadCurves]:
    """What `solve` says of a pad that is continued as far as it asks for, and this pad.

    Raises
    ------
    NotComputed : it asks for more than `2 ** DOUBLINGS` times the pressure to which the pad was
        computed.
    """
    for _ in range(DOUBLINGS):
        try:
            return solve(pad), pad
        except NotComputed:
            pad = deepened(pad)
    return solve(pad), pad


def continued(pad: PadCurves) -> PadCurves:
    """The pad continued as far as that goes, `DOUBLINGS` times at most."""
    with suppress(NotComputed):  # it is closed nearly to its mean plane
        for _ in range(DOUBLINGS):
            pad = deepened(pad)
    return pad


def deepened(pad: PadCurves, times: float = 2.0) -> PadCurves:
    """The pad continued below its deepest closing, until the repulsion has grown so many times.

    Closing goes on as the exponential of its last e-fold, repulsion and attraction apart. An
    opening from there is that from the deepest depth, in proportion to where it starts.

    Raises
    ------
    NotComputed : its repulsion does not grow, or it reaches its mean plane before.
    """
    s = pad.separation_nm
    nearest = pad.closing[:, 0]
    last = int(np.argmax(pad.closing[0] < nearest[0] / np.e)) or s.size - 1
    slopes = [_slope(row, last, s[last] - s[0]) for row in pad.closing]
    if slopes[0] <= 0.0:
        raise NotComputed(f"separation {s[0]:.4g} nm: the repulsion of the pad does not grow there")
    reach_nm = np.log(times) / slopes[0]
    if reach_nm >= s[0]:
        raise NotComputed(
            f"separation {s[0]:.4g} nm: the pad is closed to its mean plane before its repulsion"
            " doubles"
        )
    deeper = np.linspace(s[0] - reach_nm, s[0], CONTINUED_POINTS + 1)[:-1]
    growth = np.exp(np.outer(slopes, s[0] - deeper))
    separation = np.concatenate([deeper, s])
    closing = np.hstack([nearest[:, None] * growth, pad.closing])
    start = int(np.flatnonzero(np.isfinite(pad.opening[0, 0]))[0])
    risen = np.minimum(separation - separation[0] + s[start], s[-1])
    opening = np.full((len(pad.opening) + 1, 2, separation.size), np.nan)
    opening[0] = rows_at(risen, s[start:], pad.opening[0][:, start:]) * growth[:, :1]
    opening[1:, :, CONTINUED_POINTS:] = pad.opening
    depth = np.concatenate([separation[:1], pad.depth_nm])
    return PadCurves(separation, closing, depth, opening, pad.flats)


def _slope(row: Array, last: int, length_nm: float) -> float:
    """Slope (1/nm) of the logarithm of a pressure from its first to another place."""
    if not row[last]:
        return 0.0
    return np.log(max(row[0] / row[last], 1.0)) / length_nm


def attracting(pad: PadCurves, times: float) -> PadCurves:
    """The pad with `times` its attraction."""
    scale = np.array([[1.0], [times]])
    flats = replace(pad.flats, hamaker=times * pad.flats.hamaker)
    return replace(pad, closing=scale * pad.closing, opening=scale * pad.opening, flats=flats)


def bonded(pad: PadCurves, energy_J_m2: float, tops_GPa: float) -> PadCurves:
    """The pad with bonds in what touches, which break as it opens.

    The area that touches is the repulsion over the pressure of the tops. Where a rise parts an area
    of them, bonds pull by their energy times the area a length: in sum, by the energy of all.

    Parameters
    ----------
    tops_GPa : mean pressure of what touches.
    """
    touching = pad.opening[:, 0] / tops_GPa
    opening = pad.opening.copy()
    for row, share in zip(opening, touching, strict=True):
        known = np.isfinite(share)
        if known.sum() < 2:  # a depth at the end of the table
            continue
        # J/m^2 over nm is GPa
        pull_GPa = energy_J_m2 * np.gradient(share[known], pad.separation_nm[known])
        row[1, known] += np.minimum(pull_GPa, 0.0)
    return replace(pad, opening=opening)


def rows_at(places: Array | float, known: Array, rows: Array) -> Array:
    """Rows that stand at `known` places, at other ones; beyond, their first and last values.

    Of the shape (rows,) + that of `places`.
    """
    return np.stack([np.interp(places, known, row) for row in rows])
