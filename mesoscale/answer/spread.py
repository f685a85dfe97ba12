"""By how much devices depart from their stated properties, as uncertain inputs."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from mesoscale.errors import InputError
from mesoscale.inputs.distributions import InputTable, UncertainInput
from mesoscale.inputs.table import stated_distribution
from mesoscale.settings import DeviceSettings
from mesoscale.settings.device import unit_of

Array = NDArray[np.float64]


def departures(settings: DeviceSettings) -> InputTable:
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


def properties_at(settings: DeviceSettings, units: Array) -> Array:
    """Values of the properties of `DeviceSettings.varied` at probabilities; both of shape (m,
    k).
    """
    table = departures(settings)
    moved = table.transform(units) if table.rows else np.empty((len(units), 0))
    stated = np.array([getattr(settings, name) for name in table.names])
    relative = np.array([getattr(settings.spread, name).relative for name in table.names], bool)
    return np.where(relative, stated * (1.0 + moved), stated + moved)


def with_properties(settings: DeviceSettings, values: Array) -> DeviceSettings:
    """The device with these values of the properties of `DeviceSettings.varied`, shape (k,)."""
    return settings.model_copy(update=dict(zip(settings.varied, values.tolist(), strict=True)))


def departed(
    settings: DeviceSettings, probability: float
) -> Iterator[tuple[str, DeviceSettings, DeviceSettings]]:
    """Each property that varies, and the devices where it alone departs to this probability and to
    its complement.
    """
    names = settings.varied
    for place, name in enumerate(names):
        units = np.full((2, len(names)), 0.5)
        units[:, place] = 1.0 - probability, probability
        low, high = (with_properties(settings, values) for values in properties_at(settings, units))
        yield name, low, high


def check_spread(settings: DeviceSettings) -> None:
    """Check that the device stays one over the central share of each departure.

    Raises
    ------
    InputError : a property leaves what is accepted for it; samples that cannot be read.
    """
    for row in departures(settings).rows:
        stated = getattr(settings, row.name)
        relative = getattr(settings.spread, row.name).relative
        for moved in row.distribution.span():
            value = stated * (1.0 + moved) if relative else stated + moved
            try:
                DeviceSettings(**{row.name: value})
            except InputError as error:
                why = str(error).rpartition(": ")[2]
                raise InputError(
                    f"device.spread.{row.name}: reaches {row.name} = {value:.4g}: {why}; narrow or"
                    " truncate it"
                ) from None
