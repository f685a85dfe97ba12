"""The observables of a computed contact cycle."""

import numpy as np
from numpy.typing import NDArray

from mesoscale.calibration.observables import NAMES, force_levels_nN
from mesoscale.contact import Cycle
from mesoscale.contact.cycle import Branch
from mesoscale.law.branches import fit_cycle

Array = NDArray[np.float64]


def observe(cycle: Cycle, max_force_nN: float) -> dict[str, float]:
    """All numbers of a cycle by name; NaN where the cycle does not give one."""
    forces = force_levels_nN(max_force_nN)
    values = []
    for branch in (cycle.closing, cycle.opening):
        separations = separations_at(branch, forces)
        values += [separations[0], *(separations[:-1] - separations[1:])]
    deepest = float(-cycle.opening.net_nN.min())
    values += [cycle.first_contact_nm, deepest if deepest > 0 else np.nan]
    outcome = fit_cycle(cycle)
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
