"""What a measurement can see of one contact cycle, as a row of numbers with smooth responses.

A curve is given by its separation at the lowest of some net forces and by its steps from one force to the next. From
one surface to another the steps scatter log-normally; an unknown zero of the instrument touches the first number alone.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mesoscale.contact import Cycle
from mesoscale.contact.cycle import Branch
from mesoscale.law.branches import fit_cycle
from mesoscale.law.parameters import FITTED, LAW
from mesoscale.settings import LawSettings

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


def observe(cycle: Cycle, law: LawSettings, max_force_nN: float) -> dict[str, float]:
    """All numbers of a cycle by name; NaN where the cycle does not give one."""
    forces = force_levels_nN(max_force_nN)
    values = []
    for branch in (cycle.closing, cycle.opening):
        separations = separations_at(branch, forces)
        values += [separations[0], *(separations[:-1] - separations[1:])]
    deepest = float(-cycle.opening.net_nN.min())
    values += [cycle.first_contact_nm, deepest if deepest > 0 else np.nan]
    outcome = fit_cycle(cycle, law)
    values += [*outcome.closing.parameters, *outcome.opening.parameters]
    return dict(zip(NAMES, map(float, values), strict=True))


def separations_at(branch: Branch, forces_nN: Array) -> Array:
    """Separations (nm) at which the net force first reaches given ones, coming from afar; NaN where it never does.

    Parameters
    ----------
    forces_nN : rising, positive, shape (k,).
    """
    order = np.argsort(branch.separation_nm, kind="stable")[::-1]
    separation = branch.separation_nm[order]
    # a force-controlled instrument passes over a drop of the force
    net = np.maximum.accumulate(branch.net_nN[order])
    positive = net > 0
    if positive.sum() < 2:
        return np.full(len(forces_nN), np.nan)
    net, separation = net[positive], separation[positive]
    keep = np.concatenate([[True], np.diff(net) > 0])
    log_net, separation = np.log(net[keep]), separation[keep]
    return np.interp(np.log(forces_nN), log_net, separation, left=separation[0], right=np.nan)
