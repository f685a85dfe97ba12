"""Does a pad of unequal places press and pull as a surface whose places differ, and how many cells does that take?

`direct`: pads of sixteen cells beside surfaces of 4 µm × 4 µm, of which each µm² is a place with an RMS height of its
own (independent, lognormal). `cells`: pads of so many successive cells beside pads of independent places. `kinds`: all
cells beside a film of two kinds of places, half of each, with the same mean and scatter of ln RMS. `alike`: all cells
beside a film whose places all have the median RMS height. `spread` is the standard deviation of pads.
"""

from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from evidence.pad.large_surfaces import FIRST_LARGE_SEED, SIDE
from evidence.pad.number_of_cells import INPUTS, deepest_kPa
from mesoscale.contact.displacement import close_by_separation
from mesoscale.inputs.contact import ContactInputs, FilmInputs
from mesoscale.pad.cells import FIRST_SEED, FilmPieces, PadGrid, close_cells, plan_grid
from mesoscale.pad.curves import PadCells, assemble
from mesoscale.settings import ContactSettings, PadGridSettings

Array = NDArray[np.float64]

PIXELS = 128
MEDIAN = replace(INPUTS, rms=5.0)
SCATTER = 0.3
"""Of ln RMS; the scans of scene `reduced` allow 0.18 to 0.40."""
FILM = FilmInputs(**vars(MEDIAN), rms_scatter=SCATTER)
LARGEST_GPa = 6.6e-3
SIZES = (4, 8, 16, 32, 64, 128)
INDEPENDENT_PADS = 400


def arguments(parser: ArgumentParser) -> None:
    """Options on the command line."""
    parser.add_argument("--cells", type=int, default=1024)
    parser.add_argument("--large", type=int, default=48)
    parser.add_argument("--mechanics", default="asperity")


def rows(given: Namespace) -> Iterator[dict[str, Any]]:
    """A row for each comparison, quantity and load."""
    contact = ContactSettings.model_validate({"mechanics": given.mechanics, "pixels": PIXELS})
    grid = plan_grid(
        FILM,
        contact,
        PadGridSettings(pilot_cells=32, depths=2),
        lambda separation: np.full_like(separation, LARGEST_GPa),
    )
    cells = _closed(FILM, contact, grid, range(FIRST_SEED, FIRST_SEED + given.cells))
    wide = contact.model_copy(update={"pixels": SIDE * PIXELS, "length_nm": SIDE * contact.length_nm})
    large = assemble(
        grid,
        [
            close_by_separation(MEDIAN, wide, unequal_places(wide, seed), grid.separation_nm, grid.depths)
            for seed in range(FIRST_LARGE_SEED, FIRST_LARGE_SEED + given.large)
        ],
        wide.length_nm**2,
    )
    half = FIRST_SEED + given.cells // 2
    kinds = [
        _closed(replace(MEDIAN, rms=MEDIAN.rms * float(np.exp(sign * SCATTER))), contact, grid, range(FIRST_SEED, half))
        for sign in (-1, 1)
    ]
    alike = _closed(MEDIAN, contact, grid, range(FIRST_SEED, FIRST_SEED + given.cells))
    for k, load in enumerate(grid.depths.tolist()):
        for quantity, of_cells in (
            ("closing pressure, MPa", lambda pad, k=k: pad.closing[:, 0, grid.depths[k]] * 1e3),
            ("net pressure on opening, kPa", lambda pad, k=k: pad.opening[:, k].sum(axis=1) * 1e6),
        ):
            yield from _comparisons(
                {"mechanics": given.mechanics, "quantity": quantity, "from_nm": float(grid.separation_nm[load])},
                *(of_cells(pad) for pad in (cells, large, *kinds, alike)),
            )


def unequal_places(wide: ContactSettings, seed: int) -> Array:
    """Heights (nm) of one large surface, from the mean plane of the film: every place times a factor of its own."""
    factors = np.exp(SCATTER * np.random.default_rng([seed, 0x91ACE]).normal(size=(SIDE, SIDE)))
    heights = FilmPieces(MEDIAN, wide).surface(seed) * np.kron(factors, np.ones((PIXELS, PIXELS)))
    return heights


def _closed(inputs: ContactInputs, contact: ContactSettings, grid: PadGrid, seeds: range) -> PadCells:
    return assemble(grid, list(close_cells(inputs, contact, grid, seeds)), contact.length_nm**2)


def _comparisons(
    about: Mapping[str, Any], cells: Array, large: Array, smooth: Array, rough: Array, alike: Array
) -> Iterator[dict[str, Any]]:
    """Rows of one quantity from its values, or its curves over separation, of all cells and surfaces."""
    rng = np.random.default_rng(0)

    def independent(size: int) -> Array:
        return np.array([_of_pad(cells[rng.integers(len(cells), size=size)]) for _ in range(INDEPENDENT_PADS)])

    def successive(values: Array, size: int) -> Array:
        return np.array([_of_pad(part) for part in np.split(values[: len(values) // size * size], len(values) // size)])

    whole = successive(cells, len(cells) // 8)
    yield _row("direct", SIDE**2, about, independent(SIDE**2), np.array([_of_pad(one[None]) for one in large]))
    for size in SIZES:
        if len(cells) // size >= 8:
            yield _row("cells", size, about, successive(cells, size), independent(size))
    mixed = np.stack([smooth, rough], axis=1).reshape(-1, *smooth.shape[1:])
    yield _row("kinds", len(cells) // 8, about, whole, successive(mixed, len(cells) // 8))
    yield _row("alike", len(cells) // 8, about, whole, successive(alike, len(cells) // 8))


def _of_pad(values: Array) -> float:
    """A pad's pressure from its cells', or its deepest net pressure from their curves."""
    if values.ndim == 1:
        return float(values.mean())
    return deepest_kPa(values[:, np.isfinite(values).all(axis=0)] * 1e-6)


def _row(question: str, size: int, about: Mapping[str, Any], pads: Array, beside: Array) -> dict[str, Any]:
    return {
        "question": question,
        **about,
        "cells": size,
        "pads": len(pads),
        "mean": float(pads.mean()),
        "spread": float(pads.std(ddof=1)),
        "beside_pads": len(beside),
        "beside_mean": float(beside.mean()),
        "beside_spread": float(beside.std(ddof=1)),
        "ratio": float(pads.mean() / beside.mean()) if beside.mean() else None,
    }


def figures(table: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """What mixing places does to the pressure of a pad, and how near the assembled pads are to the direct ones."""
    closing = [row for row in table if row["quantity"].startswith("closing")]
    direct = [float(row["ratio"]) - 1.0 for row in closing if row["question"] == "direct"]
    alike = [float(row["ratio"]) for row in closing if row["question"] == "alike"]
    kinds = [float(row["ratio"]) for row in closing if row["question"] == "kinds"]
    spread = {row["cells"]: float(row["spread"]) / float(row["mean"]) for row in closing if row["question"] == "cells"}
    return {
        "direct": f"{max(direct, key=abs):+.0%}",
        "alike": f"{min(alike):.2g} to {max(alike):.2g}",
        "kinds": f"{min(kinds):.2g} to {max(kinds):.2g}",
        **{f"spread_{size}": f"{value:.0%}" for size, value in spread.items()},
    }
