"""Release of the switch at central inputs if one thing were another: a property of the device, for
who designs it, the mark of a C-V curve that counts as release, or the hardness of the contact, for
rows of the budget.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from mesoscale.answer.points import Point
from mesoscale.answer.switches import press_pad, surfaces_of
from mesoscale.errors import InputError
from mesoscale.pad.curves import PadCurves
from mesoscale.settings import ContactSettings, DeviceSettings
from mesoscale.switch import release_or_nan_V, switch_of

FACTORS = (0.7, 0.85, 1.2, 1.4)
"""On a property of the device."""
STRESSES_MPA = (-20.0, -10.0, 10.0, 20.0)
"""On top of the residual stress, which may be 0."""
SHARES = (0.75, 0.5, 0.25)
"""Of the held capacitance, whose voltages the page names."""
HARDNESS_OF_BODY = ("h_macro", "h_prime")
HARDNESS_OF_FILM = ("h_film",)


def release_by_key(device: DeviceSettings, pad: PadCurves) -> list[dict[str, Any]]:
    """What the switch does where one property differs and all else stays: the pad was pressed at
    central inputs.

    From the device's own value outwards, until the switch has no answer: this row has a reason and
    no voltages. `continued` says that the pad is pressed harder than it was computed, so that its
    curves are continued; `own` is the device itself. Without an answer of its own there is nothing
    to compare with, and no row.
    """
    try:
        voltages_here = _voltages(device, pad)
    except InputError:
        return []
    rows = []
    for key in device.designed:
        value = value_of(device, key, voltages_here["pull_in_V"])
        values = _other_values(key, value)
        below = [other for other in values if other < value]
        above = [other for other in values if other > value]
        rows += [*_outwards(device, pad, key, below[::-1])][::-1]
        rows.append({"key": key, "value": value, **voltages_here, "own": True})
        rows += _outwards(device, pad, key, above)
    return rows


def _other_values(key: str, value: float) -> list[float]:
    """Values of a property that are tried, rising."""
    if key == "residual_stress_MPa":
        return [value + stress for stress in STRESSES_MPA]
    return [value + value * (factor - 1.0) for factor in FACTORS]


def _outwards(
    device: DeviceSettings, pad: PadCurves, key: str, values: Sequence[float]
) -> Iterator[dict[str, Any]]:
    """Rows of values of a property, up to the first without an answer."""
    for value in values:
        row = {"key": key, "value": value, "own": False}
        try:
            yield row | _voltages(device.model_copy(update={key: value}), pad)
        except InputError as error:
            unknown = {"pull_in_V": None, "release_V": None, "continued": False}
            yield row | unknown | {"reason": str(error)}
            return


def _voltages(device: DeviceSettings, pad: PadCurves) -> dict[str, Any]:
    """What a device does on a pad."""
    states = switch_of(device).states(pad)
    return {
        "pull_in_V": states.pull_in_V,
        "release_V": states.release_V,
        "continued": states.deepened,
        "reason": "",
    }


def value_of(device: DeviceSettings, key: str, pull_in_V: float) -> float:
    """The device's own value; of what it leaves open, what follows from the rest."""
    value = getattr(device, key)
    return float(pull_in_V if value is None else value)


def by_capacitance(device: DeviceSettings, pad: PadCurves) -> list[dict[str, Any]]:
    """Voltages at which the capacitance has fallen to a share of that while held, and of the jump.

    Returns
    -------
    Rows with `release_at` and `release_V`, which is None where the switch has no answer.
    """
    rows = []
    for share in ("jump", *SHARES):
        other = device.model_copy(update={"release_at": share})
        release_V = release_or_nan_V(other, pad)
        known = release_V if np.isfinite(release_V) else None
        rows.append({"release_at": share, "release_V": known})
    return rows


def release_by_hardness(
    point: Point, contact: ContactSettings, cells: int, factors: Iterable[float]
) -> dict[float, float]:
    """Release (V) by factor on the hardness, 1 among them; all pads have the same surfaces.

    Parameters
    ----------
    contact : on the grid of the pads.
    cells : of each pad.

    Returns
    -------
    Releases, 0 where the switch sticks, NaN where it has no answer.
    """
    releases = {}
    for factor in dict.fromkeys((1.0, *factors)):
        try:
            pad = press_pad(harder(point, factor), contact, cells, surfaces_of(0))
        except InputError:  # softer than its base, for instance
            releases[factor] = np.nan
        else:
            releases[factor] = release_or_nan_V(point.device, pad.curves)
    return releases


def harder(point: Point, factor: float) -> Point:
    """The point with `factor` times the hardness: that of the film where there is one, else of the
    whole body.
    """
    has_film = set(HARDNESS_OF_FILM) <= point.values.keys()
    names = HARDNESS_OF_FILM if has_film else HARDNESS_OF_BODY
    scaled = {name: factor * value for name, value in point.values.items() if name in names}
    return replace(point, values=point.values | scaled)
