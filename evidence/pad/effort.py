"""Does the error that a scene's counts are said to leave in the release agree with repeated runs?

A finished scene gives the inputs. Each repeat has other surfaces, other draws and so another pad. The predicted error
is that of `workflow.effort` from the contributions of the scene as it was shipped then; the measured one is the
standard deviation of the median release over the repeats. The switches behind the median are at the same 64 points in
all repeats, so their number is not tested. Atomistic counts are not repeated: their runs take an hour each.
"""

import argparse
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np

from mesoscale.device import release
from mesoscale.device.electrode import presser
from mesoscale.device.pressing import hardest, pressing, pressure_to_compute
from mesoscale.inputs.contact import contact_of
from mesoscale.inputs.table import from_rows
from mesoscale.pad import draws as pad_draws
from mesoscale.pad.cells import FIRST_SEED, close_cells, plan_grid
from mesoscale.pad.curves import PadCells, assemble
from mesoscale.pad.memory import flats_of
from mesoscale.pad.response import SampledPad
from mesoscale.tables import load_table
from workflow.effort import KNOWN
from workflow.results import load_json
from workflow.scene import load_scene

COUNTS = ((16, 16), (48, 16), (128, 24))
"""Cells and draws of the three budgets."""
APART = 10_000_000
"""Between the surfaces of two repeats."""


def arguments(parser: argparse.ArgumentParser) -> None:
    """Which scene, and how often."""
    parser.add_argument("--scene", default="paper")
    parser.add_argument("--repeats", type=int, default=5)


def rows(given: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """The median release of each repeat at each budget."""
    scene = load_scene(given.scene)
    variance = load_json(KNOWN)["scenes"][scene.name]["variance_V2"]
    table = from_rows(load_table(Path("results") / scene.name / "pad" / "inputs.csv"))
    inputs, contact = contact_of(table.medians(), scene.contact)
    flats, area = flats_of(inputs, contact), contact.length_nm**2
    device = pressing(scene.device)
    grid = plan_grid(
        inputs,
        contact,
        scene.pad.piloted(scene.unequal_places),
        pressure_to_compute(device),
        pressed_GPa=presser(device),
    )
    device = hardest(pressing(scene.device, spread=True))
    for repeat in range(1, given.repeats + 1):
        seeds = range(FIRST_SEED + APART * repeat, FIRST_SEED + APART * repeat + max(COUNTS)[0])
        closed = list(close_cells(inputs, contact, grid, seeds))
        for cells, draws in COUNTS:
            with (
                mock.patch.object(pad_draws, "FIRST_SEED", FIRST_SEED + repeat),
                mock.patch.object(pad_draws, "FIRST_DRAW_SEED", pad_draws.FIRST_DRAW_SEED + APART * repeat),
            ):
                planned = pad_draws.plan_draws(table, scene.contact, draws, scene.pad.draw_cells)
            laws = pad_draws.close_draws(planned, scene.contact, pressure_to_compute(device), presser(device))
            pads = [
                SampledPad(draw.values, draw.gap_cutoff_nm, scene.pad.draw_cells, law)
                for draw, law in zip(planned, laws, strict=True)
            ]
            pad = assemble(grid, closed[:cells], area)
            yield {
                "scene": scene.name,
                "repeat": repeat,
                "cells": cells,
                "draws": draws,
                "release_V": median_release_V(pad, pads, table, flats, scene.device, contact.gap_cutoff_nm),
                "predicted_V": float(np.sqrt(variance["pad.cells"] / cells + variance["pad.draws"] / draws)),
            }


def median_release_V(
    cells: PadCells, pads: list[SampledPad], table: Any, flats: Any, device: Any, cutoff_nm: float
) -> float:
    """Median over the points of the answer; those that cannot be solved are left out."""
    model = release.model_of(cells, pads, table, flats, cutoff_nm)
    points = release.plan_points(table, device, *release.cutoff_range(cutoff_nm, pads))[3]
    solved, _ = release.solve_points(points, model)
    return float(np.median([state["release_V"] for state in solved.values()]))


def figures(table: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Measured and predicted error (V) at each budget."""
    of: dict[str, list[Mapping[str, str]]] = {}
    for row in table:
        of.setdefault(f"{row['scene']}_{row['cells']}_{row['draws']}", []).append(row)
    found = {}
    for name, rows in of.items():
        found[name] = f"{np.std([float(row['release_V']) for row in rows], ddof=1):.2g} V"
        found[f"{name}_predicted"] = f"{float(rows[-1]['predicted_V']):.2g} V"
    return found
