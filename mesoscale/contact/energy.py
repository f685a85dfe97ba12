"""Work of closing and opening, and what a cycle dissipates."""

import numpy as np

from mesoscale.contact.cycle import Branch, Cycle


def work(branch: Branch) -> tuple[float, float]:
    """Work against the repulsion along a branch and its uncertainty, both nN nm (1e-18 J) and positive.

    Trapezoids; the uncertainty is a third of what leaving out every second point changes, as for any rule of
    second order (Richardson).
    """
    h, force = branch.separation_nm, branch.repulsive_nN
    coarse = np.append(np.arange(0, len(h) - 1, 2), len(h) - 1)
    fine = float(np.trapezoid(force, h))
    return abs(fine), abs(fine - float(np.trapezoid(force[coarse], h[coarse]))) / 3.0


def dissipated_energy(cycle: Cycle) -> tuple[float, float]:
    """Work lost between closing and opening against the repulsion, and its uncertainty, nN nm (1e-18 J)."""
    (spent, error_spent), (regained, error_regained) = work(cycle.closing), work(cycle.opening)
    return spent - regained, error_spent + error_regained
