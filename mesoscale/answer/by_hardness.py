"""Release of the switch at central inputs on contacts that are harder or softer, for rows of the
budget.
"""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from mesoscale.answer.points import Point, press_pad, surfaces_of
from mesoscale.errors import InputError
from mesoscale.settings import ContactSettings
from mesoscale.switch.electrode import release_or_nan_V

HARDNESS = ("h_macro", "h_prime")
FILM = "h_film"


def harder(point: Point, factor: float) -> Point:
    """The point with `factor` times the hardness: that of the film where there is one, else of the
    whole body.
    """
    names = (FILM,) if FILM in point.values else HARDNESS
    scaled = {name: factor * value for name, value in point.values.items() if name in names}
    return replace(point, values=point.values | scaled)


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
            releases[factor] = release_or_nan_V(point.device, pad.law)
    return releases
