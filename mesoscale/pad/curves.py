"""Mean pressure of a pad against separation, from its cells.

A pad has some 10^4 to 10^5 cells; the few that are computed stand for all of them, each with its weight.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.contact.displacement import Displacement
from mesoscale.pad.cells import Cell, PadGrid, half_of

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PadCells:
    """Pressures of all computed cells at the separations they share; far to near.

    Attributes
    ----------
    grid : separations and depths.
    weight : share of each cell in the pad, shape (cells,).
    first_contact_nm : first contact of each cell, shape (cells,).
    closing : repulsive and attractive pressure (GPa, attraction negative), shape (cells, 2, n).
    opening : the same while opening from each depth, shape (cells, k, 2, n); NaN below the depth.
    settled : whether flow came to rest in each cell, shape (cells,).
    """

    grid: PadGrid
    weight: Array
    first_contact_nm: Array
    closing: Array
    opening: Array
    settled: NDArray[np.bool_]

    @property
    def count(self) -> int:
        """Number of cells."""
        return len(self.first_contact_nm)

    def mean(self, pressures: Array) -> Array:
        """Mean of pressures (cells, ...) over the pad."""
        return np.einsum("c,c...->...", self.weight, pressures)

    def half(self, other: bool = False) -> "PadCells":
        """The pad of one half of its cells; see `mesoscale.pad.cells.half_of`."""
        kept = half_of(self.count, other)
        return PadCells(
            self.grid,
            self.weight[kept] / self.weight[kept].sum(),
            self.first_contact_nm[kept],
            self.closing[kept],
            self.opening[kept],
            self.settled[kept],
        )


def assemble(grid: PadGrid, cells: Sequence[Cell], closed: Sequence[Displacement], cell_area_nm2: float) -> PadCells:
    """The cells of a pad from what closing each of them gave, each of so large an area."""
    return PadCells(
        grid,
        np.array([cell.weight for cell in cells]),
        np.array([cell.first_contact_nm for cell in closed]),
        np.array([cell.closing for cell in closed]) / cell_area_nm2,
        np.array([cell.opening for cell in closed]) / cell_area_nm2,
        np.array([cell.settled for cell in closed]),
    )


def curve_rows(cells: PadCells) -> list[dict[str, Any]]:
    """Rows of pad/curves.csv: mean pressures of the cells against separation, closing and opening from each depth."""
    rows = _branch_rows(cells, "closing", None, cells.closing)
    for k, depth in enumerate(cells.grid.depth_nm):
        rows += _branch_rows(cells, "opening", float(depth), cells.opening[:, k])
    return rows


def _branch_rows(cells: PadCells, branch: str, depth: float | None, pressures: Array) -> list[dict[str, Any]]:
    mean = cells.mean(pressures)
    # of a ratio of weighted sums (Cochran, Sampling Techniques, 1977, eq. 6.13)
    apart = (pressures - mean).sum(axis=1) * cells.weight[:, None]
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
