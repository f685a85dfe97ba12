"""What is known of the release: the band between devices, and apart from it the band of what is not
known.

An input is common to all devices, one unknown value U, or varies with each device, X. A sum of
functions of single numbers is fitted to the solved switches, so that it splits in one part of U and
one of X. It is the release, or its square, which the forces balance. Where the switch sticks, the
fitted quantity lies below zero, and nothing else is known of it.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from mesoscale.uncertainty.censored import Censored, most_likely

Array = NDArray[np.float64]
ENDS = (0.05, 0.5, 0.95)
SMALLEST_V = 1e-9
"""A release counts as this at least, so that the slope of its square stays positive."""


@dataclass(frozen=True)
class Additive:
    """Release to some power as a sum of functions of single numbers; below zero the switch sticks.

    Attributes
    ----------
    power, degree : 1 or 2; degree of the Legendre polynomials in the probabilities of the numbers.
    coefficients, covariance : of the constant, then of each polynomial of each number; and their
        error.
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
        """Share of the variance by each number; what noise alone would seem to explain is taken
        off.
        """
        of_number = (self.coefficients[1:] ** 2).reshape(self.degree, -1).sum(axis=0)
        return np.maximum(of_number / self.variance - self.noise, 0.0)

    def deviation(self, release_V: Array, errors_V: Array) -> float:
        """Root mean square error of fitted values by errors of the releases."""
        slope = self.power * release_V ** (self.power - 1)
        return float(np.sqrt(np.mean((slope * errors_V) ** 2)))

    def volts(self, values: Array) -> Array:
        """Release of fitted values."""
        return np.maximum(values, 0.0) ** (1.0 / self.power)


def basis(units: Array, degree: int) -> Array:
    """A constant and the normed Legendre polynomials of each number; numbers (m, k) in [0, 1]."""
    x = 2.0 * units - 1.0
    terms = [np.sqrt(3.0) * x, np.sqrt(5.0) * (1.5 * x**2 - 0.5)]
    return np.hstack([np.ones((len(x), 1)), *terms[:degree]])


def fit_additive(units: Array, release_V: Array) -> Additive:
    """The sum that best predicts switches that are left out; numbers (m, k), releases (m,), 0 where
    it sticks.

    Of the release and its square, linear and of second degree. The linear ones need more than k + 1
    switches that let go, the others twice as many.
    """
    fits = [_fit(units, release_V, power, 1) for power in (1, 2)]
    if np.count_nonzero(release_V) > 2 * units.shape[1] + 2:
        fits += [_fit(units, release_V, power, 2) for power in (1, 2)]
    return max(fits, key=lambda fit: fit.explained)


def _fit(units: Array, release_V: Array, power: int, degree: int) -> Additive:
    """Where too few switches let go to tell the numbers apart, the sum is its constant alone."""
    columns = basis(units, degree)
    terms = columns.shape[1]
    stuck = release_V == 0.0
    if stuck.any() and len(stuck) - stuck.sum() <= terms:
        columns = columns[:, :1]
    fit = _sum(columns, release_V**power, stuck)
    free = 1.0 - np.einsum("pi,ip->p", columns, np.linalg.pinv(columns))
    explained = 0.0
    if free.min() > 1e-9:  # else a switch is needed for the fit: without it, it is not predicted
        left = (fit.values - columns @ fit.coefficients) / free
        explained = 1.0 - float(np.mean(left**2)) / (fit.values.var() or 1.0)
    padding = (0, terms - columns.shape[1])
    coefficients = np.pad(fit.coefficients, padding)
    covariance = np.pad(fit.covariance, padding)
    return Additive(power, degree, coefficients, covariance, fit.scatter, explained, fit.values)


