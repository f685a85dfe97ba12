"""The joint distribution of inputs, D0 and devices as points."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mesoscale.answer.departures import with_properties
from mesoscale.answer.spread import properties_at, typical
from mesoscale.contact.surface import shortest_wave
from mesoscale.inputs.contact import ContactInputs, contact_of
from mesoscale.inputs.distributions import InputTable
from mesoscale.settings import ContactSettings, DeviceSettings

Array = NDArray[np.float64]

HIGHEST_GAP_CUTOFF_NM = 0.3
"""Upper end of a D0 that is no input: a distance of atoms, above Israelachvili's 0.165 nm
(docs/pad.md)."""


@dataclass(frozen=True)
class Point:
    """One switch of the joint distribution.

    Attributes
    ----------
    values : inputs by name.
    gap_cutoff_nm : D0 where it is no input.
    device : settings with its own properties.
    """

    values: dict[str, float]
    gap_cutoff_nm: float
    device: DeviceSettings

    def contact_of(self, contact: ContactSettings) -> tuple[ContactInputs, ContactSettings]:
        """Its inputs of a contact, and the settings of the contact with them put in.

        Raises
        ------
        InputError : inputs that the contact does not accept.
        """
        settings = contact.model_copy(update={"gap_cutoff_nm": self.gap_cutoff_nm})
        return contact_of(self.values, settings)

    def humidity(self, contact: ContactSettings) -> float:
        """Relative humidity around it, of its inputs, else of the contact's air; 0: dry."""
        usual = contact.air.humidity if contact.air else 0.0
        return self.values.get("humidity", usual)


@dataclass(frozen=True)
class Design:
    """Points that fill the joint distribution.

    Attributes
    ----------
    names : of what is drawn, k of them.
    varies : of each of these, whether it is common to all devices, or of each.
    probability : of each at each point, shape (points, k).
    varying : positions of those that do vary.
    """

    names: tuple[str, ...]
    varies: tuple[str, ...]
    probability: Array
    varying: NDArray[np.int_]
    points: tuple[Point, ...]


def cutoff_range(table: InputTable, contact: ContactSettings) -> tuple[float, float]:
    """D0 (nm) of the scene, and the largest that is drawn; the same where D0 is an input."""
    _, settings = contact_of(table.medians(), contact)
    stated = settings.gap_cutoff_nm
    if "gap_cutoff" in table.names:
        return stated, stated
    return stated, max(stated, HIGHEST_GAP_CUTOFF_NM)


def central_point(table: InputTable, contact: ContactSettings, settings: DeviceSettings) -> Point:
    """The switch at the medians of the inputs and in the middle of the range of D0."""
    return Point(table.medians(), float(np.mean(cutoff_range(table, contact))), typical(settings))


def plan_points(
    table: InputTable, contact: ContactSettings, settings: DeviceSettings, count: int
) -> Design:
    """Points of a Latin hypercube over inputs, D0 and properties of the device."""
    from scipy.stats import qmc  # slow to import

    names = (*table.names, "gap_cutoff_nm", *settings.varied)
    units = qmc.LatinHypercube(len(names), rng=0).random(count)
    values = values_at(units, table, settings, cutoff_range(table, contact))
    points = tuple(point_of(row, table.names, settings) for row in values)
    varying = np.flatnonzero(np.ptp(values, axis=0) > 0) if count else np.arange(0)
    return Design(names, kinds(table, settings), units, varying, points)


def kinds(table: InputTable, settings: DeviceSettings) -> tuple[str, ...]:
    """Of inputs, D0 and the `varied` properties of the device: common to all devices, or of
    each.
    """
    of_device = [getattr(settings.spread, name).varies for name in settings.varied]
    return (*(row.varies for row in table.rows), "common", *of_device)


def values_at(
    units: Array, table: InputTable, settings: DeviceSettings, cutoffs_nm: tuple[float, float]
) -> Array:
    """Inputs, D0 (nm) and the `varied` properties of the device at probabilities; both of shape (m,
    k).
    """
    inputs = len(table.rows)
    low, high = cutoffs_nm
    return np.column_stack(
        [
            table.transform(units[:, :inputs]),
            low + (high - low) * units[:, inputs],
            properties_at(settings, units[:, inputs + 1 :]),
        ]
    )


def point_of(row: Array, names: Sequence[str], settings: DeviceSettings) -> Point:
    """The switch of a row of `values_at`."""
    inputs = len(names)
    values = dict(zip(names, row[:inputs].tolist(), strict=True))
    return Point(values, float(row[inputs]), with_properties(settings, row[inputs + 1 :]))


def on_pad_grid(contact: ContactSettings, table: InputTable) -> ContactSettings:
    """The contact on the coarsest of its halved grids that still holds all waves of the inputs.

    The release of `reduced` moves by 0.03 V from 128 to 512 sites a side, at a fiftieth of the time
    (docs/pad.md). Without a cut-off the grid itself is one, and stays.
    """
    if "q1" in table.names:
        shortest = float(table.rows[table.names.index("q1")].distribution.span()[1])
    elif contact.q1_per_nm is not None:
        shortest = shortest_wave(contact)
    else:
        return contact
    while contact.pixels % 2 == 0:
        half = contact.model_copy(update={"pixels": contact.pixels // 2})
        if half.nyquist_per_nm < shortest:
            break
        contact = half
    return contact
