"""Sparse-grid collocation: the paper's level-1 response with its elementary effects, and level 2.

Clenshaw-Curtis nodes on [-1, 1]^n. Level 1 is the centre plus both ends of every axis: 2n + 1 nodes. Level 2
adds the inner points of the five-point rule on every axis and the corners of every pair of axes.
"""

from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations, product

import numpy as np
from numpy.typing import NDArray

from mesoscale.uncertainty.surrogate import Surrogate, basis_matrix

Array = NDArray[np.float64]


def nodes(inputs: int, level: int) -> Array:
    """Nodes in [-1, 1]^n, shape (node_count, n); row 0 is the centre, rows 2k+1, 2k+2 the ends of axis k."""
    rows = [np.zeros(inputs)]
    for k in range(inputs):
        rows += [_on_axis(inputs, {k: end}) for end in (-1.0, 1.0)]
    if level == 2:
        inner = np.sqrt(0.5)
        for k in range(inputs):
            rows += [_on_axis(inputs, {k: end}) for end in (-inner, inner)]
        for i, j in combinations(range(inputs), 2):
            rows += [_on_axis(inputs, {i: s, j: t}) for s, t in product((-1.0, 1.0), repeat=2)]
    return np.array(rows)


def _on_axis(inputs: int, values: dict[int, float]) -> Array:
    row = np.zeros(inputs)
    for k, value in values.items():
        row[k] = value
    return row


def to_values(u: Array, ranges: Array) -> Array:
    """Scaled points (m, n) in [-1, 1] to values of the inputs; the centre is the middle of each range."""
    low, high = ranges[:, 0], ranges[:, 1]
    return low + (u + 1) / 2 * (high - low)


def level1_response(y: Array, ranges: Array) -> Surrogate:
    """The paper's linear response from the 15 nodes.

    u_0 = (1 - n/3) y_0 + sum_i (y_i+ + y_i-) / 6 is the level-1 quadrature of the mean and
    u_i = (y_i+ - y_i-) / 2.

    Parameters
    ----------
    y : output at the nodes of level 1, shape (2n + 1,), in the order of `nodes`; NaN anywhere gives NaN.
    """
    inputs = len(ranges)
    lower, upper = y[1::2][:inputs], y[2::2][:inputs]
    constant = (1 - inputs / 3) * y[0] + (lower + upper).sum() / 6
    degrees = np.vstack([np.zeros((1, inputs), int), np.eye(inputs, dtype=int)])
    return Surrogate(ranges, degrees, np.concatenate([[constant], (upper - lower) / 2]))


def elementary_effects(y: Array, inputs: int) -> Array:
    """mu* per input, shape (n,): mean size of the elementary effects between neighbouring nodes, inputs on [0, 1].

    With the nodes y0 in the middle, y1 and y2 at the ends, half the range apart: mu* = abs(y0 - y1) + abs(y2 - y0).
    """
    lower, upper = y[1::2][:inputs], y[2::2][:inputs]
    return np.abs(y[0] - lower) + np.abs(upper - y[0])


@dataclass(frozen=True)
class _Interpolation:
    degrees: NDArray[np.int_]
    inverse: Array


@lru_cache(maxsize=4)
def _interpolation(inputs: int, level: int) -> _Interpolation:
    """Terms that the sparse grid determines, and the matrix from node values to their coefficients."""
    eye = np.eye(inputs, dtype=int)
    highest = 2 if level == 1 else 4
    degrees = [np.zeros(inputs, int), *(power * row for row in eye for power in range(1, highest + 1))]
    if level == 2:
        for i, j in combinations(range(inputs), 2):
            degrees += [s * eye[i] + t * eye[j] for s, t in product((1, 2), repeat=2)]
    terms = np.array(degrees)
    return _Interpolation(terms, np.asarray(np.linalg.inv(basis_matrix(nodes(inputs, level), terms)), float))


def interpolating_response(y: Array, ranges: Array, level: int, transform: str = "identity") -> Surrogate:
    """The polynomial through all node values; its mean equals the sparse-grid quadrature.

    Parameters
    ----------
    y : output at the nodes, shape (node_count,); with transform `log` it must be positive.
    """
    rule = _interpolation(len(ranges), level)
    values = np.log(y) if transform == "log" else y
    return Surrogate(ranges, rule.degrees, rule.inverse @ values, transform)
