"""What a measurement can see of one contact cycle, as a row of numbers with smooth responses.

A curve is given by its separation at the lowest of some net forces and by its steps from one force to the next. From
one surface to another the steps scatter log-normally; an unknown zero of the instrument touches the first number alone.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mesoscale.law.parameters import FITTED, LAW

Array = NDArray[np.float64]

LEVELS = 6
"""Net forces of a curve, evenly in logarithm."""
LOWEST_SHARE, HIGHEST_SHARE = 0.02, 0.5
"""The lowest and the highest as shares of the largest repulsion; attraction keeps net forces below it."""


@dataclass(frozen=True)
class Observable:
    """A number that one surface gives.

    Attributes
    ----------
    name : column of result files.
    unit, scale : what has a response: `length`, its ratio to the RMS height; `log_length`, the logarithm of that;
        `inverse_length`, the inverse of that; `log`.
    """

    name: str
    unit: str
    scale: str


def curve_names(branch: str) -> list[str]:
    """Observables of a branch."""
    return [f"{branch}_begin_nm", *(f"{branch}_step_{k}_nm" for k in range(1, LEVELS))]


def _curve(branch: str) -> tuple[Observable, ...]:
    begin, *steps = curve_names(branch)
    return Observable(begin, "nm", "length"), *(Observable(name, "nm", "log_length") for name in steps)


CURVES = {"closing_curves": "closing", "opening_curves": "opening"}
"""Branch by kind of measurement."""
OBSERVABLES = (
    *_curve("closing"),
    *_curve("opening"),
    Observable("contact_begin_nm", "nm", "inverse_length"),  # hardly skewed so (`first_contact`)
    Observable("pull_off_nN", "nN", "log"),
)
"""What can be measured of a surface."""
LAWS = tuple(
    Observable(name, row.unit, "length" if row.any_sign else "log_length" if row.unit == "nm" else "log")
    for name, row in zip(FITTED, 2 * LAW, strict=True)
)
"""The laws of both branches, behind the switch."""
NAMES = tuple(row.name for row in (*OBSERVABLES, *LAWS))


def force_levels_nN(max_force_nN: float) -> Array:
    """Net forces (nN) of the curves' observables, shape (LEVELS,)."""
    return max_force_nN * np.geomspace(LOWEST_SHARE, HIGHEST_SHARE, LEVELS)
