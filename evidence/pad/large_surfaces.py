"""Does a pad assembled from cells press and pull as a surface of its size that is computed
directly?

Surfaces of 4 µm × 4 µm and cells of 1 µm are closed and opened at the same separations; sixteen
cells are a pad of the area of one large surface. `apart_in_errors` is the difference of both means
over its standard error.
"""

from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.contact import ContactInputs
from mesoscale.pad.cells import FIRST_SEED, Cell
from mesoscale.pad.closing import press_cells
from mesoscale.pad.grid import PadGrid
from mesoscale.pad.pilots import plan_grid
from mesoscale.pad.pressed import Pad
from mesoscale.settings import ContactSettings

Array = NDArray[np.float64]

INPUTS = ContactInputs(
    hamaker=0.215, e_star=91.0, h_macro=1.95, h_prime=8.375, q0=0.025, hurst=0.75, rms=8.5
)
LOADS_MPa = (2.0, 6.6)
PIXELS = 128
PILOTS = 32

SIDE = 4
"""Cells along a large surface."""
FIRST_LARGE_SEED = 500_000


def arguments(parser: ArgumentParser) -> None:
    """Options on the command line."""
    parser.add_argument("--large", type=int, default=24)
    parser.add_argument("--cells", type=int, default=512)


def rows(given: Namespace) -> Iterator[dict[str, Any]]:
    """Closing pressure and deepest net pressure on opening of both, for each load."""
    contact = ContactSettings(mechanics="asperity", pixels=PIXELS)
    wide = contact.model_copy(
        update={"pixels": SIDE * PIXELS, "length_nm": SIDE * contact.length_nm}
    )
    grid = opened_grid(INPUTS, contact)
    small = closed(INPUTS, contact, grid, random_cells(given.cells, FIRST_SEED))
    yield from comparison_rows(
        small, closed(INPUTS, wide, grid, random_cells(given.large, FIRST_LARGE_SEED))
    )


def random_cells(count: int, first_seed: int) -> list[Cell]:
    """Independent places of a film, as a device has them."""
    numbers = np.random.default_rng([first_seed, 0x9A11]).normal(size=(count, 2)).tolist()
    return [
        Cell(first_seed + k, rough, plane, 1.0 / count) for k, (rough, plane) in enumerate(numbers)
    ]


def closed(
    inputs: ContactInputs, contact: ContactSettings, grid: PadGrid, cells: Sequence[Cell]
) -> Pad:
    """A pad of cells."""
    return press_cells(inputs, contact, grid, cells)


def opened_grid(inputs: ContactInputs, contact: ContactSettings) -> PadGrid:
    """Separations of the pad, opened from those at which pilot cells carry the loads."""
    pilots, largest_GPa = random_cells(PILOTS, FIRST_SEED), max(LOADS_MPa) * 1e-3
    grid = plan_grid(
        inputs,
        contact,
        pilots,
        largest_GPa,
        step_nm=0.1,
    )
    shut = closed(inputs, contact, PadGrid(grid.separation_nm, np.empty(0, int)), pilots)
    repelled = shut.mean(shut.closing)[0] * 1e3
    depths = np.array([int(np.argmax(repelled >= load)) for load in LOADS_MPa])
    return PadGrid(grid.separation_nm[: depths.max() + 1], depths)


def deepest_kPa(net: Array) -> float:
    """Largest net adhesive pressure of the mean of some cells, shape (cells, n); 0 where they only
    push.
    """
    return max(-float(np.nanmin(net.mean(axis=0))), 0.0) * 1e6


def figures(table: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """By how much the assembled pads differ at most."""
    found = {}
    for key, quantity in (("closing", "closing pressure"), ("well", "deepest net pressure")):
        part = [row for row in table if row["quantity"].startswith(quantity)]
        found[key] = f"{max(abs(float(row['ratio']) - 1.0) for row in part):.0%}"
        found[f"{key}_errors"] = f"{max(abs(float(row['apart_in_errors'])) for row in part):.1f}"
    return found


def comparison_rows(cells: Pad, large: Pad) -> Iterator[dict[str, Any]]:
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
        (float(values.mean()), float(values.std(ddof=1) / len(values) ** 0.5))
        for values in (assembled, direct)
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
