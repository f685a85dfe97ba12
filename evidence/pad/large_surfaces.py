"""Does a pad assembled from cells press and pull as a surface of its size that is computed directly?

Surfaces of 4 µm × 4 µm and cells of 1 µm are closed and opened at the same separations; sixteen cells are a pad of the
area of one large surface. `apart_in_errors` is the difference of both means over its standard error.
"""

from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from evidence.pad.number_of_cells import INPUTS, PIXELS, LOADS_MPa, deepest_kPa, opened_grid
from mesoscale.pad.cells import FIRST_SEED, close_cells
from mesoscale.pad.curves import PadCells, assemble
from mesoscale.settings import ContactSettings

Array = NDArray[np.float64]

SIDE = 4
"""Cells along a large surface."""
FIRST_LARGE_SEED = 500_000


def arguments(parser: ArgumentParser) -> None:
    """Options on the command line."""
    parser.add_argument("--large", type=int, default=24)
    parser.add_argument("--cells", type=int, default=512)


def rows(given: Namespace) -> Iterator[dict[str, Any]]:
    """Closing pressure and deepest net pressure on opening of both, for each load."""
    contact = ContactSettings(pixels=PIXELS)
    wide = contact.model_copy(update={"pixels": SIDE * PIXELS, "length_nm": SIDE * contact.length_nm})
    grid = opened_grid(contact)
    small = close_cells(INPUTS, contact, grid, range(FIRST_SEED, FIRST_SEED + given.cells))
    large = close_cells(INPUTS, wide, grid, range(FIRST_LARGE_SEED, FIRST_LARGE_SEED + given.large))
    yield from comparison_rows(
        assemble(grid, list(small), contact.length_nm**2), assemble(grid, list(large), wide.length_nm**2)
    )


def figures(table: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """By how much the assembled pads differ at most."""
    found = {}
    for key, quantity in (("closing", "closing pressure"), ("well", "deepest net pressure")):
        part = [row for row in table if row["quantity"].startswith(quantity)]
        found[key] = f"{max(abs(float(row['ratio']) - 1.0) for row in part):.0%}"
        found[f"{key}_errors"] = f"{max(abs(float(row['apart_in_errors'])) for row in part):.1f}"
    return found


def comparison_rows(cells: PadCells, large: PadCells) -> Iterator[dict[str, Any]]:
    """Rows from the cells and the large surfaces at the same separations."""
    size = SIDE**2
    pads = cells.count // size
    groups = np.arange(pads * size).reshape(pads, size)
    for k, load in enumerate(LOADS_MPa):
        place = cells.grid.depths[k]
        net, single = cells.opening[:, k].sum(axis=1), large.opening[:, k].sum(axis=1)
        way = np.isfinite(net).all(axis=0)
        yield _row(
            "closing pressure, MPa",
            load,
            cells.closing[groups, 0, place].mean(axis=1) * 1e3,
            large.closing[:, 0, place] * 1e3,
        )
        yield _row(
            "deepest net pressure on opening, kPa",
            load,
            np.array([deepest_kPa(net[group][:, way]) for group in groups]),
            np.array([deepest_kPa(one[None, way]) for one in single]),
        )


def _row(quantity: str, load: float, assembled: Array, direct: Array) -> dict[str, Any]:
    (ours, error), (theirs, other) = (
        (float(values.mean()), float(values.std(ddof=1) / len(values) ** 0.5)) for values in (assembled, direct)
    )
    return {
        "quantity": quantity,
        "at": load,
        "assembled_from": len(assembled),
        "assembled": ours,
        "assembled_error": error,
        "direct_from": len(direct),
        "direct": theirs,
        "direct_error": other,
        "ratio": ours / theirs,
        "apart_in_errors": (ours - theirs) / float(np.hypot(error, other)),
    }
