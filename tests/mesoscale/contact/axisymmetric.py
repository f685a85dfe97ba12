"""A body of revolution on an adhesive half-space, ring by ring: shares neither grid nor method with
the engine.

Uniform pressure on a disc displaces the half-space by complete elliptic integrals (K. L. Johnson,
Contact Mechanics, 1985, eq. 3.29). The stresses t of all rings follow from one Newton iteration:
rings in contact have no gap, all others t = -s(gap).
"""

import numpy as np
from numpy.typing import NDArray
from scipy.special import ellipe, ellipk

Array = NDArray[np.float64]


def compliance(edges: Array, e_star: float) -> Array:
    """Displacement (nm) amid rings from a pressure of 1 GPa on each, shape (n, n); edges (n + 1,)
    in nm.
    """
    middle = 0.5 * (edges[1:] + edges[:-1])
    r, a = middle[:, None], edges[None, :]
    inner, outer = np.minimum(r, a), np.maximum(r, a)
    m = (inner / outer) ** 2
    inside = a * ellipe(m)
    outside = r * (ellipe(m) - (1.0 - m) * ellipk(m))
    return np.diff(4.0 / (np.pi * e_star) * np.where(r < a, inside, outside), axis=1)


def branch(gap: Array, edges: Array, e_star: float, strength: float, cutoff: float) -> Array:
    """Net forces (nN, repulsion positive) where 1, 2, 3 .. rings touch, stable or not, to well
    beyond the least.

    The last ring that touches is about to part: no gap, and the full attraction. So the approach is
    an unknown, too.

    Parameters
    ----------
    gap : of the undeformed bodies amid the rings where they touch, nm, shape (n,)
    strength : attraction at touch, GPa: s = strength (D0 / (g + D0))^3 with D0 the cut-off in nm
    """
    size = gap.size
    # of the stresses and the approach
    matrix = np.column_stack([compliance(edges, e_star), -np.ones(size)])
    area = np.pi * np.diff(edges**2)
    unknown = np.zeros(size + 1)
    forces = []
    # to begin with, the attraction rises
    steps = [(1, share * strength) for share in np.geomspace(0.01, 1.0, 30)]
    steps += [(touching, strength) for touching in range(2, size)]
    for touching, now_strength in steps:
        for _ in range(50):
            now = gap + matrix @ unknown
            walls = np.maximum(now, -0.5 * cutoff) + cutoff
            pull = now_strength * (cutoff / walls) ** 3
            apart = np.arange(size) >= touching
            rows = np.where(
                apart[:, None],
                -3.0 * (pull / walls)[:, None] * matrix + np.eye(size, size + 1),
                matrix,
            )
            edge = np.zeros(size + 1)
            edge[touching - 1] = 1.0
            missing = np.append(
                np.where(apart, unknown[:-1] + pull, now), unknown[touching - 1] + now_strength
            )
            change = np.linalg.solve(np.vstack([rows, edge]), -missing)
            unknown = unknown + change
            if np.abs(change[:-1]).max() < 1e-9 * strength:
                break
        else:
            break
        forces.append(float(unknown[:-1] @ area))
        if touching > 1 and forces[-1] > 0.9 * min(forces[29:]):
            break
    return np.array(forces[29:])
