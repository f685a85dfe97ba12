"""How many switches stick if one property of the device were another.

Where a notable share sticks, the switch at central inputs may let go, so that its reserve says
nothing of them. Each point is solved again on its own pad, with its own departures.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from mesoscale.answer.other_devices import value_of
from mesoscale.answer.points import Point, plan_points
from mesoscale.answer.switches import PadModel
from mesoscale.inputs.distributions import InputTable
from mesoscale.settings import ContactSettings, DeviceSettings
from mesoscale.settings.device import unit_of
from mesoscale.switch import release_or_nan_V

NOTABLE_SHARE = 0.05
"""That sticks, from which on a cure is sought. Where as many let go, `reserve` says it."""
FACTORS = (0.7, 1.4)
"""On a property that is tried."""
STRESSES_MPA = (-20.0, 20.0)
"""On top of the residual stress, which may be 0."""


def sticking_by_key(
    model: PadModel, table: InputTable, contact: ContactSettings, device: DeviceSettings
) -> list[dict[str, Any]]:
    """The share of switches that sticks, by the property of the device that is another.

    The pads stay as they were pressed. A switch that then has no answer counts as one that sticks.

    Parameters
    ----------
    table, contact : of the points, the contact on the grid of the pads.
    device : as stated.

    Returns
    -------
    Rows of the properties that free some, the least share first: `key`, its `unit`, its stated
    `value`, the `other` one, and the share that is then `stuck`. No rows where few stick or nearly
    all, or where the device was measured, which tells of no other one.
    """
    solved = [model.points[k] for k in model.solved]
    share = float(np.mean([point.sticks for point in solved])) if solved else 0.0
    if device.measured or not NOTABLE_SHARE <= share <= 1.0 - NOTABLE_SHARE:
        return []
    pull_in_V = float(np.median(model.states("pull_in_V")))
    rows = []
    for key in device.designed:
        value = value_of(device, key, pull_in_V)
        row = {"key": key, "unit": unit_of(key), "value": value}
        for other in _other_values(key, value):
            changed = device.model_copy(update={key: other})
            points = plan_points(table, contact, changed, len(model.points)).points
            stuck = _share_that_sticks(model, points)
            if stuck < share:
                rows.append(row | {"other": other, "stuck": stuck})
    return sorted(rows, key=lambda row: row["stuck"])


def _other_values(key: str, value: float) -> list[float]:
    if key == "residual_stress_MPa":
        return [value + stress for stress in STRESSES_MPA]
    return [value * factor for factor in FACTORS]


def _share_that_sticks(model: PadModel, points: Sequence[Point]) -> float:
    """Of the solved switches, with other devices; 1 where none of those that stick is freed."""
    stuck = [k for k in model.solved if model.points[k].sticks]
    free = [k for k in model.solved if not model.points[k].sticks]
    still_stuck = [k for k in stuck if not _lets_go(model, k, points[k])]
    if len(still_stuck) == len(stuck):  # the others can only make it worse
        return 1.0
    newly_stuck = [k for k in free if not _lets_go(model, k, points[k])]
    return (len(still_stuck) + len(newly_stuck)) / len(model.solved)


def _lets_go(model: PadModel, number: int, point: Point) -> bool:
    curves = model.points[number].pressed.curves
    return release_or_nan_V(point.device, curves, coarse=True) > 0.0
