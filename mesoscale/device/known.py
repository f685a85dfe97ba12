"""What is known of the release: the band between devices, and apart from it the band of what is not known.

An input is common to all devices, one unknown value U, or varies with each device, X. A sum of functions of single
numbers is fitted to the solved switches, so that it splits in one part of U and one of X. It is the release, or its
square, which the forces balance. Where the switch sticks, the fitted quantity lies below zero and is not known; its
expected value is put in its place until the fit no longer changes (Dempster, Laird and Rubin, J. R. Statist. Soc. B 39
(1977) 1, section 4.2).
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import log_ndtr, ndtr

Array = NDArray[np.float64]
ENDS = (0.05, 0.5, 0.95)


@dataclass(frozen=True)
class Additive:
    """Release to some power as a sum of functions of single numbers; below zero the switch sticks.

    Attributes
    ----------
    power, degree : 1 or 2; degree of the Legendre polynomials in the probabilities of the numbers.
    coefficients, covariance : of the constant, then of each polynomial of each number; and their error.
    missed : standard deviation of what the sum misses.
    explained : share of the variance that it predicts of switches left out one at a time.
    values : fitted ones, with the expected ones of switches that stick.
    """

    power: int
    degree: int
    coefficients: Array
    covariance: Array
    missed: float
    explained: float
    values: Array

    @property
    def variance(self) -> float:
        """Of the sum over independent numbers, and of what it misses."""
        return float((self.coefficients[1:] ** 2).sum() + self.missed**2) or 1.0

    @property
    def noise(self) -> float:
        """Share of the variance that a number seems to explain by chance."""
        return self.degree * self.missed**2 / self.values.size / self.variance

    def shares(self) -> Array:
        """Share of the variance by each number; what noise alone would seem to explain is taken off."""
        of_number = (self.coefficients[1:] ** 2).reshape(self.degree, -1).sum(axis=0)
        return np.maximum(of_number / self.variance - self.noise, 0.0)

    def deviation(self, release_V: Array, errors_V: Array) -> float:
        """Root mean square error of fitted values by errors of the releases."""
        return float(np.sqrt(np.mean((self.power * release_V ** (self.power - 1) * errors_V) ** 2)))

    def volts(self, values: Array) -> Array:
        """Release of fitted values."""
        return np.maximum(values, 0.0) ** (1.0 / self.power)


def basis(units: Array, degree: int) -> Array:
    """A constant and the normed Legendre polynomials of each number; numbers (m, k) in [0, 1]."""
    x = 2.0 * units - 1.0
    terms = [np.sqrt(3.0) * x, np.sqrt(5.0) * (1.5 * x**2 - 0.5)]
    return np.hstack([np.ones((len(x), 1)), *terms[:degree]])


def fit_additive(units: Array, release_V: Array) -> Additive:
    """The sum that best predicts switches that are left out; numbers (m, k), releases (m,), 0 where it sticks.

    Of the release and its square, linear and of second degree; the linear ones need more than k + 1 switches.
    """
    fits = [_fit(units, release_V, power, 1) for power in (1, 2)]
    if len(units) > 2 * units.shape[1] + 2:
        fits += [_fit(units, release_V, power, 2) for power in (1, 2)]
    return max(fits, key=lambda fit: fit.explained)


def _fit(units: Array, release_V: Array, power: int, degree: int) -> Additive:
    columns = basis(units, degree)
    inverse, values, stuck = np.linalg.pinv(columns), release_V**power, release_V == 0.0
    missed, tolerance = 0.0, 1e-3 * float(values.std())
    values[stuck] = -values.std()
    for _ in range(300):  # where half of the switches stick, it takes a hundred
        fitted = columns @ (inverse @ values)
        missed = float(np.sqrt(((values - fitted) ** 2).sum() / max(len(units) - columns.shape[1], 1)))
        depth = -fitted[stuck] / max(missed, 1e-9)
        below = fitted[stuck] - missed * np.exp(-0.5 * depth**2 - 0.5 * np.log(2.0 * np.pi) - log_ndtr(depth))
        settled = np.allclose(below, values[stuck], rtol=0.0, atol=tolerance)
        values[stuck] = below
        if settled:
            break
    free, explained = 1.0 - np.einsum("pi,ip->p", columns, inverse), 0.0
    if free.min() > 1e-9:  # else a switch is needed for the fit: without it, it is not predicted
        left = (values - columns @ (inverse @ values)) / free
        explained = 1.0 - float(np.mean(left**2)) / (values.var() or 1.0)
    return Additive(power, degree, inverse @ values, inverse @ inverse.T * missed**2, missed, explained, values)


def known(
    fit: Additive, common: NDArray[np.bool_], cells: float, draws: int = 1000, errors: int = 100
) -> dict[str, Any]:
    """Bands of the release, and the share that sticks by what is common.

    Parameters
    ----------
    common : which numbers are, shape (k,).
    cells : standard deviation of fitted values by the number of cells, which no real pad has.
    draws, errors : of the numbers, and of the coefficients within their error.

    Returns
    -------
    unknown_V : 5, 50 and 95 % of the release of the typical device, by what is common; each with its error.
    between_V : the same from device to device, where what is common is at its median.
    rest_V : deviation of what the fit misses beyond the cells, which is of either kind.
    stuck_share : 5, 50 and 95 % of the share of devices that stick, one in the number of switches where it is less. Its
        low and high end hold the error of the fit, and that what it misses may be common or of each device.
    """
    rng = np.random.default_rng(np.random.SeedSequence([0, 0x2100]))
    columns = basis(rng.random((draws, common.size)), fit.degree)
    of_common = np.concatenate([[True], np.tile(common, fit.degree)])
    chosen = rng.multivariate_normal(fit.coefficients, fit.covariance, errors, method="eigh")
    coefficients = np.vstack([fit.coefficients, chosen])
    unknown = coefficients[:, of_common] @ columns[:, of_common].T
    between = coefficients[:, ~of_common] @ columns[:, ~of_common].T
    rest, noise = np.sqrt(max(fit.missed**2 - cells**2, 0.0)), rng.normal(size=draws)
    devices = between.std(axis=1)[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):  # where no device differs, all stick or none
        by_rest = [
            ndtr(np.nan_to_num(-unknown / np.hypot(devices, rest), nan=-np.inf)),
            ndtr(np.nan_to_num(-(unknown + rest * noise) / devices, nan=-np.inf)),
        ]
    least = 1.0 / fit.values.size  # so many switches know no tail
    ends = [np.quantile(np.maximum(rates, least), ENDS, axis=1) for rates in by_rest]
    low, high = (np.quantile(np.hstack([part[:, 1:] for part in ends]), q, axis=1) for q in (0.05, 0.95))
    middle = float(np.median(unknown[0]))
    slope = fit.power * max(float(fit.volts(np.array(middle))), 1e-9) ** (fit.power - 1)
    return {
        "unknown_V": _quantiles(fit.volts(unknown)),
        "between_V": _quantiles(fit.volts(np.median(unknown, axis=1)[:, None] + between)),
        "rest_V": float(rest / slope),
        "stuck_share": {
            f"{q:g}": {"value": float(ends[0][k, 0]), "low": float(low[k]), "high": float(high[k])}
            for k, q in enumerate(ENDS)
        },
    }


def _quantiles(volts: Array) -> dict[str, dict[str, float]]:
    """Of the first row, with the scatter of the others as errors."""
    ends = np.quantile(volts, ENDS, axis=1)
    return {
        f"{q:g}": {"value": float(row[0]), "error": float(row[1:].std())} for q, row in zip(ENDS, ends, strict=True)
    }
