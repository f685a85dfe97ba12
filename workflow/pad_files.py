"""Cells and draws of the pad from the files of their chunks."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from mesoscale.device.failure import Population, with_pad_scatter
from mesoscale.device.release import Model, cutoff_range, model_of
from mesoscale.errors import InputError
from mesoscale.inputs.contact import contact_of
from mesoscale.inputs.distributions import InputTable
from mesoscale.inputs.table import from_rows
from mesoscale.pad.cells import grid_of_rows
from mesoscale.pad.curves import PadCells
from mesoscale.pad.draws import laws_of_rows, plan_draws
from mesoscale.pad.memory import Flats, flats_of
from mesoscale.pad.response import SampledPad
from mesoscale.settings import ContactSettings, DeviceSettings, FailureSettings
from workflow.contact_settings import contact_settings
from workflow.job import settings_from_job
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


class Spread(NamedTuple):
    """The pad over everything that is uncertain.

    Attributes
    ----------
    inputs : of the pad.
    cells, flats : at central inputs.
    cutoffs_nm : range of D0.
    model : of the pad at other inputs.
    """

    inputs: InputTable
    cells: PadCells
    flats: Flats
    cutoffs_nm: tuple[float, float]
    model: Model


def load_spread(snakemake: Any, contact: ContactSettings) -> Spread:
    """The pad of a job that has its inputs, grid, chunks and draws, and their `design`."""
    inputs = from_rows(load_csv(snakemake.input.inputs))
    middle, central = contact_of(inputs.medians(), contact)
    flats, cutoff_nm = flats_of(middle, central), central.gap_cutoff_nm
    cells = load_cells(snakemake.input.grid, snakemake.input.chunks, contact.length_nm**2)
    draws = load_draws(snakemake.input.draws, inputs, contact, *snakemake.params.design)
    model = model_of(cells, draws, inputs, flats, cutoff_nm)
    return Spread(inputs, cells, flats, cutoff_range(cutoff_nm, draws), model)


def load_population(snakemake: Any) -> tuple[Population, float, float]:
    """All switches of a job that `load_spread` takes, the deviation of `with_pad_scatter`, the share that may fail.

    Raises
    ------
    InputError : the scene allows no share.
    """
    asked = settings_from_job(FailureSettings, snakemake.params.failure)
    if asked.probability is None:
        raise InputError("failure.probability = null: give the share of the switches that may fail, such as 1e-6")
    contact = contact_settings(snakemake.params.contact, snakemake)
    device = settings_from_job(DeviceSettings, snakemake.params.device)
    pad = load_spread(snakemake, contact)
    population = Population(pad.inputs, device, pad.cutoffs_nm, pad.model, asked.release_V)
    return *with_pad_scatter(population, pad.cells, pad.flats, contact.length_nm**2), asked.probability
