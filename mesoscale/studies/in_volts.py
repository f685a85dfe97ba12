"""What a small error of an input moves in the release of the scene's switch."""

from collections.abc import Callable, Iterable
from dataclasses import replace

import numpy as np

from mesoscale.answer.points import Point
from mesoscale.studies.driver import Array

CHANGE_PERCENT = 5.0
"""Of an input, up and down: well above the noise of a release, and nearly linear."""


def volts_per_percent(
    point: Point, releases: Callable[[Point], Array], names: Iterable[str]
) -> dict[str, float]:
    """Change of the release when an input grows by 1 %, V, for the inputs that the point has.

    Central differences on the same pads. An input whose change leaves no pad with an answer is left
    out.

    Parameters
    ----------
    releases : release on a few pads of a point, V, shape (pads,), NaN where there is none.
    """
    volts = {}
    for name in names:
        if name not in point.values:
            continue
        both_sides = [releases(_changed(point, name, sign * CHANGE_PERCENT)) for sign in (-1, 1)]
        differences = (both_sides[1] - both_sides[0]) / (2 * CHANGE_PERCENT)
        if np.isfinite(differences).any():
            volts[name] = float(np.nanmean(differences))
    return volts


def _changed(point: Point, name: str, percent: float) -> Point:
    return replace(point, values={**point.values, name: point.values[name] * (1 + percent / 100)})
