"""Likelihood of values that the inputs alone decide: hardness, moduli, voltages of switches."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ValueData:
    """Measured values with the model of them.

    Attributes
    ----------
    values, errors : shape (v,).
    model : values at inputs x (m, n), shape (m, v) or (m, 1).
    discrepancy : standard deviation of the model's own error, one share for all values.
    shared, single : further deviations, of all values together and of single ones.
    """

    values: Array
    errors: Array
    model: Callable[[Array], Array]
    discrepancy: float
    shared: float = 0.0
    single: float = 0.0

    def log_likelihood(self, x: Array) -> Array:
        """Logarithm of the likelihood at inputs x (m, n), shape (m,)."""
        model = self.model(x)
        return normal_with_common(
            self.values - model, self.errors**2 + self.single**2, self._common(model)
        )

    def simulated(self, x: Array, rng: np.random.Generator) -> "ValueData":
        """Data with the same errors, drawn at inputs x (1, n)."""
        model = self.model(x)
        noise = rng.standard_normal(self.values.shape)
        shared = self._common(model) * rng.standard_normal()
        drawn = model + shared + np.hypot(self.errors, self.single) * noise
        return replace(self, values=drawn[0])

    def _common(self, model: Array) -> Array:
        return np.hypot(self.discrepancy * model, self.shared)


def normal_with_common(residuals: Array, variances: Array, common: Array) -> Array:
    """Log of a normal density of covariance diag(variances) + common common^T."""
    variances = np.broadcast_to(variances, residuals.shape)
    common = np.broadcast_to(common, residuals.shape)
    separate = (residuals**2 / variances).sum(axis=-1)
    cross = (residuals * common / variances).sum(axis=-1)
    gain = 1 + (common**2 / variances).sum(axis=-1)
    determinant = np.log(2 * np.pi * variances).sum(axis=-1)
    return -0.5 * (separate - cross**2 / gain + np.log(gain) + determinant)
