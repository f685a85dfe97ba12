"""Intervals of fitted parameters that hold what they claim, from the scatter of the points of the curve itself.

A branch is resampled evenly before it is fitted, so neighbouring values on the fine grid share points of the curve and
are not independent (`LawFit.covariance` treats them as if they were). Here the noise of the points is modelled, by
maximum likelihood: a part that is constant and a part in proportion to the force, with neighbours correlated. It is
carried through the resampling to the parameters.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

CONSTANT_SHARES = (0.0, 1e-4, 1e-3, 1e-2, 0.1, 0.5, 1.0)
"""Shares of the noise that are constant, among which the likelihood chooses; the rest is in proportion to the force."""
MOST_CORRELATED = 0.95
"""Correlation of neighbours beyond which a curve of some 40 points no longer tells noise from misfit."""


@dataclass(frozen=True)
class Estimate:
    """A parameter with its error; intervals are those of Student's t, on the logarithm for a positive parameter.

    Attributes
    ----------
    value : the parameter, with the error of the resampling taken off.
    error : standard error, relative for a positive parameter.
    freedom : degrees of freedom of that error.
    positive : whether the interval is made on the logarithm.
    """

    value: float
    error: float
    freedom: float
    positive: bool

    def interval(self, share: float) -> tuple[float, float]:
        """Ends of the interval that holds the parameter with probability `share`."""
        from scipy.stats import t  # slow to import

        arm = float(t.ppf(0.5 * (1.0 + share), self.freedom)) * self.error
        if self.positive:
            return self.value * float(np.exp(-arm)), self.value * float(np.exp(arm))
        return self.value - arm, self.value + arm


NO_ESTIMATE = Estimate(np.nan, np.nan, 1.0, False)


def estimates(
    at: ArrayLike,
    measured: ArrayLike,
    model_at: ArrayLike,
    jacobian_at: Array,
    grid: Array,
    model_on_grid: Array,
    jacobian: Array,
    weights: Array,
    values: ArrayLike,
    positive: bool,
) -> list[Estimate]:
    """Parameters of a weighted fit on an even grid, with errors from the scatter of the points it was made of.

    Parameters
    ----------
    at, measured : points of the curve, rising in `at`, shape (n,).
    model_at, jacobian_at : fitted model there and its derivatives by the parameters, shapes (n,) and (n, p).
    grid, model_on_grid, jacobian, weights : the same on the grid that was fitted, shapes (m,), (m,), (m, p), (m,).
    values : fitted parameters, shape (p,).
    """
    at, measured, model_at = (np.asarray(x, float) for x in (at, measured, model_at))
    count = len(np.atleast_1d(values))
    if at.size <= count + 1:
        return [NO_ESTIMATE] * count
    spread = np.stack([np.interp(grid, at, unit) for unit in np.eye(at.size)], axis=1)
    # columns of one size: parameters differ by orders of magnitude
    sizes = np.linalg.norm(weights[:, None] * jacobian, axis=0)
    if not ((sizes > 0).all() and np.abs(model_at).max() > 0):
        return [NO_ESTIMATE] * count
    influence = (np.linalg.pinv(weights[:, None] * jacobian / sizes) * weights) / sizes[:, None]
    carried = influence @ spread
    # the resampled model is not the model on the grid; to first order this moved the parameters
    value = np.asarray(values, float) - influence @ (spread @ model_at - model_on_grid)
    residual = measured - model_at - jacobian_at @ (value - values)
    used = np.abs(spread).sum(axis=0) > 0
    noise, freedom = _noise(residual[used], model_at[used], jacobian_at[used])
    covariance = carried[:, used] @ noise @ carried[:, used].T
    errors = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    return [
        Estimate(float(v), float(e / abs(v)) if positive and v > 0 else float(e), freedom, positive)
        if v > 0 or not positive
        else NO_ESTIMATE
        for v, e in zip(value, errors, strict=True)
    ]


def _noise(residual: Array, model: Array, jacobian: Array) -> tuple[Array, float]:
    """Covariance of the noise of the points, shape (n, n), and its degrees of freedom.

    A fit with weights of its own leaves its errors in the residuals, largest where the noise is small. So the residuals
    of each noise are those of the parameters that fit best by it, to first order.
    """
    n, count = jacobian.shape
    force, largest = np.abs(model), float(np.max(np.abs(model)))
    best, deviation, scaled = np.inf, np.ones(n), np.zeros(n)
    for constant in CONSTANT_SHARES:
        shape = np.sqrt(constant * largest**2 + (1.0 - constant) * force**2 + (1e-6 * largest) ** 2)
        weighted = jacobian / shape[:, None]
        weighted /= np.maximum(np.linalg.norm(weighted, axis=0), 1e-300)
        left = residual / shape
        left = left - weighted @ np.linalg.lstsq(weighted, left)[0]
        size = max(float(np.sqrt(left @ left / max(n - count, 1))), 1e-300)
        unlikely = 2.0 * float(np.sum(np.log(size * shape)))
        if unlikely < best:
            best, deviation, scaled = unlikely, size * shape, left / size
    # the residuals of a fit are less correlated than the noise: E = r - (p + 3 r) / n (Kendall, Biometrika 41, 403)
    seen = float(scaled[1:] @ scaled[:-1] / max(scaled @ scaled, 1e-300))
    neighbours = min(max((seen + count / n) / (1.0 - min(3.0 / n, 0.5)), 0.0), MOST_CORRELATED)
    distance = np.abs(np.subtract.outer(np.arange(n), np.arange(n)))
    independent = (n - count) * (1.0 - neighbours) / (1.0 + neighbours)
    return np.outer(deviation, deviation) * neighbours**distance, max(independent, 1.0)
