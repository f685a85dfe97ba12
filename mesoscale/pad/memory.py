"""The pressure of a pad as a function of separation and of the deepest closing."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mesoscale.contact.attraction import wall_offset_nm
from mesoscale.errors import NotComputed
from mesoscale.inputs.contact import ContactInputs
from mesoscale.pad.curves import PadCells
from mesoscale.pad.numerics import PAD
from mesoscale.settings import ContactSettings

Array = NDArray[np.float64]

FLOOR_GPa = 1e-13
"""Repulsion of 0.1 mPa counts as none; it keeps the logarithm finite beyond the last contact."""


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
        """Work per area of this attraction from a separation to infinity, A_H / (12 pi s^2); any shape."""
        walls = np.maximum(np.asarray(separation_nm, float), 1.0) + self.offset_nm
        return self.hamaker / (12.0 * np.pi * walls**2)


def flats_of(inputs: ContactInputs, contact: ContactSettings) -> Flats:
    """The flats of a contact."""
    return Flats(inputs.hamaker, wall_offset_nm(contact))


@dataclass(frozen=True)
class PadLaw:
    """Mean pressure of a pad: one closing curve, and an opening curve for each depth.

    Between depths, repulsion and attraction are interpolated in logarithm at equal distance from the depth: an
    exponential repulsion, which rough contacts come near to, is interpolated exactly.

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
        """Net pressure while opening from `deepest_nm` (GPa), any shape; separations below it count as it.

        Raises
        ------
        NotComputed : a depth that was not computed; the message has the range.
        """
        low, high = float(self.depth_nm[0]), float(self.depth_nm[-1])
        if not low <= deepest_nm <= high:
            raise NotComputed(
                f"deepest closing {deepest_nm:.4g} nm: the pad was computed for {low:.4g} .. {high:.4g} nm "
                f"({self.closing_GPa(high) * 1e3:.3g} .. {self.closing_GPa(low) * 1e3:.3g} MPa)"
            )
        s = np.maximum(np.asarray(separation_nm, float), deepest_nm)
        upper = int(np.clip(np.searchsorted(self.depth_nm, deepest_nm), min(1, self.depth_nm.size - 1), None))
        lower = max(upper - 1, 0)
        apart = self.depth_nm[upper] - self.depth_nm[lower]
        share = (deepest_nm - self.depth_nm[lower]) / apart if apart > 0 else 0.0  # 0: a pad of one depth
        risen = s - deepest_nm
        shallow = self._logarithms(upper, self.depth_nm[upper] + risen)
        deep = self._logarithms(lower, self.depth_nm[lower] + risen)
        repulsion, attraction = np.exp((1.0 - share) * deep + share * shallow)
        return self._extended(s, np.where(repulsion > 2.0 * FLOOR_GPa, repulsion, 0.0) - attraction)

    def _logarithms(self, number: int, separation_nm: Array) -> Array:
        known = np.isfinite(self.opening[number, 0])
        repulsion, attraction = rows_at(separation_nm, self.separation_nm[known], self.opening[number][:, known])
        return np.log(np.stack([np.maximum(repulsion, FLOOR_GPa), np.maximum(-attraction, FLOOR_GPa)]))

    def _check(self, separation_nm: Array) -> None:
        if (separation_nm < self.separation_nm[0]).any():
            raise NotComputed(
                f"separation {separation_nm.min():.4g} nm: the pad was closed to {self.separation_nm[0]:.4g} nm "
                f"({self.closing[:, 0].sum() * 1e3:.3g} MPa)"
            )

    def _extended(self, separation_nm: Array, pressure: Array) -> Array:
        """Beyond the table, two flats."""
        far = separation_nm > self.separation_nm[-1]
        return np.where(far, -self.flats.pull_GPa(separation_nm), pressure)


def deepened(law: PadLaw, times: float = 2.0) -> PadLaw:
    """The pad continued below its deepest closing, until the repulsion has grown so many times.

    Closing goes on as the exponential of its last e-fold, repulsion and attraction apart. An opening from there is that
    from the deepest depth, in proportion to where it starts.
    """
    s, ends = law.separation_nm, law.closing[:, 0]
    last = int(np.argmax(law.closing[0] < ends[0] / np.e)) or s.size - 1
    slopes = [np.log(max(row[0] / row[last], 1.0)) / (s[last] - s[0]) if row[last] else 0.0 for row in law.closing]
    if slopes[0] <= 0.0:
        raise NotComputed(f"separation {s[0]:.4g} nm: the repulsion of the pad does not grow there")
    reach = np.log(times) / slopes[0]
    if reach >= s[0]:
        raise NotComputed(f"separation {s[0]:.4g} nm: the pad is closed to its mean plane before its repulsion doubles")
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
    """The law of a pad from its cells."""
    return PadLaw(
        cells.grid.separation_nm[::-1],
        cells.mean(cells.closing)[:, ::-1],
        cells.grid.depth_nm[::-1],
        cells.mean(cells.opening)[::-1, :, ::-1],
        flats,
    )
