"""Responses of the observables to the inputs, their scatter from surface to surface, and their own error.

All observables share one basis, so that what the finite number of cycles leaves open is one number per point, the
leverage of least squares times the scatter (Draper and Smith, Applied Regression Analysis, 1998, section 1.4).
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from mesoscale.calibration.observables import Observable
from mesoscale.errors import InputError
from mesoscale.uncertainty.surrogate import basis_matrix

Array = NDArray[np.float64]
Degrees = NDArray[np.int_]

CANDIDATES = ((1, 1.0), (2, 1.0), (3, 0.7), (4, 0.7), (3, 1.0))
"""Bases that are tried, from small to large: highest degree and exponent of the hyperbolic norm."""
FEWEST_PER_TERM, PLENTY_PER_TERM = 3.0, 20.0
"""Runs per term that a basis needs, and that leave no reason for a smaller one.

Left-out runs decide between bases. They see single surfaces, so alone they would choose a basis whose bias is hidden by
the scatter of one surface, and not by that of the mean of many measurements.
"""
SMALLEST_SD = 1e-6
"""Scatter of an observable of no scatter, in its scaled unit: keeps matrices regular."""
SCORING_STEPS = 30
MEAN_LOG_CHI2 = -1.2703628
"""Mean of the logarithm of a squared standard normal number, -ln 2 - Euler's constant."""


@dataclass(frozen=True)
class Prediction:
    """Observables at m points: lengths in nm, the first contact as its inverse, others as the logarithm of their value.

    Attributes
    ----------
    mean : averaged over random surfaces, shape (m, k).
    scatter : covariance of single surfaces, shape (m, k, k).
    error : variance of the mean by the finite number of cycles, as a share of the scatter, shape (m,).
    """

    mean: Array
    scatter: Array
    error: Array

    def at(self, place: int) -> "Prediction":
        """The prediction at one of the points, as one of one point."""
        here = slice(place, place + 1)
        return Prediction(self.mean[here], self.scatter[here], self.error[here])


@dataclass(frozen=True)
class Responses:
    """Fitted responses of several observables.

    Attributes
    ----------
    observables, ranges : ranges of the inputs, shape (n, 2).
    rms_column : which input is the RMS height, the unit of all lengths.
    degrees : terms, shape (t, n).
    coefficients : shape (t, k).
    covariance : of the coefficients for scatter 1, shape (t, t).
    axes : principal axes of the residuals as columns, in the unit of the responses, shape (k, c).
    spread : coefficients of ln variance along each axis, in 1 and the scaled inputs, shape (1 + n, c).
    runs : cycles behind them.
    dropped : cycles left out because they lack an observable.
    """

    observables: tuple[Observable, ...]
    ranges: Array
    rms_column: int
    degrees: Degrees
    coefficients: Array
    covariance: Array
    axes: Array
    spread: Array
    runs: int
    dropped: int

    def __call__(self, x: Array) -> Prediction:
        """Predict at inputs x of shape (m, n)."""
        u = scaled(x, self.ranges)
        basis = basis_matrix(u, self.degrees)
        unit = lengths(self.observables, x[:, self.rms_column])
        roots = unit[:, :, None] * self.axes * np.exp(0.5 * (self.spread[0] + u @ self.spread[1:]))[:, None, :]
        error = (basis @ self.covariance * basis).sum(axis=1)
        mean = (basis @ self.coefficients) * unit + log_units(self.observables, x[:, self.rms_column])
        return Prediction(mean, roots @ np.swapaxes(roots, 1, 2), error)


def scaled(x: Array, ranges: Array) -> Array:
    """Inputs (m, n) in -1 .. 1; an input of no width gives 0, one beyond its range that of the end."""
    width = ranges[:, 1] - ranges[:, 0]
    u = np.where(width > 0, 2 * (x - ranges[:, 0]) / np.where(width > 0, width, 1.0) - 1, 0.0)
    return np.clip(u, -1.0, 1.0)


