"""The cells of a pad, closed to the separations they share and opened from its depths.

A pad has some 10^4 to 10^5 cells; the few that are computed stand for all of them, each with its
weight.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mesoscale.contact.displacement import Displacement, close_by_separation
from mesoscale.contact.numerics import NUMERICS, Numerics
from mesoscale.inputs.contact import ContactInputs
from mesoscale.pad.cells import Cell, half_of, place_ratio, surface_of
from mesoscale.pad.grid import PadGrid
from mesoscale.settings import ContactSettings

Array = NDArray[np.float64]

PLACE_STEP_RMS = 0.01
"""Step of a cell in units of the RMS height of its own place, times that over the median place's,
where this is longer than the pad's. With 0.04 at all places wells are passed over, and scene
`reduced` lets go 0.1 V too high."""
LONGEST_PLACE_STEP_NM = 0.8
"""And the longest such step, since wells are a nanometre wide."""


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
        chosen = np.flatnonzero(half_of(self.count, other))
        pairs = np.bincount(np.arange(self.count) // 2, self.weight)[chosen // 2]
        return PadCells(
            self.grid,
            pairs / pairs.sum(),
            self.rms_ratio[chosen],
            self.first_contact_nm[chosen],
            self.closing[chosen],
            self.opening[chosen],
            self.settled[chosen],
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


def close_cells(
    inputs: ContactInputs,
    contact: ContactSettings,
    grid: PadGrid,
    cells: Sequence[Cell],
    progress: Callable[[float, str], None] | None = None,
    numerics: Numerics = NUMERICS,
) -> Iterator[Displacement]:
    """Forces of each cell at the separations of the pad, while closing and while opening from each
    depth.
    """
    for done, cell in enumerate(cells):
        yield _close(inputs, contact, grid, cell, numerics)
        if progress:
            progress((done + 1) / len(cells), f"{done + 1} of {len(cells)} cells")


def _close(
    inputs: ContactInputs, contact: ContactSettings, grid: PadGrid, cell: Cell, numerics: Numerics
) -> Displacement:
    """One cell at the separations of the pad; a rough one in longer steps, between which its forces
    are straight.
    """
    heights = surface_of(inputs, contact, cell)
    plane_nm = float(heights.mean())  # the separation is that from the mean plane of the film
    ratio = place_ratio(inputs, cell)
    step_nm = min(PLACE_STEP_RMS * ratio**2 * inputs.rms, LONGEST_PLACE_STEP_NM)
    chosen = _own_steps(grid, step_nm)
    separation_nm = grid.separation_nm[chosen]
    depths = np.flatnonzero(np.isin(chosen, grid.depths))
    closed = close_by_separation(
        inputs, contact, heights, separation_nm + plane_nm, depths, numerics
    )
    closing = _between(grid.separation_nm, separation_nm, closed.closing)
    opening = [_between(grid.separation_nm, separation_nm, branch) for branch in closed.opening]
    for branch, depth in zip(opening, grid.depths, strict=True):
        branch[:, depth + 1 :] = np.nan
    first_contact_nm = closed.first_contact_nm - plane_nm
    return Displacement(first_contact_nm, closing, np.array(opening), closed.settled)


def _own_steps(grid: PadGrid, step_nm: float) -> NDArray[np.int_]:
    """Positions in a grid that are so far apart at least, with its ends and depths."""
    chosen = [0]
    for place in range(1, grid.separation_nm.size):
        moved_nm = grid.separation_nm[chosen[-1]] - grid.separation_nm[place]
        if place in grid.depths or moved_nm >= (1.0 - 1e-9) * step_nm:
            chosen.append(place)
    return np.array(chosen)


def _between(places_nm: Array, known_nm: Array, forces: Array) -> Array:
    """Forces (2, n) at falling separations, at other ones."""
    return np.array([np.interp(-places_nm, -known_nm, row) for row in forces])
