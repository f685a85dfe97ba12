"""The studies of the stages, each from what its job reads: rows of accuracy/STAGE.csv and
stability/STAGE.csv.
"""

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

from mesoscale.contact.numerics import NUMERICS
from mesoscale.inputs.contact import ContactInputs, contact_of
from mesoscale.inputs.table import from_rows, medians
from mesoscale.settings import ContactSettings, TopographySettings, UncertaintySettings
from mesoscale.studies import (
    contact_accuracy,
    contact_stability,
    topography_accuracy,
    topography_files,
    topography_stability,
    uncertainty_accuracy,
    uncertainty_stability,
)
from mesoscale.studies.driver import Progress, StudyRow, stability_rows
from mesoscale.studies.in_volts import volts_per_percent
from mesoscale.topography.roughness_spectrum import slope_from_hurst
from mesoscale.uncertainty.propagation import nodes_of_rows
from mesoscale.uncertainty.validation import direct_runs_of_rows
from workflow.files.results import load_csv
from workflow.run.central_pads import central_pads
from workflow.run.contact_settings import contact_settings
from workflow.run.job import settings_from_job
from workflow.run.studies_of_atoms import STUDIES_OF_ATOMS
from workflow.run.studies_of_switch import STUDIES_OF_SWITCH

Study = Callable[[Any, Progress], Iterator[StudyRow]]
"""Takes Snakemake's job and the progress."""


def central_contact(snakemake: Any) -> tuple[ContactInputs, ContactSettings]:
    """Inputs of a contact at their medians, and its settings."""
    central = medians(load_csv(snakemake.input.inputs))
    return contact_of(central, contact_settings(snakemake.params.contact, snakemake))


def accuracy_of_topography(snakemake: Any, progress: Progress) -> Iterator[StudyRow]:
    """Of the analysis of scans, on synthetic ones of known truth."""
    settings = settings_from_job(TopographySettings, snakemake.params.topography)
    volts = {}
    if pads := central_pads(snakemake):
        point, on_grid, releases = pads
        volts = volts_per_percent(
            point, lambda moved: releases(moved, on_grid, NUMERICS), ("q0", "hurst", "rms")
        )
        if "hurst" in volts:
            hurst = point.values["hurst"]
            # 1 % of a slope 2 H + c is 1 % of slope / 2 H of the exponent
            volts["slope"] = (
                volts["hurst"] * slope_from_hurst(hurst, settings.convention) / (2 * hurst)
            )
    return topography_accuracy.accuracy_points(settings, volts, progress)


def stability_of_topography(snakemake: Any, progress: Progress) -> Iterator[StudyRow]:
    """Scans and files of known truth, damaged or unusual."""
    settings = settings_from_job(TopographySettings, snakemake.params.topography)
    cases = [*topography_stability.hard_cases(settings), *topography_files.hard_cases()]
    return stability_rows(cases, progress)


def accuracy_of_contact(snakemake: Any, progress: Progress) -> Iterator[StudyRow]:
    """Of one cycle at central inputs; where the scene has a switch, of its release, too."""
    pads = None
    if central := central_pads(snakemake):
        point, on_grid, releases = central
        pads = on_grid, partial(releases, point)
    return contact_accuracy.accuracy_points(*central_contact(snakemake), pads, progress)


def stability_of_contact(snakemake: Any, progress: Progress) -> Iterator[StudyRow]:
    """The extreme cases around central inputs."""
    return stability_rows(contact_stability.hard_cases(*central_contact(snakemake)), progress)


def accuracy_of_uncertainty(snakemake: Any, progress: Progress) -> Iterator[StudyRow]:
    """Of the scene's own direct runs and nodes."""
    settings = settings_from_job(UncertaintySettings, snakemake.params.uncertainty)
    table = from_rows(load_csv(snakemake.input.inputs))
    contact = contact_settings(snakemake.params.contact, snakemake)
    direct, again = (
        direct_runs_of_rows(
            (row for path in paths for row in load_csv(path)), table.names, settings.direct_runs
        )
        for paths in (snakemake.input.direct, snakemake.input.again)
    )
    nodes = nodes_of_rows(load_csv(snakemake.input.parameters))
    return uncertainty_accuracy.accuracy_points(
        direct, again[1], nodes, table, contact, settings, progress
    )


def stability_of_uncertainty(_snakemake: Any, progress: Progress) -> Iterator[StudyRow]:
    """Unusual inputs and outputs of the propagation."""
    return stability_rows(uncertainty_stability.hard_cases(), progress)


STUDIES: dict[tuple[str, str], Study] = {
    **STUDIES_OF_ATOMS,
    **STUDIES_OF_SWITCH,
    ("accuracy", "topography"): accuracy_of_topography,
    ("stability", "topography"): stability_of_topography,
    ("accuracy", "contact"): accuracy_of_contact,
    ("stability", "contact"): stability_of_contact,
    ("accuracy", "uncertainty"): accuracy_of_uncertainty,
    ("stability", "uncertainty"): stability_of_uncertainty,
}