def lengths(observables: Sequence[Observable], rms: Array) -> Array:
    """Unit of every observable at every point, shape (m, k): the RMS height for lengths, its inverse, or 1."""
    power = np.array([{"length": 1.0, "inverse_length": -1.0}.get(row.scale, 0.0) for row in observables])
    return rms[:, None] ** power


def log_units(observables: Sequence[Observable], rms: Array) -> Array:
    """Logarithm of the RMS height for lengths that enter by their logarithm, else 0, shape (m, k)."""
    is_length = np.array([row.scale == "log_length" for row in observables])
    return np.where(is_length, np.log(np.maximum(rms, 1e-300))[:, None], 0.0)


def transformed(observables: Sequence[Observable], y: Array) -> Array:
    """Values (m, k) as `Prediction` has them; NaN where there is no logarithm or inverse."""
    is_length = np.array([row.scale == "length" for row in observables])
    inverse = np.array([row.scale == "inverse_length" for row in observables])
    positive = np.where(is_length | (y > 0), y, np.nan)
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.where(is_length, y, np.where(inverse, 1 / positive, np.log(positive)))


def untransformed(observables: Sequence[Observable], f: Array) -> Array:
    """Values in their units, shape (m, k), of numbers as `Prediction` has them."""
    is_length = np.array([row.scale == "length" for row in observables])
    inverse = np.array([row.scale == "inverse_length" for row in observables])
    logs = np.where(is_length | inverse, 0.0, f)
    return np.where(is_length, f, np.where(inverse, 1 / np.where(inverse, f, 1.0), np.exp(logs)))


def to_scaled(observables: Sequence[Observable], y: Array, rms: Array) -> Array:
    """Values (m, k) in the space of the responses, with the RMS height as unit; NaN where there is none."""
    return (transformed(observables, y) - log_units(observables, rms)) / lengths(observables, rms)


def fit_responses(
    observables: Sequence[Observable], x: Array, y: Array, ranges: Array, rms_column: int, what: str
) -> Responses:
    """Least-squares responses of all observables in the basis that predicts left-out runs best.

    Parameters
    ----------
    x : inputs of the runs, shape (m, n), each run on a surface of its own.
    y : observables, shape (m, k); runs that lack one are left out.
    what : what is fitted, for messages.

    Raises
    ------
    InputError : fewer usable runs than three per term of the smallest basis.
    """
    target = to_scaled(observables, y, x[:, rms_column])
    usable = np.isfinite(target).all(axis=1)
    u, target = scaled(x[usable], ranges), target[usable]
    varying = np.ptp(ranges, axis=1) > 0
    best = None
    bases = [_terms(varying, degree, hyperbolic) for degree, hyperbolic in CANDIDATES]
    plenty = max((len(degrees) for degrees in bases if PLENTY_PER_TERM * len(degrees) <= len(u)), default=0)
    for degrees in bases:
        if FEWEST_PER_TERM * len(degrees) > len(u) or len(degrees) < plenty:
            continue
        fit = _fit(u, target, degrees)
        score = float(np.log((fit[3] ** 2).mean(axis=0) + SMALLEST_SD**2).sum())
        if best is None or score < best[0]:
            best = (score, degrees, *fit)
    if best is None:
        raise InputError(
            f"measurements.runs: {len(u)} of {len(x)} cycles give all of {what}; at least "
            f"{int(FEWEST_PER_TERM * (1 + varying.sum()))} are needed; raise it, or lower the lowest measured force"
        )
    _, degrees, coefficients, covariance, spread, _, axes = best
    return Responses(
        tuple(observables),
        ranges,
        rms_column,
        degrees,
        coefficients,
        covariance,
        axes,
        spread,
        len(u),
        int((~usable).sum()),
    )


