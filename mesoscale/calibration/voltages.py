"""Measured voltages, compared with the switches on pads that were pressed over the prior.

Each voltage is a regression over these switches, in the inputs and in all else that they differ by.
What the inputs do is the response; the rest is scatter, shared by all measured switches (D0, what
devices have in common, how places of the film differ, what the regression misses) or of each. A
switch that sticks has a release below zero, and nothing else is known of it.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.special import gammaln, log_ndtr, ndtr

from mesoscale.answer.switches import PadModel
from mesoscale.errors import InputError
from mesoscale.inputs.distributions import InputTable
from mesoscale.uncertainty.censored import censored_chaos
from mesoscale.uncertainty.regression import sparse_chaos
from mesoscale.uncertainty.surrogate import Surrogate

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Voltage:
    """A voltage of the switch over the prior.

    Attributes
    ----------
    response : to the inputs, averaged over all else (V; below zero: it sticks).
    shared_V, each_V : standard deviations about it, of all switches together and from one to the
        next.
    """

    response: Surrogate
    shared_V: float
    each_V: float

    def __call__(self, x: Array) -> Array:
        """Its mean at inputs x (m, n), shape (m,)."""
        return self.response(np.clip(x, *self.response.ranges.T))


def fit_voltages(model: PadModel, prior: InputTable) -> dict[str, Voltage]:
    """Pull-in and release of the switches on pads that were pressed over the prior.

    Raises
    ------
    InputError : too few of the switches have an answer, or let go.
    """
    sampled = model.design
    solved = [model.points[k] for k in model.solved]
    unmeasured = [k for k in sampled.varying if sampled.names[k] not in prior.names]
    of_device = np.array([sampled.varies[k] == "each" for k in unmeasured], bool)
    inputs = np.array([[point.point.values[name] for name in prior.names] for point in solved])
    inputs = inputs.reshape(len(solved), -1)
    probabilities = sampled.probability[model.solved][:, unmeasured]
    drawn = np.hstack([inputs, probabilities])
    unit_ranges = np.tile([0.0, 1.0], (len(unmeasured), 1))
    ranges = np.vstack([prior.ranges(), unit_ranges])
    x = np.clip(drawn, *ranges.T)
    release = model.states("release_V")
    if (release > 0).sum() < 2 * len(ranges):
        raise InputError(
            f"pad.points: {(release > 0).sum()} of {len(model.points)} switches over the prior let"
            f" go, and {2 * len(ranges)} are needed to compare measured voltages with: raise it, or"
            " narrow the inputs"
        )
    pull_in = model.states("pull_in_V")
    return {
        "pull_in": _regressed(x, pull_in, ranges, of_device),
        "release": _regressed(x, release, ranges, of_device),
    }


def _regressed(x: Array, volts: Array, ranges: Array, of_device: NDArray[np.bool_]) -> Voltage:
    """Regression in inputs and, behind them, in probabilities of all else (some of each device)."""
    stuck = volts == 0.0
    if stuck.any():
        fit, missed_V = censored_chaos(x, volts, stuck, ranges)
    else:
        fit = sparse_chaos(x, volts, ranges, degree=2)
        squares = ((volts - fit(x)) ** 2).sum()
        missed_V = np.sqrt(squares / max(len(x) - len(fit.degrees), 1))
    inputs = len(ranges) - len(of_device)
    of_others = fit.degrees[:, inputs:]
    variance = fit.coefficients**2 / np.prod(2 * fit.degrees + 1, axis=1)
    of_each = (of_others[:, of_device] > 0).any(axis=1)
    of_inputs = ~(of_others > 0).any(axis=1)
    degrees = fit.degrees[of_inputs][:, :inputs]
    response = Surrogate(ranges[:inputs], degrees, fit.coefficients[of_inputs])
    shared_V = np.sqrt(variance[~of_each & ~of_inputs].sum() + missed_V**2)
    return Voltage(response, float(shared_V), float(np.sqrt(variance[of_each].sum())))


@dataclass(frozen=True)
class StickingData:
    """How many switches stuck."""

    stuck: Array
    switches: Array
    discrepancy: float
    release: Voltage

    def log_likelihood(self, x: Array) -> Array:
        """Logarithm of the likelihood at inputs x (m, n), shape (m,)."""
        margin = self._margin(x)
        stuck = self.stuck.sum()
        total = self.switches.sum()
        ways = gammaln(total + 1) - gammaln(stuck + 1) - gammaln(total - stuck + 1)
        return ways + stuck * log_ndtr(-margin) + (total - stuck) * log_ndtr(margin)

    def simulated(self, x: Array, rng: np.random.Generator) -> "StickingData":
        """Data drawn at inputs x (1, n)."""
        stuck = rng.binomial(self.switches.astype(int), ndtr(-self._margin(x)))
        return replace(self, stuck=stuck.astype(float))

    def _margin(self, x: Array) -> Array:
        """Release in standard deviations above sticking."""
        release = self.release(x)
        volts = self.release
        variance = (self.discrepancy * release) ** 2 + volts.shared_V**2 + volts.each_V**2
        return release / np.sqrt(variance + 1e-6)
