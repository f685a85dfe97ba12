"""The cells of a pad, closed to the separations they share and opened from its depths.

A pad has some 10^4 to 10^5 cells; the few that are computed stand for all of them, each with its
weight.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mesoscale.contact.displacement import Displacement, close_by_separation
from mesoscale.contact.numerics import NUMERICS, Numerics
from mesoscale.inputs.contact import ContactInputs
from mesoscale.pad.cells import Cell, place_ratio, surface_of
from mesoscale.pad.grid import PadGrid
from mesoscale.pad.pressed import Pad, assemble
from mesoscale.settings import ContactSettings

Array = NDArray[np.float64]

PLACE_STEP_RMS = 0.01
"""Step of a cell in units of the RMS height of its own place, times that over the median place's,
where this is longer than the pad's. With 0.04 at all places wells are passed over, and scene
`reduced` lets go 0.1 V too high."""
LONGEST_PLACE_STEP_NM = 0.8
"""And the longest such step, since wells are a nanometre wide."""


def press_cells(
    inputs: ContactInputs,
    contact: ContactSettings,
    grid: PadGrid,
    cells: Sequence[Cell],
    progress: Callable[[float, str], None] | None = None,
    numerics: Numerics = NUMERICS,
) -> Pad:
    """A pad whose cells are closed to its separations and opened from its depths."""
    closed = list(close_cells(inputs, contact, grid, cells, progress, numerics))
    return assemble(inputs, contact, grid, cells, closed)


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
    between = closed.at_steps(separation_nm, grid.separation_nm)
    for branch, depth in zip(between.opening, grid.depths, strict=True):
        branch[:, depth + 1 :] = np.nan
    return replace(between, first_contact_nm=closed.first_contact_nm - plane_nm)


def _own_steps(grid: PadGrid, step_nm: float) -> NDArray[np.int_]:
    """Positions in a grid that are so far apart at least, with its ends and depths."""
    chosen = [0]
    for place in range(1, grid.separation_nm.size):
        moved_nm = grid.separation_nm[chosen[-1]] - grid.separation_nm[place]
        if place in grid.depths or moved_nm >= (1.0 - 1e-9) * step_nm:
            chosen.append(place)
    return np.array(chosen)