@dataclass(frozen=True)
class ResponseFits:
    """Responses of any of some observables, fitted when they are asked for, to the runs that have them all.

    A run may lack one observable and have others: smooth surfaces that never push with the largest measured force
    have pull-off forces, and responses of those that left them out would be wrong there.

    Attributes
    ----------
    observables, ranges, rms_column : as `Responses` has them.
    x, y : inputs and observables of the runs, shapes (m, n) and (m, k).
    """

    observables: tuple[Observable, ...]
    x: Array
    y: Array
    ranges: Array
    rms_column: int
    _known: dict[tuple[str, ...], Responses] = field(default_factory=dict)

    def pick(self, names: Sequence[str]) -> Responses:
        """The responses of some observables, in their order.

        Raises
        ------
        InputError : see `fit_responses`.
        """
        key = tuple(names)
        if key not in self._known:
            every = [row.name for row in self.observables]
            places = [every.index(name) for name in key]
            self._known[key] = fit_responses(
                [self.observables[k] for k in places],
                self.x,
                self.y[:, places],
                self.ranges,
                self.rms_column,
                ", ".join(key) if len(key) < 4 else "the observables",
            )
        return self._known[key]

    @property
    def every(self) -> Responses:
        """The responses of all observables."""
        return self.pick([row.name for row in self.observables])


def _terms(varying: NDArray[np.bool_], degree: int, hyperbolic: float) -> Degrees:
    """Terms of the inputs that vary up to a hyperbolic degree, the constant first."""
    inputs = int(varying.sum())
    rows = [np.zeros(inputs, int)]
    frontier = rows
    for _ in range(degree):
        frontier = [row + step for row in frontier for step in np.eye(inputs, dtype=int)]
        frontier = [np.array(row) for row in dict.fromkeys(tuple(row.tolist()) for row in frontier)]
        rows = rows + frontier
    kept = [row for row in rows if (row**hyperbolic).sum() ** (1 / hyperbolic) <= degree * (1 + 1e-9)]
    terms = np.zeros((len(kept), len(varying)), int)
    terms[:, varying] = np.array(kept).reshape(len(kept), inputs)
    return terms


def _fit(u: Array, target: Array, degrees: Degrees) -> tuple[Array, Array, Array, Array, Array]:
    """Coefficients, their covariance for scatter 1, the scatter's coefficients, residuals of left-out runs, their axes.

    Two rounds: the second weighs every run by the scatter that the first found where it lies.
    """
    basis = basis_matrix(u, degrees)
    weights = np.ones(len(u))
    coefficients = covariance = spread = left_out = axes = np.empty((0, 0))
    for _ in range(2):
        root = np.sqrt(weights)[:, None]
        covariance = np.asarray(np.linalg.pinv((basis * root).T @ (basis * root), hermitian=True), float)
        coefficients = covariance @ (basis.T @ (weights[:, None] * target))
        leverage = weights * (basis @ covariance * basis).sum(axis=1)
        left_out = (target - basis @ coefficients) / np.maximum(1 - leverage, 1e-3)[:, None]
        sd = np.sqrt((left_out**2).mean(axis=0) + SMALLEST_SD**2)
        axes = sd[:, None] * np.linalg.eigh(np.corrcoef(left_out / sd, rowvar=False).reshape(len(sd), -1))[1]
        on_axes = np.linalg.solve(axes, left_out.T).T
        spread = _spread(u, on_axes)
        # the axis of largest scatter stands last; its scatter weighs the runs
        weights = np.exp(-(u @ spread[1:, -1]))
    return coefficients, covariance, spread, left_out, axes


def _spread(u: Array, residuals: Array) -> Array:
    """Coefficients of ln variance of the residuals, linear in the scaled inputs, by maximum likelihood.

    Fisher scoring of a generalised linear model with gamma errors and logarithmic link (McCullagh and Nelder,
    Generalized Linear Models, 1989, section 8.3).
    """
    terms = np.column_stack([np.ones(len(u)), u])
    inverse = np.linalg.pinv(terms)
    squares = residuals**2 + SMALLEST_SD**2
    coefficients = inverse @ (np.log(squares) - MEAN_LOG_CHI2)
    for _ in range(SCORING_STEPS):
        ratio = squares / np.exp(terms @ coefficients)
        coefficients = coefficients + np.clip(inverse @ (ratio - 1), -1.0, 1.0)
    return coefficients
