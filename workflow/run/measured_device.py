"""pad/measured.h5: what measurements of the open device leave of its properties."""

import json
from collections.abc import Mapping
from typing import Any

import numpy as np

from mesoscale.answer.measured import Narrowed, narrowed, of_draws, remember
from mesoscale.settings import DeviceSettings
from workflow.files.results import Dataset, load_h5, write_h5
from workflow.schemas import UnfitTable


def write_measured(path: str, settings: DeviceSettings, provenance: Mapping[str, Any]) -> Narrowed:
    """Narrow the device, and write draws of its posterior."""
    posterior = narrowed(settings)
    draws = Dataset(
        posterior.z,
        "1",
        "standard normal numbers behind the departures of `properties`, drawn from the posterior",
        ("draw", "property"),
    )
    attributes = {
        "device": _text_of(settings),
        "properties": list(settings.varied),
        "stated": json.dumps(posterior.stated),
        "missed": json.dumps(posterior.missed),
        "doubt": posterior.doubt,
    }
    write_h5(path, {"/": {"z": draws}}, attributes, provenance)
    return posterior


def remember_measured(path: str, settings: DeviceSettings) -> None:
    """Take the posterior of a file for all that this process asks of the device.

    Raises
    ------
    UnfitTable : it is of another device, or none that a run wrote.
    """
    groups, attributes, _ = load_h5(path)
    z = groups.get("/", {}).get("z", np.empty(0))
    shaped = z.ndim == 2 and z.shape[1] == len(settings.varied)
    if not shaped or not np.isfinite(z).all() or attributes.get("device") != _text_of(settings):
        raise UnfitTable(f"{path}: not of this device; delete it and run again")
    stated = {name: tuple(pair) for name, pair in json.loads(attributes["stated"]).items()}
    missed = json.loads(attributes["missed"])
    remember(settings, of_draws(settings, z, stated, str(attributes["doubt"]), missed))


def _text_of(settings: DeviceSettings) -> str:
    """The device as text that tells it from another."""
    return settings.model_dump_json()
