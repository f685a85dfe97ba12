"""Truth by brute force: moments, quantiles, variance shares and first-order indices of scattered runs.

Nothing here uses a response. Errors come from a jackknife over groups of runs.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.uncertainty.propagation import to_paper_outputs
from mesoscale.uncertainty.validation import STATISTICS

Array = NDArray[np.float64]

GROUPS = 20
RUNS_PER_BIN = 25


@dataclass(frozen=True)
class Estimate:
    """Numbers with their standard errors, same shape."""

    value: Array
    error: Array


def jackknife(statistic: Callable[[NDArray[np.int_]], Array], count: int, groups: int = GROUPS) -> Estimate:
    """A statistic of `count` runs with the standard error found by leaving out one group after the other.

    Parameters
    ----------
    statistic : takes indices of runs.
    """
    everything = np.arange(count)
    if count < 2 * groups:
        value = np.asarray(statistic(everything), float)
        return Estimate(value, np.full_like(value, np.nan))
    parts = np.array([statistic(everything[everything % groups != g]) for g in range(groups)], float)
    spread = np.sqrt((groups - 1) * parts.var(axis=0))
    return Estimate(np.asarray(statistic(everything), float), spread)


@dataclass(frozen=True)
class Truth:
    """What direct runs tell about the outputs of Table 2, free of responses.

    Attributes
    ----------
    statistics : mean, dev, q05, q50, q95, each of shape (len(OUTPUTS),).
    surface_variance : E[Var(Y|X)]: the surface's part of the variance, shape (len(OUTPUTS),).
    input_variance : var(E[Y|X]): the inputs' part, shape (len(OUTPUTS),).
    first : first-order indices of E[Y|X], shape (len(OUTPUTS), n).
    """

    runs: int
    statistics: dict[str, Estimate]
    surface_variance: Estimate
    input_variance: Estimate
    first: Estimate


def truth_of(x: Array, y: Array, replicates: Array) -> Truth:
    """Truth from direct runs.

    Parameters
    ----------
    x : inputs, shape (m, n).
    y : closing and opening parameters, shape (m, len(FITTED)), NaN where missing.
    replicates : those of the first r inputs on other surfaces, shape (r, len(FITTED)).

    Notes
    -----
    E[Var(Y|X)] = E[(Y - Y')²]/2 over pairs with equal inputs, Var(E[Y|X]) = Var(Y) - E[Var(Y|X)].
    """
    y, again = to_paper_outputs(y), to_paper_outputs(replicates)
    pairs = (y[: len(again)] - again) ** 2 / 2
    within = jackknife(lambda chosen: of_outputs(np.mean, pairs[chosen]), len(pairs))
    variance = jackknife(lambda chosen: of_outputs(np.var, y[chosen]), len(y))
    between = Estimate(variance.value - within.value, np.hypot(variance.error, within.error))
    shares = jackknife(
        lambda chosen: np.array(
            [[explained_by(x[chosen, i], y[chosen, k]) for i in range(x.shape[1])] for k in range(y.shape[1])]
        ),
        len(y),
    )
    # both parts of the variance are the same for every input
    with np.errstate(divide="ignore", invalid="ignore"):
        scale = np.where(between.value > 0, variance.value / between.value, np.nan)[:, None]
        of_scale = np.where(between.value > 0, within.error / between.value, np.nan)[:, None]
    first = Estimate(shares.value * scale, np.hypot(shares.error * scale, shares.value * scale * of_scale))
    statistics = {
        name: jackknife(lambda chosen, f=f: of_outputs(f, y[chosen]), len(y)) for name, f in STATISTICS.items()
    }
    return Truth(len(y), statistics, within, between, first)


def of_outputs(statistic: Callable[..., Any], values: Array) -> Array:
    """A statistic of every column's known values, shape (columns,); NaN with fewer than three."""
    columns = [column[np.isfinite(column)] for column in values.T]
    return np.array([statistic(column) if len(column) > 2 else np.nan for column in columns], float)


def explained_by(x: Array, y: Array) -> float:
    """Var(E[Y|x_i])/Var(Y) of scattered runs: variance between bins of equal count, less that of their noise.

    Unbiased but for the trend inside bins (below 1/bins² of the index); may come out slightly negative.
    """
    known = np.isfinite(y)
    x, y = x[known], y[known]
    bins = min(40, len(y) // RUNS_PER_BIN)
    if bins < 2 or not y.var() > 1e-28 * np.square(y).mean():
        return np.nan
    if np.ptp(x) == 0:
        return 0.0
    parts = np.array_split(y[np.argsort(x, kind="stable")], bins)
    counts = np.array([len(part) for part in parts])
    means = np.array([part.mean() for part in parts])
    noise = sum(((part - part.mean()) ** 2).sum() for part in parts) / (len(y) - bins)
    between = (counts * (means - y.mean()) ** 2).sum() / len(y) - noise * (bins - 1) / len(y)
    return float(between / y.var())
