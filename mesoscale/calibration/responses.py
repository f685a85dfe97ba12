"""Responses of the observables to the inputs, their scatter between surfaces, and their error.

All observables share one basis, so that what the finite number of cycles leaves open is one number
per point, the leverage of least squares times the scatter (Draper and Smith, Applied Regression
Analysis, 1998, section 1.4).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mesoscale.calibration.observables import Cycles, enter_by_logarithm
from mesoscale.errors import InputError
from mesoscale.inputs.distributions import InputTable
from mesoscale.uncertainty.surrogate import basis_matrix, scaled

Array = NDArray[np.float64]

FEWEST_PER_TERM = 3
"""Cycles per term of a response."""


@dataclass(frozen=True)
class Prediction:
    """Observables at m points: separations in nm, others as the logarithm of their value.

    Attributes
    ----------
    mean : averaged over random surfaces, shape (m, k).
    scatter : covariance of single surfaces, shape (m, k, k).
    error : variance of the mean by the finite number of cycles, as a share of the scatter, shape
        (m,).
    """

    mean: Array
    scatter: Array
    error: Array


@dataclass(frozen=True)
class Responses:
    """Fitted responses of several observables; their lengths are in units of the RMS height.

    Attributes
    ----------
    names, ranges : of the observables; of the inputs, shape (n, 2).
    rms_column : which input is the RMS height.
    degrees : terms, shape (t, n).
    coefficients : shape (t, k).
    inverse : of the normal equations, shape (t, t).
    slopes : of ln variance of each observable in the scaled inputs, shape (n, k).
    covariance : of single surfaces in the middle of the ranges, shape (k, k).
    cycles : how many are behind them.
    """

    names: tuple[str, ...]
    ranges: Array
    rms_column: int
    degrees: NDArray[np.int_]
    coefficients: Array
    inverse: Array
    slopes: Array
    covariance: Array
    cycles: int

    def __call__(self, x: Array) -> Prediction:
        """Predict at inputs x of shape (m, n)."""
        u = np.clip(scaled(x, self.ranges), -1.0, 1.0)
        basis = basis_matrix(u, self.degrees)
        shift, unit = _units(self.names, x[:, self.rms_column])
        deviation = unit * np.exp(0.5 * u @ self.slopes)
        scatter = deviation[:, :, None] * self.covariance * deviation[:, None, :]
        error = np.einsum("mt,ts,ms->m", basis, self.inverse, basis, optimize=True)
        return Prediction(basis @ self.coefficients * unit + shift, scatter, error)


def _units(names: Sequence[str], rms: Array) -> tuple[Array, Array]:
    """Shift and factor of a response, (m, k) each, so that lengths count in RMS heights."""
    length = np.array([name.endswith("_nm") for name in names])
    by_logarithm = enter_by_logarithm(names)
    rms = np.maximum(rms, 1e-300)[:, None]
    shift = np.where(length & by_logarithm, np.log(rms), 0.0)
    return shift, np.where(length & ~by_logarithm, rms, 1.0)


def _terms(varying: NDArray[np.bool_], largest: int) -> NDArray[np.int_]:
    """Terms of the varying inputs: constant, linear, products, squares, cubes; at most so many."""
    linear = np.eye(len(varying), dtype=int)[varying]
    products = [power + other for k, power in enumerate(linear) for other in linear[:k]]
    rows = [np.zeros(len(varying), int), *linear, *(2 * linear), *products, *(3 * linear)]
    return np.array(rows[: max(largest, 1 + len(linear))])


def fit_responses(names: Sequence[str], cycles: Cycles, table: InputTable) -> Responses:
    """Least-squares responses of some observables; cycles that lack one of them are left out.

    A cycle may lack one observable and have others: smooth surfaces that never push with the
    largest measured force have pull-off forces. So responses are fitted for those observables that
    are measured.

    Raises
    ------
    InputError : too few cycles give all of these observables.
    """
    ranges = table.ranges()
    rms_column = table.names.index("rms")
    shift, unit = _units(names, cycles.x[:, rms_column])
    target = (cycles.of(names) - shift) / unit
    usable = np.isfinite(target).all(axis=1)
    u = np.clip(scaled(cycles.x[usable], ranges), -1.0, 1.0)
    target = target[usable]
    degrees = _terms(np.ptp(ranges, axis=1) > 0, len(u) // FEWEST_PER_TERM)
    if FEWEST_PER_TERM * len(degrees) > len(u):
        words = "the observables"
        if len(names) < 4:
            words = ", ".join(names)
        raise InputError(
            f"measurements.runs: {len(u)} of {len(cycles.x)} cycles give all of {words}; at least"
            f" {FEWEST_PER_TERM * len(degrees)} are needed; raise it, or lower the lowest measured"
            " force"
        )
    basis = basis_matrix(u, degrees)
    inverse = np.asarray(np.linalg.pinv(basis.T @ basis, hermitian=True), float)
    coefficients = inverse @ (basis.T @ target)
    leverage = np.einsum("mt,ts,ms->m", basis, inverse, basis, optimize=True)
    left_out = (target - basis @ coefficients) / np.maximum(1 - leverage, 1e-3)[:, None]
    linear = np.column_stack([np.ones(len(u)), u])
    log_squares = np.log(left_out**2 + 1e-12)
    slopes = np.linalg.lstsq(linear, log_squares, rcond=None)[0][1:]
    alike = left_out * np.exp(-0.5 * u @ slopes)
    covariance = alike.T @ alike / len(alike) + 1e-12 * np.eye(len(names))
    return Responses(
        tuple(names), ranges, rms_column, degrees, coefficients, inverse, slopes, covariance, len(u)
    )
