"""Assembled pads beside surfaces of 4 um x 4 um that are computed directly, and the tail beside brute force.

`python -m mesoscale.pad.studies.large_surfaces TABLE DIRECT CELLS` closes and opens so many large surfaces and so many
cells of 1 um at the same separations; sixteen cells are a pad of the area of one large surface.
`python -m mesoscale.pad.studies.large_surfaces TABLE tail FITTED BRUTE` fits the distribution of first contacts to
some cells, and looks at other ones. Both replace their rows of the table and print them.
"""

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from mesoscale.pad.cells import close_cells
from mesoscale.pad.curves import PadCells, assemble
from mesoscale.pad.studies.number_of_cells import INPUTS, PIXELS, LOADS_MPa, deepest_kPa, opened_grid
from mesoscale.pad.surfaces import FilmPieces
from mesoscale.pad.tail import fit_tail
from mesoscale.settings import ContactSettings, PadSettings
from mesoscale.tables import load_table, write_table

Array = NDArray[np.float64]
Row = dict[str, Any]

SIDE = 4
"""Cells along a large surface."""
FIRST_LARGE_SEED = 500_000
TAIL_PIXELS = 256
TAIL_SIZES = (16, 64, 256)


class Estimate(NamedTuple):
    """A mean of so many values, with its standard error."""

    values: int
    mean: float
    error: float


def sampled(values: Array) -> Estimate:
    """The mean of independent values."""
    return Estimate(len(values), float(values.mean()), float(values.std(ddof=1) / len(values) ** 0.5))


def comparison_rows(cells: PadCells, large: PadCells) -> Iterator[Row]:
    """Closing pressure and deepest net pressure on opening of both, for each load.

    The interval of the pads holds 95 % by their standard error and that of the large surfaces.
    """
    size = SIDE**2
    pads = cells.count // size
    groups = np.arange(pads * size).reshape(pads, size)
    for k, load in enumerate(LOADS_MPa):
        place = cells.grid.depths[k]
        net = cells.opening[:, k].sum(axis=1)
        way = np.isfinite(net).all(axis=0)
        single = large.opening[:, k].sum(axis=1)
        yield _row(
            "closing pressure, MPa",
            load,
            sampled(cells.closing[groups, 0, place].mean(axis=1) * 1e3),
            sampled(large.closing[:, 0, place] * 1e3),
        )
        yield _row(
            "deepest net pressure on opening, kPa",
            load,
            sampled(np.array([deepest_kPa(net[group][:, way]) for group in groups])),
            sampled(np.array([deepest_kPa(one[None, way]) for one in single])),
        )


def _row(quantity: str, at: float, assembled: Estimate, direct: Estimate) -> Row:
    return {
        "quantity": quantity,
        "at": at,
        "assembled_from": assembled.values,
        "assembled": assembled.mean,
        "assembled_error": assembled.error,
        "direct_from": direct.values,
        "direct": direct.mean,
        "direct_error": direct.error,
        "ratio": assembled.mean / direct.mean,
        "apart_in_errors": (assembled.mean - direct.mean) / float(np.hypot(assembled.error, direct.error)),
    }


def tail_rows(fitted: Array, others: Array) -> Iterator[Row]:
    """First contact (nm) of pads of several sizes: by the distribution fitted to some cells, and of other cells."""
    tail = fit_tail(fitted)
    for size in (*TAIL_SIZES, len(others)):
        groups = len(others) // size
        highest = others[: groups * size].reshape(groups, size).max(axis=1)
        (mean, scatter), error = tail.first_contact_nm(size), tail.standard_error_nm(size)
        # one pad alone has the scatter of pads
        spread = float(highest.std(ddof=1) / groups**0.5) if groups > 2 else float(scatter)
        yield _row(
            "first contact, nm, of so many cells",
            size,
            Estimate(len(fitted), float(mean), float(error)),
            Estimate(len(others), float(highest.mean()), spread),
        )


def first_contacts_nm(count: int, first_seed: int) -> Array:
    """First contacts of cells, which need no closing."""
    pieces = FilmPieces(INPUTS, ContactSettings(pixels=TAIL_PIXELS))
    return np.array([-float(pieces.surface(seed).min()) for seed in range(first_seed, first_seed + count)])


def main(table: str, *arguments: str) -> None:
    """See above."""
    seed = PadSettings().first_seed
    if arguments[0] == "tail":
        fitted, brute = (int(number) for number in arguments[1:])
        rows = list(tail_rows(first_contacts_nm(fitted, seed), first_contacts_nm(brute, seed + fitted)))
    else:
        direct, count = (int(number) for number in arguments)
        contact = ContactSettings(pixels=PIXELS)
        wide = contact.model_copy(update={"pixels": SIDE * PIXELS, "length_nm": SIDE * contact.length_nm})
        grid = opened_grid(contact)
        small = close_cells(INPUTS, contact, grid, range(seed, seed + count))
        large = close_cells(INPUTS, wide, grid, range(FIRST_LARGE_SEED, FIRST_LARGE_SEED + direct))
        cells = assemble(grid, list(small), contact.length_nm**2)
        surfaces = assemble(grid, list(large), wide.length_nm**2)
        rows = list(comparison_rows(cells, surfaces))
    path = Path(table)
    names = {row["quantity"] for row in rows}
    write_table(path, [*(row for row in load_table(path) if row["quantity"] not in names), *rows], digits=4)
    for row in rows:
        print(row)


if __name__ == "__main__":
    main(*sys.argv[1:])
