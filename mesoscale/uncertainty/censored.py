"""Regression of outputs of which some are known only to lie below zero.

The likelihood of Tobin (Econometrica 26, 24, 1958, doi 10.2307/1907382): a normal density for each
known value, the probability of lying below zero for each other one. It is concave in the
coefficients over the scatter and in one over the scatter (Olsen, Econometrica 46, 1211, 1978, doi
10.2307/1911445), so it has one maximum.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import log_ndtr

from mesoscale.errors import InputError
from mesoscale.uncertainty.regression import sparse_chaos
from mesoscale.uncertainty.surrogate import Surrogate, basis_matrix, scaled

Array = NDArray[np.float64]

LEAST_SCATTER = 1e-3
"""Of the known values: where terms reproduce them exactly, the likelihood would have no maximum."""
MOST_STEPS = 1000
"""Of the search, which takes 5 to 20."""
LAST_STEPS = 2
"""Of Newton behind the search, which ends a millionth off: they end at rounding."""
KNOWN_PER_TERM = 2
"""Known values a term; with fewer, terms of higher degree are left out."""


@dataclass(frozen=True)
class Censored:
    """Most likely coefficients where some values are known only to lie below zero.

    Attributes
    ----------
    coefficients, covariance : of the terms, and their error, shapes (t,) and (t, t).
    scatter : standard deviation about them; each term takes one of the known values, as in least
        squares.
    values : known ones, and the expected ones of the others, shape (m,); least squares of these
        give the coefficients.
    """

    coefficients: Array
    covariance: Array
    scatter: float
    values: Array


def censored_chaos(
    x: Array, y: Array, below: NDArray[np.bool_], ranges: Array
) -> tuple[Surrogate, float]:
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
    varying = np.ptp(u, axis=0) > 0
    constant = np.zeros((1, len(ranges)), int)
    linear = np.vstack([constant, np.eye(len(ranges), dtype=int)[varying]])
    filled = most_likely(basis_matrix(u, linear), y, below).values
    most_terms = 1 + 2 * varying.sum()
    # a degree that the known values determine
    degree = 1
    if (~below).sum() >= KNOWN_PER_TERM * most_terms:
        degree = 2
    terms = sparse_chaos(x, filled, ranges, degree=degree).degrees
    fit = most_likely(basis_matrix(u, terms), y, below)
    return Surrogate(ranges, terms, fit.coefficients), fit.scatter


def most_likely(matrix: Array, y: Array, below: NDArray[np.bool_]) -> Censored:
    """Coefficients of highest likelihood.

    Parameters
    ----------
    matrix : terms at the runs, shape (m, t); their known rows have rank t.
    y, below : as `censored_chaos` takes them.

    Raises
    ------
    InputError : the maximum was not found.
    """
    unit = np.sqrt(np.mean(y[~below] ** 2))
    by_scatter, precision = _maximum(matrix[~below], matrix[below], y[~below] / unit)
    scatter = unit / precision
    coefficients = by_scatter * scatter
    fitted = matrix @ coefficients
    hazard = _hazard(-fitted / scatter)
    weight = np.where(below, hazard * (hazard - fitted / scatter), 1.0)
    known = (~below).sum()
    scatter_of_known = scatter * np.sqrt(known / max(known - matrix.shape[1], 1))
    covariance = np.linalg.pinv((matrix.T * weight) @ matrix, hermitian=True) * scatter_of_known**2
    values = np.where(below, fitted - scatter * hazard, y)
    return Censored(coefficients, covariance, float(scatter_of_known), values)


def _hazard(z: Array) -> Array:
    """Normal density over distribution at z: deviations that values below -z lie below it."""
    log_density = -0.5 * z**2 - 0.5 * np.log(2 * np.pi)
    return np.exp(log_density - log_ndtr(z))


def _maximum(known: Array, unknown: Array, values: Array) -> tuple[Array, float]:
    """Coefficients over the scatter, and one over the scatter, at the largest likelihood."""
    from scipy.optimize import minimize  # slow to import

    count = len(values)

    def cost(point: Array) -> tuple[float, Array]:
        by_scatter = point[:-1]
        precision = point[-1]
        if precision <= 0:
            return np.inf, np.zeros_like(point)
        misfit = precision * values - known @ by_scatter
        margin = -unknown @ by_scatter
        smooth = 0.5 * count * (LEAST_SCATTER * precision) ** 2
        value = 0.5 * misfit @ misfit - log_ndtr(margin).sum() - count * np.log(precision) + smooth
        slope = -known.T @ misfit + unknown.T @ _hazard(margin)
        slope_of_precision = (
            values @ misfit - count / precision + count * LEAST_SCATTER**2 * precision
        )
        return float(value), np.append(slope, slope_of_precision)

    def curvature(point: Array) -> Array:
        margin = -unknown @ point[:-1]
        hazard = _hazard(margin)
        weight = hazard * (hazard + margin)
        mixed = -known.T @ values
        block = known.T @ known + (unknown.T * weight) @ unknown
        corner = values @ values + count / point[-1] ** 2 + count * LEAST_SCATTER**2
        upper = [block, mixed[:, None]]
        lower = [mixed[None, :], np.array([[corner]])]
        return np.block([upper, lower])

    start = np.append(np.linalg.lstsq(known, values, rcond=None)[0], 1.0)
    # steps reach scatters down to the least one
    options = {"max_trust_radius": 10 / LEAST_SCATTER, "gtol": 1e-6, "maxiter": MOST_STEPS}
    best = minimize(cost, start, jac=True, hess=curvature, method="trust-exact", options=options)
    if not best.success:
        raise InputError(
            f"pad.points: the fit of {count} voltages beside {len(unknown)} switches that stick did"
            f" not settle in {best.nit} steps; raise pad.points, or narrow the inputs"
        )
    point = np.asarray(best.x, float)
    for _ in range(LAST_STEPS):
        step = np.linalg.solve(curvature(point), cost(point)[1])
        point = np.asarray(point - step, float)
    return point[:-1], float(point[-1])
