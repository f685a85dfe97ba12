"""The contact settings of a job, with the description of the surface that the measurements
chose.
"""

from typing import Any

from mesoscale.settings import ContactSettings, SceneContact
from workflow.files.results import load_json
from workflow.run.job import settings_from_job


def contact_settings(contact: dict[str, Any], snakemake: Any) -> ContactSettings:
    """Settings of the scene; where it takes the surface from measurements, their cell, and their
    spectrum and heights.

    Parameters
    ----------
    given : section `contact` of the scene.
    snakemake : of the job; its input `topography` is topography/parameters.json, or absent.
    """
    path = snakemake.input.get("topography")
    described = load_json(path) if path else {}
    settings = ContactSettings(
        **dict(settings_from_job(SceneContact, contact)), surface=described.get("surface", {})
    )
    return settings.on_cell(described.get("cell_nm", settings.length_nm))
