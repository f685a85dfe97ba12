"""The paper's sparse-grid collocation of level 1: nodes, linear response, elementary effects."""

import numpy as np
from numpy.typing import NDArray

from mesoscale.uncertainty.surrogate import Surrogate

Array = NDArray[np.float64]


def nodes(inputs: int) -> Array:
    """Nodes in [-1, 1]^n, (2n + 1, n); row 0 is the centre, rows 2k+1, 2k+2 end axis k."""
    rows = np.zeros((2 * inputs + 1, inputs))
    axes = np.arange(inputs)
    rows[2 * axes + 1, axes] = -1.0
    rows[2 * axes + 2, axes] = 1.0
    return rows


def to_values(u: Array, ranges: Array) -> Array:
    """Scaled points (m, n) in [-1, 1] to values of the inputs; the centre is mid-range."""
    low = ranges[:, 0]
    high = ranges[:, 1]
    return low + (u + 1) / 2 * (high - low)


def level1_response(y: Array, ranges: Array) -> Surrogate:
    """The paper's linear response from the 15 nodes.

    u_0 = (1 - n/3) y_0 + sum_i (y_i+ + y_i-) / 6 is the level-1 quadrature of the mean and
    u_i = (y_i+ - y_i-) / 2.

    Parameters
    ----------
    y : output at the nodes, shape (2n + 1,), in the order of `nodes`; NaN anywhere gives NaN.
    """
    inputs = len(ranges)
    lower = y[1::2]
    upper = y[2::2]
    constant = (1 - inputs / 3) * y[0] + (lower + upper).sum() / 6
    linear = np.eye(inputs, dtype=int)
    degrees = np.vstack([np.zeros((1, inputs), int), linear])
    return Surrogate(ranges, degrees, np.concatenate([[constant], (upper - lower) / 2]))


def elementary_effects(y: Array) -> Array:
    """mu* per input, (n,): mean elementary effect between neighbouring nodes, inputs on [0, 1].

    With the nodes y0 in the middle, y1 and y2 at the ends, half the range apart: mu* = abs(y0 - y1)
    + abs(y2 - y0).
    """
    below = np.abs(y[0] - y[1::2])
    above = np.abs(y[2::2] - y[0])
    return below + above
