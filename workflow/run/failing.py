"""The population of switches whose failures a job looks for."""

from typing import Any

import numpy as np

from mesoscale.device.points import Pad, Point, press_pad, surfaces_of
from mesoscale.errors import InputError
from mesoscale.failure.rate import Population
from mesoscale.settings import FailureSettings
from workflow.run.job import settings_from_job
from workflow.run.pads import load_model, points_of_job

FIRST_SURFACES = 100_000
"""Beyond those of the points of an answer."""


def load_population(snakemake: Any) -> tuple[Population, float, float]:
    """All switches of a job that has the pad, the share that may fail, and the confidence that no more do.

    Raises
    ------
    InputError : the scene allows no share, or has no points.
    """
    asked = settings_from_job(FailureSettings, snakemake.params.failure)
    if asked.probability is None:
        raise InputError("failure.probability = null: give the share of the switches that may fail, such as 1e-6")
    points, pad = points_of_job(snakemake)
    model = load_model([snakemake.input.model], points)

    def press(point: Point, times: int, number: int) -> Pad:
        return press_pad(point, points.on_grid, times * pad.point_cells, surfaces_of(FIRST_SURFACES + number))

    solved = [(units, one.pad) for units, one in zip(points.design.probability, model.points, strict=True) if one.pad]
    known = points.design.probability[:0] if not solved else np.array([units for units, _ in solved])
    pads = [of for _, of in solved]
    population = Population(points.table, points.device, points.cutoffs_nm, asked.release_V, press, (known, pads))
    return population, asked.probability, asked.confidence
