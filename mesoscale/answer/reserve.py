"""How much attraction the switch at central inputs bears, and what frees one that sticks.

A switch that sticks has no release, so nothing can be said of it in volts. It is said by the factor
on its attraction with which it would just let go, and by the value of each property with which it
does.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from mesoscale.answer.other_devices import value_of
from mesoscale.answer.spread import departed
from mesoscale.answer.switches import Solved, press_pad, surfaces_of
from mesoscale.errors import InputError
from mesoscale.pad.curves import PadCurves
from mesoscale.settings import ContactSettings, DeviceSettings
from mesoscale.settings.device import unit_of
from mesoscale.switch import States, switch_of
from mesoscale.switch.reserve import Attracted

TIMES_STEP = 0.02
"""Difference of logarithms to which the factor on the attraction is known."""
FURTHEST = 3.0
"""Factor on a property up to which it is tried, on both sides."""
FURTHEST_MPA = 200.0
"""The same of the residual stress, which may be 0, as a sum."""
TRIED = 8
"""Values of a property of the device that are tried up to there, on each side."""
NEAR = 0.01
"""Error of a value that frees, over the larger end of the range in which it is sought."""
Frees = Callable[[float], bool]
"""Whether a value frees the switch.

Raises
------
InputError : the switch then has no answer, for instance since it never closes.
"""


def central_reserve(central: Solved) -> dict[str, Any] | None:
    """The reserve of the switch at central inputs; None where it has no answer.

    One that sticks takes half a minute, so that the page before the end goes without.
    """
    if central.states is None or central.pad is None:
        return None
    return reserve_of(central.point.device, central.pad.curves, central.states)


def reserve_of(device: DeviceSettings, pad: PadCurves, states: States) -> dict[str, Any]:
    """The reserve of a switch; where it sticks also what moves it, and what of its device frees it.

    Parameters
    ----------
    states : of the device on this pad.

    Returns
    -------
    bears_times : factor on the attraction of the pad with which the switch just sticks; below 1
        where it does.
    moved_by : rows of the properties of the device that vary: `key`, and the same factor at their
        5 and 95 % as `low` and `high`.
    freed_by : rows as `freed_by_device` gives them.
    """
    reserve = {"bears_times": bears_times(device, pad), "moved_by": [], "freed_by": []}
    if states.release_V == 0.0:
        reserve["moved_by"] = [
            {
                "key": name,
                "low": bears_times(low, pad, coarse=True),
                "high": bears_times(high, pad, coarse=True),
            }
            for name, low, high in departed(device, 0.95)
        ]
        reserve["freed_by"] = list(freed_by_device(device, pad, states.pull_in_V))
    return reserve


def bears_times(device: DeviceSettings, pad: PadCurves, coarse: bool = False) -> float:
    """Factor on the attraction of a pad with which a switch just sticks."""
    return float(np.exp(Attracted(device, pad, 0.0, coarse).reserve(TIMES_STEP)))


def freed_by_device(
    device: DeviceSettings, pad: PadCurves, pull_in_V: float
) -> Iterator[dict[str, Any]]:
    """For each designed property the value, nearest to its own, that frees a switch which sticks.

    The pad stays as it was pressed, and is continued where the changed switch presses harder.

    Returns
    -------
    Rows with `key`, its `unit`, its own `value`, and `frees`; None where no value in reach does.
    """
    for key in device.designed:
        value = value_of(device, key, pull_in_V)

        def frees(other: float, key: str = key) -> bool:
            changed = device.model_copy(update={key: other})
            return switch_of(changed).states(pad).release_V > 0.0

        edge = _nearest_edge(frees, value, _values_around(key, value))
        yield {"key": key, "unit": unit_of(key), "value": value, "frees": edge}


def freed_by_surface(
    central: Solved, contact: ContactSettings, cells: int
) -> Iterator[dict[str, Any]]:
    """The same of roughness and humidity: each value that is tried presses a pad of its own.

    Parameters
    ----------
    contact : on the grid of the pads.
    cells : of each pad.
    """
    point = central.point
    humidity = point.humidity(contact)
    for key, unit, value, end in (
        ("rms", "nm", point.values.get("rms", 0.0), FURTHEST * point.values.get("rms", 0.0)),
        ("humidity", "1", humidity, 0.0),
    ):
        if value == 0.0:  # a surface of scans has no RMS among its inputs; the air is dry
            continue

        def frees(other: float, key: str = key) -> bool:
            changed = replace(point, values=point.values | {key: other})
            pad = press_pad(changed, contact, cells, surfaces_of(0))
            return switch_of(point.device).states(pad.curves).release_V > 0.0

        edge = _edge_between(frees, value, end)
        yield {"key": key, "unit": unit, "value": value, "frees": edge}


def _values_around(key: str, value: float) -> list[list[float]]:
    """Values of a property of the device that are tried below and above its own, outwards."""
    steps = np.arange(1, TRIED + 1) / TRIED
    if key == "residual_stress_MPa":
        return [(value + sign * FURTHEST_MPA * steps).tolist() for sign in (-1.0, 1.0)]
    return [(value * FURTHEST ** (sign * steps)).tolist() for sign in (-1.0, 1.0)]


def _nearest_edge(
    frees: Frees, value: float, directions: Sequence[Sequence[float]]
) -> float | None:
    """The edge in the direction that frees after the fewest steps; None where neither does."""
    inner = [value for _ in directions]
    ended = [False for _ in directions]
    for others in zip(*directions, strict=True):
        for side, other in enumerate(others):
            if ended[side]:
                continue
            try:
                if frees(other):
                    return _edge_between(frees, inner[side], other)
            except InputError:  # it no longer closes, or the pad does not carry it
                ended[side] = True
            inner[side] = other
    return None


def _edge_between(frees: Frees, sticks_at: float, end: float) -> float | None:
    """The value nearest to one that sticks which still frees; None where the other end does not.

    Sought by halving, to `NEAR` of the range's larger end.
    """
    try:
        if not frees(end):
            return None
    except InputError:
        return None
    while abs(end - sticks_at) > NEAR * max(abs(end), abs(sticks_at)):
        middle = 0.5 * (sticks_at + end)
        try:
            freed = frees(middle)
        except InputError:
            freed = False
        if freed:
            end = middle
        else:
            sticks_at = middle
    return end
