"""The studies of pad, answer, circuit, failure and lifetime: rows of their tables of accuracy and
stability.
"""

from collections.abc import Callable, Iterator
from typing import Any

from mesoscale.settings import LifetimeSettings
from mesoscale.studies import (
    answer_accuracy,
    answer_stability,
    circuit_accuracy,
    circuit_stability,
    failure_accuracy,
    failure_stability,
    lifetime_accuracy,
    lifetime_stability,
    pad_accuracy,
    pad_stability,
)
from mesoscale.studies.driver import Progress, StudyRow, stability_rows
from workflow.run.job import settings_from_job
from workflow.run.pads import load_model, points_of_job, population_of_job


def accuracy_of_pad(snakemake: Any, progress: Progress) -> Iterator[StudyRow]:
    """Of pads at central inputs, and of the number of points."""
    points, pad = points_of_job(snakemake)
    model = load_model([snakemake.input.model], points)
    return pad_accuracy.accuracy_points(model, points.on_grid, pad.point_cells, progress)


def stability_of_pad(snakemake: Any, progress: Progress) -> Iterator[StudyRow]:
    """Hard cells and pads around central inputs."""
    points, _ = points_of_job(snakemake)
    inputs, contact = points.by_number[0].contact_of(points.on_grid)
    return stability_rows(pad_stability.hard_cases(inputs, contact), progress)


def accuracy_of_answer(snakemake: Any, progress: Progress) -> Iterator[StudyRow]:
    """Of the beam, on pads of the scene."""
    points, _ = points_of_job(snakemake)
    return answer_accuracy.accuracy_points(load_model([snakemake.input.model], points), progress)


def stability_of_answer(snakemake: Any, progress: Progress) -> Iterator[StudyRow]:
    """Hard beams, and the scene's device at its extremes."""
    points, _ = points_of_job(snakemake)
    central = load_model([snakemake.input.model], points).central
    return stability_rows(
        answer_stability.hard_cases(points.device, central.pressed.curves), progress
    )


def accuracy_of_circuit(snakemake: Any, progress: Progress) -> Iterator[StudyRow]:
    """Of lumps and tables, on pads of the scene."""
    points, _ = points_of_job(snakemake)
    return circuit_accuracy.accuracy_points(load_model([snakemake.input.model], points), progress)


def stability_of_circuit(snakemake: Any, progress: Progress) -> Iterator[StudyRow]:
    """Hard beams as lumps, and hard pads as tables."""
    points, _ = points_of_job(snakemake)
    central = load_model([snakemake.input.model], points).central
    cases = circuit_stability.hard_cases(central.point, points.on_grid, central.pressed.curves)
    return stability_rows(cases, progress)


def accuracy_of_failure(snakemake: Any, progress: Progress) -> Iterator[StudyRow]:
    """Of the probability that the scene allows."""
    return failure_accuracy.accuracy_points(*population_of_job(snakemake), progress)


def stability_of_failure(snakemake: Any, progress: Progress) -> Iterator[StudyRow]:
    """Rare, certain and impossible failures."""
    population, _ = population_of_job(snakemake)
    return stability_rows(failure_stability.hard_cases(population), progress)


def accuracy_of_lifetime(snakemake: Any, progress: Progress) -> Iterator[StudyRow]:
    """Of the shift of held switches of the scene."""
    points, _ = points_of_job(snakemake)
    settings = settings_from_job(LifetimeSettings, snakemake.params.lifetime)
    model = load_model([snakemake.input.model], points)
    return lifetime_accuracy.accuracy_points(model, points.on_grid, settings, progress)


def stability_of_lifetime(_snakemake: Any, progress: Progress) -> Iterator[StudyRow]:
    """Extreme lives of made-up switches."""
    return stability_rows(list(lifetime_stability.hard_cases()), progress)


STUDIES_OF_SWITCH: dict[tuple[str, str], Callable[[Any, Progress], Iterator[StudyRow]]] = {
    ("accuracy", "pad"): accuracy_of_pad,
    ("stability", "pad"): stability_of_pad,
    ("accuracy", "answer"): accuracy_of_answer,
    ("stability", "answer"): stability_of_answer,
    ("accuracy", "circuit"): accuracy_of_circuit,
    ("stability", "circuit"): stability_of_circuit,
    ("accuracy", "failure"): accuracy_of_failure,
    ("stability", "failure"): stability_of_failure,
    ("accuracy", "lifetime"): accuracy_of_lifetime,
    ("stability", "lifetime"): stability_of_lifetime,
}
