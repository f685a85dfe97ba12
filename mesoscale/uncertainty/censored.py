"""Regression of outputs of which some are known only to lie below zero.

The likelihood of Tobin (Econometrica 26, 24, 1958, doi 10.2307/1907382): a normal density for each known value, the
probability of lying below zero for each other one. It is concave in the coefficients over the scatter and in one over
the scatter (Olsen, Econometrica 46, 1211, 1978, doi 10.2307/1911445), so it has one maximum.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.special import log_ndtr

from mesoscale.errors import InputError
from mesoscale.uncertainty.regression import sparse_chaos
from mesoscale.uncertainty.surrogate import Surrogate, basis_matrix, scaled

Array = NDArray[np.float64]

LEAST_SCATTER = 1e-3
"""Of the known values' deviation: where terms reproduce them exactly, the likelihood would have no maximum."""
KNOWN_PER_TERM = 2
"""Known values a term; with fewer, terms of higher degree are left out."""


def censored_chaos(x: Array, y: Array, below: NDArray[np.bool_], ranges: Array) -> tuple[Surrogate, float]:
    """Sparse Legendre expansion up to degree 2, and the standard deviation about it.

    Terms are selected once, from values that a linear fit expects in place of the unknown ones.

    Parameters
    ----------
    x : inputs of the runs, shape (m, n).
    y : outputs, shape (m,); not read where `below`.
    below : outputs that are known to be below zero, and no more, shape (m,).
    ranges : shape (n, 2).

    Raises
    ------
    InputError : the maximum of the likelihood was not found.
    ValueError : fewer known values than twice the inputs.
    """
    u = np.clip(scaled(x, ranges), -1.0, 1.0)
    width = y[~below].std() or 1.0
    varying = np.ptp(u, axis=0) > 0
    constant = np.zeros((1, len(ranges)), int)
    linear = np.vstack([constant, np.eye(len(ranges), dtype=int)[varying]])
    coefficients, scatter = _most_likely(basis_matrix(u, linear), y / width, below)
    expected = basis_matrix(u, linear) @ coefficients
    filled = np.where(below, expected - scatter * _hazard(-expected / scatter), y / width)
    most_terms = 1 + 2 * varying.sum()
    degree = 2 if (~below).sum() >= KNOWN_PER_TERM * most_terms else 1
    terms = sparse_chaos(x, filled, ranges, degree=degree).degrees
    coefficients, scatter = _most_likely(basis_matrix(u, terms), y / width, below)
    # as in least squares: each term takes one of the known values
    known = (~below).sum()
    scatter *= np.sqrt(known / max(known - len(terms), 1))
    return Surrogate(ranges, terms, coefficients * width), float(scatter * width)


def _hazard(z: Array) -> Array:
    """Normal density over distribution at z: how far below -z, in deviations, values below it are on average."""
    return np.exp(-0.5 * z**2 - 0.5 * np.log(2 * np.pi) - log_ndtr(z))


def _most_likely(matrix: Array, y: Array, below: NDArray[np.bool_]) -> tuple[Array, float]:
    """Coefficients (t,) and scatter of highest likelihood; `matrix` holds the terms at the runs, shape (m, t)."""
    known, unknown = matrix[~below], matrix[below]
    values = y[~below]
    count = len(values)

    def cost(point: Array) -> tuple[float, Array]:
        by_scatter, precision = point[:-1], point[-1]
        if precision <= 0:
            return np.inf, np.zeros_like(point)
        misfit = precision * values - known @ by_scatter
        margin = -unknown @ by_scatter
        smooth = 0.5 * count * (LEAST_SCATTER * precision) ** 2
        value = 0.5 * misfit @ misfit - log_ndtr(margin).sum() - count * np.log(precision) + smooth
        slope = -known.T @ misfit + unknown.T @ _hazard(margin)
        slope_of_precision = values @ misfit - count / precision + count * LEAST_SCATTER**2 * precision
        return float(value), np.append(slope, slope_of_precision)

    def curvature(point: Array) -> Array:
        margin = -unknown @ point[:-1]
        hazard = _hazard(margin)
        weight = hazard * (hazard + margin)
        mixed = -known.T @ values
        block = known.T @ known + (unknown.T * weight) @ unknown
        corner = values @ values + count / point[-1] ** 2 + count * LEAST_SCATTER**2
        return np.block([[block, mixed[:, None]], [mixed[None, :], np.array([[corner]])]])

    start = np.append(np.linalg.lstsq(known, values, rcond=None)[0], 1.0)
    # steps reach scatters down to the least one
    options = {"max_trust_radius": 10 / LEAST_SCATTER, "gtol": 1e-6}
    best = minimize(cost, start, jac=True, hess=curvature, method="trust-exact", options=options)
    if not best.success:
        raise InputError(
            f"pad.points: the fit of {count} voltages beside {len(unknown)} switches that stick did not settle in "
            f"{best.nit} steps; raise pad.points, or narrow the inputs"
        )
    return best.x[:-1] / best.x[-1], float(1 / best.x[-1])
