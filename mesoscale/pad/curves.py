"""Mean pressure of a pad against separation, from its cells.

A pad has some 10^4 to 10^5 cells; the few that are computed stand for all of them, each with its
weight."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mesoscale.contact.displacement import Displacement
from mesoscale.contact.numerics import NUMERICS, Numerics
from mesoscale.inputs.contact import ContactInputs
from mesoscale.pad.cells import Cell, PadGrid, close_cells, half_of, place_ratio
from mesoscale.settings import ContactSettings

Array = NDArray[np.float64]


@dataclass(frozen=True)
class PadCells:
    """Pressures of all computed cells at the separations they share; far to near.

    Attributes
    ----------
    grid : separations and depths.
    weight : share of each cell in the pad, shape (cells,).
    rms_ratio : RMS height of each cell's place over the median place's, shape (cells,).
    first_contact_nm : first contact of each cell, shape (cells,).
    closing : repulsive and attractive pressure (GPa, attraction negative), shape (cells, 2, n).
    opening : the same while opening from each depth, shape (cells, k, 2, n); NaN below the depth.
    settled : whether flow came to rest in each cell, shape (cells,).
    """

    grid: PadGrid
    weight: Array
    rms_ratio: Array
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
        """The pad of one half of its cells; each stands for its neighbour of the other half, too
        (`half_of`).
        """
        kept = np.flatnonzero(half_of(self.count, other))
        pairs = np.bincount(np.arange(self.count) // 2, self.weight)[kept // 2]
        return PadCells(
            self.grid,
            pairs / pairs.sum(),
            self.rms_ratio[kept],
            self.first_contact_nm[kept],
            self.closing[kept],
            self.opening[kept],
            self.settled[kept],
        )


def press_cells(
    inputs: ContactInputs,
    contact: ContactSettings,
    grid: PadGrid,
    cells: Sequence[Cell],
    progress: Callable[[float, str], None] | None = None,
    numerics: Numerics = NUMERICS,
) -> PadCells:
    """The cells of a pad, closed to its separations and opened from its depths."""
    closed = list(close_cells(inputs, contact, grid, cells, progress, numerics))
    return assemble(inputs, contact, grid, cells, closed)


def assemble(
    inputs: ContactInputs,
    contact: ContactSettings,
    grid: PadGrid,
    cells: Sequence[Cell],
    closed: Sequence[Displacement],
) -> PadCells:
    """The cells of a pad from what closing each of them gave."""
    area = contact.length_nm**2
    return PadCells(
        grid,
        np.array([cell.weight for cell in cells]),
        np.array([place_ratio(inputs, cell) for cell in cells]),
        np.array([cell.first_contact_nm for cell in closed]),
        np.array([cell.closing for cell in closed]) / area,
        np.array([cell.opening for cell in closed]) / area,
        np.array([cell.settled for cell in closed]),
    )
