"""Numbers of a cycle: work of closing and opening, dissipation, pull-off and stiffness."""

import numpy as np

from mesoscale.contact.cycle import Branch, Cycle


def work(branch: Branch, net: bool = False) -> tuple[float, float]:
    """Work of the flat along a branch and its uncertainty, both nN nm (1e-18 J).

    The work is against the repulsion, or that of the net force, as spent on closing and regained on
    opening. Trapezoids; the uncertainty is a third of what leaving out every second point changes,
    as for any rule of second order (Richardson).
    """
    h = branch.separation_nm
    force = branch.net_nN if net else branch.repulsive_nN
    coarse = np.append(np.arange(0, len(h) - 1, 2), len(h) - 1)
    fine = float(np.trapezoid(force, h))
    coarsely = float(np.trapezoid(force[coarse], h[coarse]))
    error = abs(fine - coarsely) / 3.0
    if h[-1] > h[0]:
        return fine, error
    return -fine, error


def dissipated_energy(cycle: Cycle) -> tuple[float, float]:
    """Work lost between closing and opening, and its uncertainty, nN nm (1e-18 J).

    Against the repulsion; where attraction deforms the contact and has an energy (`mechanics:
    adhesive`), of both.
    """
    net = "jump_loss_aJ" in cycle.flags
    (spent, error_spent) = work(cycle.closing, net)
    (regained, error_regained) = work(cycle.opening, net)
    return spent - regained, error_spent + error_regained


def pull_off(opening: Branch) -> float:
    """Largest net attraction on opening, nN; 0 where the surfaces repel each other throughout."""
    return max(-float(opening.net_nN.min()), 0.0)
