"""The contact settings of a job, with the description of the surface that the measurements chose."""

from typing import Any

from mesoscale.settings import ContactSettings
from workflow.job import settings_from_job
from workflow.results import load_json


def contact_settings(given: dict[str, Any], snakemake: Any) -> ContactSettings:
    """Settings of the scene; where it takes the surface from measurements and gives no spectrum or heights, theirs.

    Parameters
    ----------
    given : section `contact` of the scene.
    snakemake : of the job; its input `topography` is topography/parameters.json, or absent.
    """
    path = snakemake.input.get("topography")
    described = load_json(path).get("surface", {}) if path else {}
    stated = given["surface"]
    settings = settings_from_job(ContactSettings, given)
    if not described or any(stated[key] for key in ("spectrum", "heights", "moments")):
        return settings
    return ContactSettings(**{**given, "surface": {**stated, **described}})
