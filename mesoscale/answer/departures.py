"""Departures of devices from their stated properties, as the scene states them."""

import numpy as np
from numpy.typing import NDArray

from mesoscale.inputs.distributions import InputTable, UncertainInput
from mesoscale.inputs.table import stated_distribution
from mesoscale.settings import DeviceSettings
from mesoscale.settings.device import unit_of

Array = NDArray[np.float64]


def stated_departures(settings: DeviceSettings) -> InputTable:
    """Departures from the stated properties, each in its unit or as a share.

    Raises
    ------
    InputError : samples that cannot be read.
    """
    rows = []
    for name in settings.varied:
        row = getattr(settings.spread, name)
        given = stated_distribution(name, row, "device.spread")
        unit = "1" if row.relative else unit_of(name)
        rows.append(UncertainInput(name, unit, given, "literature", row.source, row.varies))
    return InputTable(tuple(rows), np.eye(len(rows)))


def departed_properties(settings: DeviceSettings, moved: Array) -> Array:
    """Values of the properties of `DeviceSettings.varied` that depart so far; both of shape (m,
    k).
    """
    names = settings.varied
    stated = np.array([getattr(settings, name) for name in names])
    relative = np.array([getattr(settings.spread, name).relative for name in names], bool)
    return np.where(relative, stated * (1.0 + moved), stated + moved)


def with_properties(settings: DeviceSettings, values: Array) -> DeviceSettings:
    """One device, with these values of the properties of `DeviceSettings.varied`, shape (k,)."""
    known = dict(zip(settings.varied, values.tolist(), strict=True))
    return settings.model_copy(update=known | {"measured": None})
