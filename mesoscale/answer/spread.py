"""By how much devices depart from their stated properties, as uncertain inputs."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from mesoscale.answer.departures import (
    departed_properties,
    stated_departures,
    with_properties,
)
from mesoscale.errors import InputError
from mesoscale.inputs.distributions import InputTable
from mesoscale.settings import DeviceSettings

Array = NDArray[np.float64]


def departures(settings: DeviceSettings) -> InputTable:
    """Departures from the stated properties, narrowed by what was measured.

    Raises
    ------
    InputError : samples that cannot be read; measurements that contradict the stated device.
    """
    if settings.measured is None:
        return stated_departures(settings)
    from mesoscale.answer.measured import narrowed  # compiles

    return narrowed(settings).table


def properties_at(settings: DeviceSettings, units: Array) -> Array:
    """Values of the properties of `DeviceSettings.varied` at probabilities; both of shape (m,
    k).
    """
    table = departures(settings)
    moved = table.transform(units) if table.rows else np.empty((len(units), 0))
    return departed_properties(settings, moved)


def typical(settings: DeviceSettings) -> DeviceSettings:
    """The device in the middle of what is known of it, departing by what remains unknown.

    It is as stated where nothing was measured. Else each property departs by a normal distribution
    of its own.
    """
    if settings.measured is None:
        return settings
    middle = np.full((1, len(settings.varied)), 0.5)
    device = with_properties(settings, properties_at(settings, middle)[0])
    remaining = {}
    for row in departures(settings).rows:
        spread = getattr(settings.spread, row.name)
        deviation = float(row.distribution.values.std())
        if spread.relative:
            deviation *= abs(getattr(settings, row.name) / getattr(device, row.name))
        narrow = {"distribution": "normal", "values": (0.0, deviation), "source": row.source}
        remaining[row.name] = spread.model_copy(update=narrow)
    return device.model_copy(update={"spread": settings.spread.model_copy(update=remaining)})


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
