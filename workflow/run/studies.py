"""The studies of the stages, each from what its job reads: rows of accuracy/STAGE.csv and stability/STAGE.csv."""

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

from mesoscale.inputs.contact import ContactInputs, contact_of
from mesoscale.inputs.table import medians
from mesoscale.settings import ContactSettings
from mesoscale.studies import answer_accuracy, answer_stability, contact_accuracy, contact_stability, pad_accuracy
from mesoscale.studies.driver import Progress, StudyRow, stability_rows
from workflow.files.results import load_csv
from workflow.run.contact_settings import contact_settings
from workflow.run.pads import load_model, points_of_job

Study = Callable[[Any, Progress], Iterator[StudyRow]]
"""Takes Snakemake's job and the progress."""


def central_contact(snakemake: Any) -> tuple[ContactInputs, ContactSettings]:
    """Inputs of a contact at their medians, and its settings."""
    central = medians(load_csv(snakemake.input.inputs))
    return contact_of(central, contact_settings(snakemake.params.contact, snakemake))


def accuracy_of_contact(snakemake: Any, progress: Progress) -> Iterator[StudyRow]:
    """Of one cycle at central inputs; where the scene has a switch, of its release, too."""
    pads = None
    if path := snakemake.input.get("model"):
        points, pad = points_of_job(snakemake)
        central = load_model([path], points).central
        of_point = partial(
            contact_accuracy.releases_on_pads, central.point, central.pressed.cells.grid, pad.point_cells
        )
        pads = points.on_grid, of_point
    return contact_accuracy.accuracy_points(*central_contact(snakemake), pads, progress)


def stability_of_contact(snakemake: Any, progress: Progress) -> Iterator[StudyRow]:
    """The extreme cases around central inputs."""
    return stability_rows(contact_stability.hard_cases(*central_contact(snakemake)), progress)


def accuracy_of_pad(snakemake: Any, progress: Progress) -> Iterator[StudyRow]:
    """Of pads at central inputs, and of the number of points."""
    points, pad = points_of_job(snakemake)
    model = load_model([snakemake.input.model], points)
    return pad_accuracy.accuracy_points(model, points.on_grid, pad.point_cells, progress)


def accuracy_of_answer(snakemake: Any, progress: Progress) -> Iterator[StudyRow]:
    """Of the beam, on pads of the scene."""
    points, _ = points_of_job(snakemake)
    return answer_accuracy.accuracy_points(load_model([snakemake.input.model], points), progress)


def stability_of_answer(snakemake: Any, progress: Progress) -> Iterator[StudyRow]:
    """Hard beams, and the scene's device at its extremes."""
    points, _ = points_of_job(snakemake)
    central = load_model([snakemake.input.model], points).central
    return stability_rows(answer_stability.hard_cases(points.device, central.pressed.law), progress)


STUDIES: dict[tuple[str, str], Study] = {
    ("accuracy", "contact"): accuracy_of_contact,
    ("stability", "contact"): stability_of_contact,
    ("accuracy", "pad"): accuracy_of_pad,
    ("accuracy", "answer"): accuracy_of_answer,
    ("stability", "answer"): stability_of_answer,
}
