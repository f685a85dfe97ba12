"""Cells and draws of the pad from the files of their chunks."""

from collections.abc import Sequence

import numpy as np

from mesoscale.inputs.distributions import InputTable
from mesoscale.pad.cells import grid_of_rows
from mesoscale.pad.curves import PadCells
from mesoscale.pad.draws import laws_of_rows, plan_draws
from mesoscale.pad.response import SampledPad
from mesoscale.settings import ContactSettings
from workflow.results import load_csv, load_h5, load_numbers


def load_cells(grid: str, chunks: Sequence[str], cell_area_nm2: float) -> PadCells:
    """The cells of pad/cells/ (nN) at the separations of pad/grid.csv."""
    groups = [load_h5(path)[0]["cells"] for path in chunks]
    return PadCells(
        grid_of_rows(load_numbers(grid)),
        np.concatenate([group["first_contact_nm"] for group in groups]),
        np.concatenate([group["closing_nN"] for group in groups]) / cell_area_nm2,
        np.concatenate([group["opening_nN"] for group in groups]) / cell_area_nm2,
        np.concatenate([group["settled"] for group in groups]).astype(bool),
    )


def load_draws(
    files: Sequence[str], inputs: InputTable, contact: ContactSettings, count: int, cells: int
) -> list[SampledPad]:
    """The pads of pad/draws/ with their inputs; so many draws, each of so many cells."""
    draws = plan_draws(inputs, contact, count, cells)
    curves = laws_of_rows((row for path in files for row in load_csv(path)), draws, contact)
    return [
        SampledPad(draw.values, draw.gap_cutoff_nm, cells, curve) for draw, curve in zip(draws, curves, strict=True)
    ]