def _sum(columns: Array, values: Array, stuck: NDArray[np.bool_]) -> Censored:
    """Coefficients of the columns by values (m,), of which some are known only to lie below
    zero.
    """
    if stuck.any() and not stuck.all():
        return most_likely(columns, values, stuck)
    # where all stick, nothing says how far below zero they are
    values = np.where(stuck, -1.0, values)
    inverse = np.linalg.pinv(columns)
    coefficients = inverse @ values
    missed = ((values - columns @ coefficients) ** 2).sum()
    scatter = float(np.sqrt(missed / max(len(columns) - columns.shape[1], 1)))
    return Censored(coefficients, inverse @ inverse.T * scatter**2, scatter, values)


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
    unknown_V : 5, 50 and 95 % of the release of the typical device, by what is common; each with
        its error.
    between_V : the same from device to device, where what is common is at its median.
    rest_V : deviation of what the fit misses beyond the cells, which is of either kind.
    stuck_share : 5, 50 and 95 % of the share of devices that stick; where one is `tellable_share`,
        it is that or less. Their low and high ends hold the error of the fit, and that what it
        misses may be common or of each device.
    """
    rng = np.random.default_rng(np.random.SeedSequence([0, 0x2100]))
    columns = basis(rng.random((draws, common.size)), fit.degree)
    of_common = np.concatenate([[True], np.tile(common, fit.degree)])
    within_error = rng.multivariate_normal(fit.coefficients, fit.covariance, errors, method="eigh")
    coefficients = np.vstack([fit.coefficients, within_error])
    unknown = coefficients[:, of_common] @ columns[:, of_common].T
    between = coefficients[:, ~of_common] @ columns[:, ~of_common].T
    missed_beyond = float(np.sqrt(max(fit.missed**2 - cells**2, 0.0)))
    typical = np.median(unknown, axis=1)[:, None]
    devices = between.std(axis=1)[:, None]
    # what the fit misses differs from device to device, or is common to all
    if_each = _share_below_zero(unknown, np.hypot(devices, missed_beyond))
    missed = missed_beyond * rng.normal(size=draws)
    if_common = _share_below_zero(unknown + missed, devices)
    typical_V = max(float(fit.volts(np.array(np.median(unknown[0])))), SMALLEST_V)
    slope = fit.power * typical_V ** (fit.power - 1)
    return {
        "unknown_V": _quantiles(fit.volts(unknown)),
        "between_V": _quantiles(fit.volts(typical + between)),
        "rest_V": missed_beyond / slope,
        "stuck_share": _stuck_shares(if_each, if_common, fit.values.size),
    }


def _share_below_zero(middle: Array, deviation: Array) -> Array:
    """Share of normal numbers that are negative; where none differs, all are or none."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return ndtr(np.nan_to_num(-middle / deviation, nan=-np.inf))


def _stuck_shares(if_each: Array, if_common: Array, switches: int) -> dict[str, dict[str, float]]:
    """Quantiles of the share that sticks, of the fit itself (first rows) and within its error.

    Parameters
    ----------
    if_each, if_common : shares where what the fit misses is of each device, and where it is common;
        shape (1 + errors, draws).
    switches : that were solved: of a small share they know no more than `tellable_share`.
    """
    quantiles_if_each = np.quantile(if_each, ENDS, axis=1)
    quantiles_if_common = np.quantile(if_common, ENDS, axis=1)
    within_error = np.hstack([quantiles_if_each[:, 1:], quantiles_if_common[:, 1:]])
    low, high = np.quantile(within_error, (0.05, 0.95), axis=1)
    tellable = tellable_share(switches)
    return {
        f"{q:g}": {
            "value": max(float(quantiles_if_each[k, 0]), tellable),
            "low": float(low[k]),
            "high": max(float(high[k]), tellable),
        }
        for k, q in enumerate(ENDS)
    }


def tellable_share(switches: int) -> float:
    """Share that may stick with 95 % confidence where none of so many switches does.

    It is near three in their number, the "rule of three". A smaller share rests on no switch.
    """
    return 1.0 - 0.05 ** (1.0 / switches)


def _quantiles(volts: Array) -> dict[str, dict[str, float]]:
    """Of the first row, with the scatter of the others as errors."""
    quantiles = np.quantile(volts, ENDS, axis=1)
    return {
        f"{q:g}": {"value": float(row[0]), "error": float(row[1:].std())}
        for q, row in zip(ENDS, quantiles, strict=True)
    }
