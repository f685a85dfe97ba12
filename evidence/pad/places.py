"""Does a pad of unequal places press and pull as a surface whose places differ, and how many cells
does that take?

`direct`: surfaces of 4 µm × 4 µm, of which each µm² is a place with an RMS height of its own
(independent, lognormal), beside pads of sixteen cells with the same RMS heights. `cells`: pads of
so many successive cells beside pads of independent places. `kinds`: all cells beside a film of two
kinds of places, half of each, with the same mean and scatter of ln RMS. `alike`: all cells beside a
film whose places all have the median RMS height. `spread` is the standard deviation of pads.
"""

from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from evidence.pad.large_surfaces import (
    FIRST_LARGE_SEED,
    INPUTS,
    PILOTS,
    SIDE,
    closed,
    deepest_kPa,
    random_cells,
)
from mesoscale.contact.displacement import close_by_separation
from mesoscale.inputs.contact import ContactInputs, FilmInputs
from mesoscale.pad.cells import FIRST_SEED, Cell, surface_of
from mesoscale.pad.closing import assemble, close_cells
from mesoscale.pad.pilots import plan_grid
from mesoscale.settings import ContactSettings

Array = NDArray[np.float64]

PIXELS = 128
MEDIAN = replace(INPUTS, rms=5.0)
SCATTER = 0.3
"""Of ln RMS; the scans of scene `reduced` allow 0.18 to 0.40."""
FILM = FilmInputs(**vars(MEDIAN), rms_scatter=SCATTER)
LARGEST_GPa = 6.6e-3
SIZES = (4, 8, 16, 32, 64, 128)
INDEPENDENT_PADS, FEWEST_PADS = 400, 8


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
        random_cells(PILOTS, FIRST_SEED),
        LARGEST_GPa,
        step_nm=0.1,
        depths=2,
    )
    cells = random_cells(given.cells, FIRST_SEED)
    pads = {
        "film": closed(FILM, contact, grid, cells),
        "alike": closed(MEDIAN, contact, grid, cells),
    }
    for kind, sign in (("smooth", -1), ("rough", 1)):
        pads[kind] = closed(
            at_rms(float(np.exp(sign * SCATTER))), contact, grid, cells[: len(cells) // 2]
        )
    wide = contact.model_copy(
        update={"pixels": SIDE * PIXELS, "length_nm": SIDE * contact.length_nm}
    )
    large, assembled = [], []
    for seed in range(FIRST_LARGE_SEED, FIRST_LARGE_SEED + given.large):
        factors = np.exp(SCATTER * np.random.default_rng([seed, 0x91ACE]).normal(size=(SIDE, SIDE)))
        (large_cell,) = random_cells(1, seed)
        heights = surface_of(MEDIAN, wide, large_cell) * np.kron(factors, np.ones((PIXELS, PIXELS)))
        from_plane = grid.separation_nm + float(heights.mean())
        large.append(close_by_separation(MEDIAN, wide, heights, from_plane, grid.depths))
        for k, factor in enumerate(factors.ravel().tolist()):
            (small,) = random_cells(1, FIRST_LARGE_SEED + SIDE**2 * seed + k)
            assembled += close_cells(at_rms(factor), contact, grid, [small])
    alone = [Cell(0, 0.0, 0.0, 1.0 / len(large))]
    pads["direct"] = assemble(MEDIAN, wide, grid, alone * len(large), large)
    pads["assembled"] = assemble(MEDIAN, contact, grid, alone * len(assembled), assembled)
    for k, place in enumerate(grid.depths.tolist()):
        about = {"mechanics": given.mechanics, "from_nm": float(grid.separation_nm[place])}
        closing = {name: pad.closing[:, 0, place] * 1e3 for name, pad in pads.items()}
        yield from comparisons(about | {"quantity": "closing pressure, MPa"}, closing)
        net = {
            name: pad.opening[:, k].sum(axis=1)[:, : place + 1] * 1e6 for name, pad in pads.items()
        }
        yield from comparisons(about | {"quantity": "net pressure on opening, kPa"}, net)


def at_rms(factor: float) -> ContactInputs:
    """Inputs of a place whose RMS height is so many times the median one."""
    return replace(MEDIAN, rms=MEDIAN.rms * factor)


def comparisons(about: Mapping[str, Any], of: Mapping[str, Array]) -> Iterator[dict[str, Any]]:
    """Rows of one quantity from its values, or its curves over separation, of the cells and
    surfaces of each pad.
    """
    cells, rng = of["film"], np.random.default_rng(0)
    yield _row(
        "direct", SIDE**2, about, pads_of(of["assembled"], SIDE**2), pads_of(of["direct"], 1)
    )
    for size in SIZES:
        if len(cells) // size >= FEWEST_PADS:
            chosen = rng.integers(len(cells), size=INDEPENDENT_PADS * size)
            yield _row("cells", size, about, pads_of(cells, size), pads_of(cells[chosen], size))
    kinds = np.stack([of["smooth"], of["rough"]], axis=1).reshape(-1, *cells.shape[1:])
    size = len(cells) // FEWEST_PADS
    for question, other in (("kinds", kinds), ("alike", of["alike"])):
        yield _row(question, size, about, pads_of(cells, size), pads_of(other, size))


def pads_of(cells: Array, size: int) -> Array:
    """Pressures of pads of `size` successive cells: the mean, or the deepest net pressure of the
    mean curve.
    """
    groups = [cells[start : start + size] for start in range(0, len(cells) - size + 1, size)]
    return np.array(
        [float(group.mean()) if cells.ndim == 1 else deepest_kPa(group * 1e-6) for group in groups]
    )


def _row(
    question: str, size: int, about: Mapping[str, Any], pads: Array, beside: Array
) -> dict[str, Any]:
    error = float(
        np.hypot(pads.std(ddof=1) / len(pads) ** 0.5, beside.std(ddof=1) / len(beside) ** 0.5)
    )
    if question == "direct":  # pair by pair the same RMS heights
        error = float((pads - beside).std(ddof=1) / len(pads) ** 0.5)
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
        "apart_in_errors": float(pads.mean() - beside.mean()) / error,
    }


def figures(table: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """How near assembled pads are to direct ones, what mixing does, and the spread of pads of so
    many cells.
    """
    deep = min(float(row["from_nm"]) for row in table)
    part = [
        row
        for row in table
        if float(row["from_nm"]) == deep and row["quantity"].startswith("closing")
    ]
    ratio = {row["question"]: float(row["mean"]) / float(row["beside_mean"]) for row in part}
    apart = [abs(float(row["apart_in_errors"])) for row in table if row["question"] == "direct"]
    return {
        "direct_errors": f"{max(apart):.1f}",
        **{question: f"{ratio[question]:.2g}" for question in ("direct", "alike", "kinds")},
        **{
            f"spread_{row['cells']}": f"{float(row['spread']) / float(row['mean']):.0%}"
            for row in part
            if row["question"] == "cells"
        },
    }
