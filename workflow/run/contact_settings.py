"""The contact settings of a job, with the description of the surface that the measurements
chose.
"""

from collections.abc import Mapping
from typing import Any

from mesoscale.settings import ContactSettings, SceneContact
from workflow.files.results import load_json
from workflow.run.job import settings_from_job


def contact_settings(contact: dict[str, Any], snakemake: Any) -> ContactSettings:
    """Settings of the scene; where it takes the surface from measurements, their cell, and their
    spectrum and heights.

    Parameters
    ----------
    contact : section `contact` of the scene.
    snakemake : of the job; its input `topography` is topography/parameters.json, or absent.
    """
    path = snakemake.input.get("topography")
    described = load_json(path) if path else {}
    return contact_on(settings_from_job(SceneContact, contact), described)


def contact_on(contact: SceneContact, described: Mapping[str, Any]) -> ContactSettings:
    """The settings on a surface.

    Parameters
    ----------
    described : content of topography/parameters.json; empty without measurements.
    """
    settings = ContactSettings(**dict(contact), surface=described.get("surface", {}))
    return settings.on_cell(described.get("cell_nm", settings.length_nm))
