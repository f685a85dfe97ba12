"""A measured first contact, normal in nm, where its observable is the inverse of it.

First contacts of surfaces are extremes: their inverse scatters normally (skewness -0.1; 0.4 of the logarithm, 0.7 of
themselves). Its likelihood is not normal then. A normal distribution stands for it, so that it joins the other data of
its surface, and what that gets wrong is integrated over the scatter of the first contact and put right.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

NODES, REACH = 2001, 8.0
"""Points behind the moments, and how many deviations they reach."""
HERMITE = 16
SMALLEST_PRECISION_SHARE = 1e-6
"""Of the datum beside the prior: keeps one that teaches nothing regular."""


@dataclass(frozen=True)
class FirstContacts:
    """Measured first contacts of some specimens.

    Attributes
    ----------
    values, errors : nm, shape (b,).
    inverse, variances : of the normal distributions that stand for them, 1/nm and 1/nm^2, shape (b,).
    """

    values: Array
    errors: Array
    inverse: Array
    variances: Array

    def correction(self, mean: Array, variance: Array) -> Array:
        """Logarithm of the exact over the normal likelihood at m points, shape (m,).

        Parameters
        ----------
        mean, variance : of the inverse over surfaces, shape (m,).
        """
        nodes, weights = np.polynomial.hermite_e.hermegauss(HERMITE)
        precision = 1 / variance[:, None] + 1 / self.variances
        centre = (mean[:, None] / variance[:, None] + self.inverse / self.variances) / precision
        f = centre[..., None] + nodes / np.sqrt(precision)[..., None]
        exact = _log_density(self.values[:, None], self.errors[:, None], f)
        normal = -0.5 * (f - self.inverse[:, None]) ** 2 / self.variances[:, None]
        normal = normal - 0.5 * np.log(2 * np.pi * self.variances[:, None])
        # an expectation over the product of scatter and normal likelihood: both are as narrow as the integrand
        logs = exact - normal + np.log(weights / weights.sum())
        return np.logaddexp.reduce(logs, axis=2).sum(axis=1)


def first_contacts(values: Array, errors: Array, mean: float, variance: float) -> FirstContacts:
    """Data with the normal distributions that have their moments beside what the prior expects.

    Parameters
    ----------
    values, errors : nm, shape (b,).
    mean, variance : of the inverse over the prior.
    """
    spread = (errors / values**2) ** 2
    precision = 1 / variance + 1 / spread
    centre = (mean / variance + 1 / (values * spread)) / precision
    f = centre[:, None] + np.linspace(-REACH, REACH, NODES) / np.sqrt(precision)[:, None]
    logs = _log_density(values[:, None], errors[:, None], f) - 0.5 * (f - mean) ** 2 / variance
    weights = np.exp(logs - logs.max(axis=1, keepdims=True))
    weights /= weights.sum(axis=1, keepdims=True)
    middle = (weights * f).sum(axis=1)
    width = (weights * (f - middle[:, None]) ** 2).sum(axis=1)
    precision = np.maximum(1 / width - 1 / variance, SMALLEST_PRECISION_SHARE / variance)
    return FirstContacts(values, errors, (middle / width - mean / variance) / precision, 1 / precision)


def _log_density(values: Array, errors: Array, inverse: Array) -> Array:
    """Of the data at first contacts of some inverse; -inf where that is not positive."""
    with np.errstate(divide="ignore"):
        off = np.where(inverse > 0, (values - 1 / inverse) / errors, np.inf)
    return -0.5 * off**2 - np.log(errors) - 0.5 * np.log(2 * np.pi)
