"""Lengths and noise of a Gaussian process at its largest likelihood.

The process has a linear trend, the correlation of Matérn with exponent 5/2, a length for each
input, and noise. Trend and amplitude follow from lengths and noise, so that these alone are sought.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mesoscale.errors import InputError

Array = NDArray[np.float64]

LENGTHS = (0.05, 4.0)
"""Of inputs between -1 and 1. Beyond the longer an input is as good as linear, which the trend
has."""
NOISES = (1e-5, 10.0)
"""Variance of the noise over that of the process. Below the lower the matrix is near singular."""
START = (2.0, 1e-2)
"""Length and noise at which the search starts."""
LEAST_DEVIATION = 1e-6
"""Of the process over that of the values: a trend that reproduces them leaves none."""
MOST_STEPS = 1000
"""Of the search, which takes 20 to 100."""
SETTLED = 1e-3
"""Slope of the logarithm of the likelihood at which the search has settled: what is sought is then
known to a thousandth of its own error, which is where the logarithm has fallen by 1/2."""


class Likeliest(NamedTuple):
    """The process of highest likelihood.

    Attributes
    ----------
    lengths : of the correlation, by input.
    noise : its variance over the variance of the process.
    amplitude : deviation of the process, without the bias of the trend's freedom.
    log_likelihood : at this maximum.
    """

    lengths: Array
    noise: float
    amplitude: float
    log_likelihood: float


def likeliest(x: Array, y: Array) -> Likeliest:
    """Lengths, noise and amplitude.

    Parameters
    ----------
    x : runs, shape (m, k), each input between -1 and 1.
    y : values, shape (m,).

    Raises
    ------
    InputError : the maximum was not found.
    """
    from scipy.optimize import minimize  # slow to import

    inputs = x.shape[1]
    deviation = float(y.std()) or 1.0
    y = (y - y.mean()) / deviation
    squares = (x[:, None, :] - x[None, :, :]) ** 2
    trend = np.column_stack([np.ones(len(x)), x])
    bounds = np.log([*[LENGTHS] * inputs, NOISES])
    point = np.log([*[START[0]] * inputs, START[1]])
    steps = 0
    while True:
        # it also ends where one step gains nothing by rounding; begun anew from there it goes on
        best = minimize(
            lambda point: _cost(_at(point, squares, trend, y), squares),
            point,
            jac=True,
            method="L-BFGS-B",
            bounds=bounds,
            options={"maxiter": MOST_STEPS - steps, "ftol": 0.0, "gtol": 1e-3 * SETTLED},
        )
        steps += best.nit
        point = np.asarray(best.x, float)
        process = _at(point, squares, trend, y)
        cost, slope = _cost(process, squares)
        # zero at a bound that it presses against
        inwards = np.clip(point - slope, *bounds.T) - point
        if np.abs(inwards).max() <= SETTLED:
            break
        if steps >= MOST_STEPS or not best.nit:
            raise InputError(
                f"the Gaussian process through {len(y)} runs did not settle in {steps} steps; give"
                " more points (pad.points), or narrow the inputs"
            )
    free = max(len(y) - trend.shape[1], 1)
    amplitude = deviation * float(np.sqrt(process.variance * len(y) / free))
    log_likelihood = -cost - len(y) * float(np.log(deviation))
    return Likeliest(process.lengths, process.noise, amplitude, log_likelihood)


class _At(NamedTuple):
    """The process at some lengths and noise.

    Attributes
    ----------
    distances : between runs, times the square root of 5 and over the lengths.
    correlation, inverse : with noise, shape (m, m).
    weights : inverse times what the trend leaves.
    variance : of the process at its largest likelihood.
    """

    lengths: Array
    noise: float
    distances: Array
    correlation: Array
    inverse: Array
    weights: Array
    variance: float


def _at(point: Array, squares: Array, trend: Array, y: Array) -> _At:
    lengths, noise = np.exp(point[:-1]), float(np.exp(point[-1]))
    distances = np.sqrt(5.0 * squares @ lengths**-2.0)
    correlation = (1.0 + distances + distances**2 / 3.0) * np.exp(-distances)
    correlation += noise * np.eye(len(y))
    inverse = np.asarray(np.linalg.inv(correlation), float)
    by_trend = inverse @ trend
    slopes = np.linalg.solve(trend.T @ by_trend, by_trend.T @ y)
    left = y - trend @ slopes
    weights = inverse @ left
    variance = float(left @ weights) / len(y) + LEAST_DEVIATION**2 * float(y.var())
    variance = max(variance, float(np.finfo(float).tiny))
    return _At(lengths, noise, distances, correlation, inverse, weights, variance)


def _cost(at: _At, squares: Array) -> tuple[float, Array]:
    """Negative logarithm of the likelihood, and its slope by logarithms of lengths and noise."""
    runs = len(at.weights)
    log_determinant = np.linalg.slogdet(at.correlation)[1]
    cost = 0.5 * (runs * np.log(2.0 * np.pi * at.variance) + log_determinant + runs)
    # of a change of the correlation
    by_correlation = 0.5 * (at.inverse - np.outer(at.weights, at.weights) / at.variance)
    falling = 5.0 / 3.0 * (1.0 + at.distances) * np.exp(-at.distances)
    of_lengths = np.einsum("ij,ijk->k", by_correlation * falling, squares) * at.lengths**-2.0
    of_noise = at.noise * np.trace(by_correlation)
    return float(cost), np.append(of_lengths, of_noise)
