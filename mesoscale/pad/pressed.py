"""A pressed pad: its cells, and the curves of the pad that they stand for."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from mesoscale.contact.attraction import wall_offset_nm
from mesoscale.contact.displacement import Displacement
from mesoscale.inputs.contact import ContactInputs
from mesoscale.pad.cells import Cell, half_of, place_ratio
from mesoscale.pad.curves import Flats, PadCurves, rows_at
from mesoscale.pad.grid import PadGrid
from mesoscale.settings import ContactSettings

Array = NDArray[np.float64]

KERNEL = 1.06
"""Width of the spread of first contacts, over their deviation times the number of cells to the
power -1/5 (Silverman, Density Estimation, 1986, eq. 3.28). Without it releases of scene `paper` are
0.3 V too low, with 0.8 of the deviation a pad of wide scatter sticks that does not."""
SHIFTS = 9
"""Of a cell, equally likely."""


@dataclass(frozen=True)
class Pad:
    """A pad that was pressed: pressures of its computed cells at the separations they share.

    A pad has some 10^4 to 10^5 cells; the few that are computed stand for all of them, each with
    its weight. Separations are from far to near.

    Attributes
    ----------
    grid : separations and depths.
    weight : share of each cell in the pad, shape (cells,).
    rms_ratio : RMS height of each cell's place over the median place's, shape (cells,).
    first_contact_nm : first contact of each cell, shape (cells,).
    closing : repulsive and attractive pressure (GPa, attraction negative), shape (cells, 2, n).
    opening : the same while opening from each depth, shape (cells, k, 2, n); NaN below the depth.
    settled : whether flow came to rest in each cell, shape (cells,).
    flats : what the pad is from far away.
    """

    grid: PadGrid
    weight: Array
    rms_ratio: Array
    first_contact_nm: Array
    closing: Array
    opening: Array
    settled: NDArray[np.bool_]
    flats: Flats

    @property
    def count(self) -> int:
        """Number of cells."""
        return len(self.first_contact_nm)

    def mean(self, pressures: Array) -> Array:
        """Mean of pressures (cells, ...) over the pad."""
        return np.einsum("c,c...->...", self.weight, pressures)

    @property
    def curves(self) -> PadCurves:
        """Its mean pressure."""
        return self._curves

    @cached_property
    def _curves(self) -> PadCurves:
        """The same, by more cells than were computed.

        A pad has 10^4 to 10^5 cells, and they touch first at all separations. The wells of a dozen
        stand apart, so that their mean is too deep. So each cell stands for others that touch first
        nearer or farther out, and whose curves are its own, shifted. The shifts are those of a
        smoothed bootstrap: normal, of Silverman's width, with all cells drawn together so that the
        variance of first contacts stays (Silverman, Density Estimation, 1986, eq. 3.28, sec.
        6.4.1). Places of another RMS height shift in proportion to it.
        """
        separation = self.grid.separation_nm[::-1]
        depth = self.grid.depth_nm[::-1]
        closing = np.zeros((2, separation.size))
        opening = np.zeros((depth.size, 2, separation.size))
        shifts_nm = _shifts_nm(self)
        weights = self.weight / shifts_nm.shape[1]
        for place, weight in enumerate(weights):
            cell = self._cell(place)
            shifts = shifts_nm[place]
            closing += weight * sum(_closing(cell, separation - shift) for shift in shifts)
            for number, deepest in enumerate(depth):
                above = separation >= deepest
                opened = _opened(cell, separation[above] - deepest, deepest - shifts)
                opening[number][:, above] += weight * opened.sum(axis=0)
                opening[number][:, ~above] = np.nan
        return PadCurves(separation, closing, depth, opening, self.flats)

    def _cell(self, place: int) -> PadCurves:
        """The curves of one cell."""
        return PadCurves(
            separation_nm=self.grid.separation_nm[::-1],
            closing=self.closing[place][:, ::-1],
            depth_nm=self.grid.depth_nm[::-1],
            opening=self.opening[place][::-1, :, ::-1],
            flats=self.flats,
        )

    def half(self, other: bool = False) -> "Pad":
        """The pad of one half of its cells; each stands for its neighbour of the other half, too
        (`half_of`).
        """
        chosen = np.flatnonzero(half_of(self.count, other))
        pairs = np.bincount(np.arange(self.count) // 2, self.weight)[chosen // 2]
        return replace(
            self,
            weight=pairs / pairs.sum(),
            rms_ratio=self.rms_ratio[chosen],
            first_contact_nm=self.first_contact_nm[chosen],
            closing=self.closing[chosen],
            opening=self.opening[chosen],
            settled=self.settled[chosen],
        )

    @property
    def halves(self) -> tuple[PadCurves, PadCurves]:
        """The curves of half of its cells, and of the others."""
        return self.half().curves, self.half(other=True).curves


def assemble(
    inputs: ContactInputs,
    contact: ContactSettings,
    grid: PadGrid,
    cells: Sequence[Cell],
    closed: Sequence[Displacement],
) -> Pad:
    """The pad of some cells, from what closing each of them gave."""
    area = contact.length_nm**2
    return Pad(
        grid,
        weight=np.array([cell.weight for cell in cells]),
        rms_ratio=np.array([place_ratio(inputs, cell) for cell in cells]),
        first_contact_nm=np.array([cell.first_contact_nm for cell in closed]),
        closing=np.array([cell.closing for cell in closed]) / area,
        opening=np.array([cell.opening for cell in closed]) / area,
        settled=np.array([cell.settled for cell in closed]),
        flats=Flats(inputs.hamaker, wall_offset_nm(contact)),
    )


def _shifts_nm(pad: Pad) -> Array:
    """How much farther out than it the cells touch first for which each cell stands, shape (cells,
    shifts).
    """
    count = pad.count
    first = pad.first_contact_nm / pad.rms_ratio
    apart = first - pad.weight @ first
    deviation = math.sqrt(pad.weight @ apart**2 * count / max(count - 1, 1))
    if not deviation > 0.0:
        return np.zeros((count, 1))
    width = KERNEL * count**-0.2
    # of the deviations from the mean
    drawn = math.sqrt((1.0 - width**2) * count / (count - 1)) - 1.0
    normal = ndtri((np.arange(SHIFTS) + 0.5) / SHIFTS)
    kernel = width * deviation * normal / normal.std()
    return pad.rms_ratio[:, None] * (drawn * apart[:, None] + kernel)


def _opened(cell: PadCurves, risen_nm: Array, deepest_nm: Array) -> Array:
    """Repulsive and attractive pressure (GPa) while opening from any depths, in proportion to where
    closing ended; the nearest known depth counts.

    The first rise is 0; of the shape (depths, 2) + that of the rises.
    """
    nearest_nm = np.clip(deepest_nm, cell.depth_nm[0], cell.depth_nm[-1])
    rows = cell.opened(risen_nm, nearest_nm)
    start = rows[:, :, 0]
    ended = _closing(cell, deepest_nm).T
    scale = np.divide(ended, start, out=np.ones_like(start), where=start != 0.0)
    return rows * scale[:, :, None]


def _closing(cell: PadCurves, separation_nm: Array) -> Array:
    """Repulsive and attractive pressure (GPa) while closing; below the table in proportion to its
    last step.
    """
    nearest, farthest = cell.separation_nm[[0, -1]]
    rows = rows_at(separation_nm, cell.separation_nm, cell.closing)
    slope = (cell.closing[:, 1] - cell.closing[:, 0]) / (cell.separation_nm[1] - nearest)
    rows += np.minimum(separation_nm - nearest, 0.0) * slope[:, None]
    # where asperities merged in the last step, repulsion fell, and a line would fall below 0
    rows[0] = np.maximum(rows[0], 0.0)
    as_flats = [np.zeros_like(rows[0]), -cell.flats.pull_GPa(separation_nm)]
    return np.where(separation_nm > farthest, as_flats, rows)


def curve_rows(pad: Pad) -> list[dict[str, Any]]:
    """Rows of pad/curves.csv: the curves of a pad, closing and opening from each depth, with their
    error by the cells.
    """
    rows = _branch_rows(pad, pad.curves.closing, "closing", None, pad.closing)
    for number, depth_nm in enumerate(pad.grid.depth_nm.tolist()):
        opened = pad.curves.opening[-1 - number]
        rows += _branch_rows(pad, opened, "opening", depth_nm, pad.opening[:, number])
    return rows


def _branch_rows(
    pad: Pad, nearest_first: Array, branch: str, depth: float | None, pressures: Array
) -> list[dict[str, Any]]:
    mean = nearest_first[:, ::-1]
    # of a ratio of weighted sums (Cochran, Sampling Techniques, 1977, eq. 6.13)
    apart = (pressures - pad.mean(pressures)).sum(axis=1) * pad.weight[:, None]
    error = np.sqrt((apart**2).sum(axis=0) * pad.count / max(pad.count - 1, 1))
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
        for place, separation in enumerate(pad.grid.separation_nm)
        if np.isfinite(mean[0, place])
    ]
