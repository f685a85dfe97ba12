"""What a measurement can see of one contact cycle, as a row of numbers with smooth responses.

A curve is given by its separation at the lowest of some net forces and by its steps from one force
to the next. From one surface to another the steps scatter log-normally; an unknown zero of the
instrument touches the first number alone.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

# each job of a run reads the names of observables, and these bring all of the contact
if TYPE_CHECKING:
    from mesoscale.contact import Cycle
    from mesoscale.contact.cycle import Branch
    from mesoscale.settings import ContactSettings
    from mesoscale.uncertainty.designs import Run

Array = NDArray[np.float64]

LEVELS = 6
"""Net forces of a curve, evenly in logarithm."""
CURVES = {"closing_curves": "closing", "opening_curves": "opening"}
"""Branch by kind of measurement."""
SCALARS = {"contact_begin": "contact_begin_nm", "pull_off": "pull_off_nN"}
"""Observable by kind of measurement."""


def curve_names(branch: str) -> list[str]:
    """Observables of a branch."""
    return [f"{branch}_begin_nm", *(f"{branch}_step_{k}_nm" for k in range(1, LEVELS))]


NAMES = (*curve_names("closing"), *curve_names("opening"), *SCALARS.values())
"""What can be measured of a surface."""


def enter_by_logarithm(names: Sequence[str]) -> NDArray[np.bool_]:
    """Observables that scatter log-normally: all but separations, which have no zero."""
    return np.array([name not in ("closing_begin_nm", "opening_begin_nm") for name in names])


def force_levels_nN(max_force_nN: float) -> Array:
    """Net forces (nN) of the curves' observables, (LEVELS,); below the largest repulsion."""
    return max_force_nN * np.geomspace(0.02, 0.5, LEVELS)


def observe(cycle: "Cycle", max_force_nN: float) -> dict[str, float]:
    """All observables of a cycle by name; NaN where the cycle does not give one."""
    values = []
    for branch in (cycle.closing, cycle.opening):
        separations = separations_at(branch, force_levels_nN(max_force_nN))
        values += [separations[0], *(separations[:-1] - separations[1:])]
    deepest = float(-cycle.opening.net_nN.min())
    values += [cycle.first_contact_nm, deepest if deepest > 0 else np.nan]
    return dict(zip(NAMES, map(float, values), strict=True))


def separations_at(branch: "Branch", forces_nN: Array) -> Array:
    """Separations (nm) where the net force first reaches levels from afar; NaN where it never does.

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
    net = net[positive]
    separation = separation[positive]
    keep = np.concatenate([[True], np.diff(net) > 0])
    log_net = np.log(net[keep])
    separation = separation[keep]
    return np.interp(np.log(forces_nN), log_net, separation, left=separation[0], right=np.nan)


@dataclass(frozen=True)
class Cycles:
    """Contact cycles behind the responses.

    Attributes
    ----------
    x : inputs, shape (m, n).
    y : observables in the order of NAMES, shape (m, k); NaN where missing.
    """

    x: Array
    y: Array

    def of(self, names: Sequence[str]) -> Array:
        """Observables, (m, len(names)), in logarithms where they enter so; NaN where missing."""
        y = self.y[:, [NAMES.index(name) for name in names]]
        by_logarithm = enter_by_logarithm(names)
        positive = np.where(~by_logarithm | (y > 0), np.abs(y), np.nan)
        return np.where(by_logarithm, np.log(positive), y)

    def __add__(self, other: "Cycles") -> "Cycles":
        """These and further ones."""
        x = np.vstack([self.x, other.x])
        return Cycles(x, np.vstack([self.y, other.y]))


def observe_runs(
    runs: Sequence["Run"],
    contact: "ContactSettings",
    progress: Callable[[float, str], None] | None = None,
) -> list[dict[str, float]]:
    """Compute cycles: one row each with seed, inputs and observables; NaN where a cycle failed."""
    from mesoscale.uncertainty.runs import compute_all

    rows = []
    for run, cycle in compute_all(runs, contact, progress):
        if isinstance(cycle, str):
            seen = dict.fromkeys(NAMES, np.nan)
        else:
            seen = observe(cycle, contact.max_force_nN)
        rows.append({"run": run.index, "seed": run.seed, **run.values, **seen})
    return rows


def cycles_of_rows(rows: Sequence[Mapping[str, Any]], names: Sequence[str]) -> Cycles:
    """Cycles from rows of `observe_runs`, or the same as text, with inputs of these names."""

    def number(text: Any) -> float:
        return float(text) if text != "" else np.nan

    def columns(chosen: Sequence[str]) -> Array:
        return np.array([[number(row[name]) for name in chosen] for row in rows])

    return Cycles(columns(names), columns(NAMES))
