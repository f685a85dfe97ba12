"""Regression of values that are partly known only to lie below zero."""

import numpy as np
import pytest
from scipy import stats

from mesoscale.errors import InputError
from mesoscale.uncertainty import censored
from mesoscale.uncertainty.censored import censored_chaos, most_likely

RANGES = np.tile([-1.0, 1.0], (6, 1))
ENDS = np.array([[-1.0, 0, 0, 0, 0, 0], [1.0, 0, 0, 0, 0, 0]])


def made_up(count, scatter, seed):
    """A line that falls through zero in the middle: half of the values are below zero."""
    rng = np.random.default_rng(seed)
    x = rng.uniform(-1, 1, (count, 6))
    y = -10 * x[:, 0] + scatter * rng.standard_normal(count)
    return x, y, y < 0


def test_one_mean_and_scatter_are_those_of_another_code():
    """SciPy fits a normal distribution to censored data by its own likelihood."""
    y = np.random.default_rng(3).normal(0.5, 2.0, 80)
    below = y < 0
    fit = most_likely(np.ones((80, 1)), y, below)
    data = stats.CensoredData(uncensored=y[~below], left=np.zeros(below.sum()))
    mean, deviation = stats.norm.fit(data)
    # their search ends at 1e-4 of the value; ours counts a least scatter of 1e-3
    assert fit.coefficients[0] == pytest.approx(mean, rel=1e-3)
    known = (~below).sum()
    assert fit.scatter == pytest.approx(deviation * np.sqrt(known / (known - 1)), rel=1e-3)


@pytest.mark.parametrize("scatter", [0.0, 1.0, 3.0])
def test_the_line_and_the_scatter_are_unbiased(scatter):
    """Means over 20 made-up sets differ from the truth by less than four of their standard
    errors.
    """
    values, scatters = [], []
    for seed in range(20):
        fit, missed = censored_chaos(*made_up(200, scatter, seed), RANGES)
        values.append(fit(ENDS))
        scatters.append(missed)
    off = np.abs(np.mean(values, axis=0) - [10.0, -10.0])
    assert (off < 4 * np.std(values, axis=0) / np.sqrt(20) + 0.02).all()
    assert np.mean(scatters) == pytest.approx(scatter, rel=0.05, abs=0.01)


def test_what_is_known_below_zero_is_not_read():
    x, y, below = made_up(100, 1.0, 1)
    fit, scatter = censored_chaos(x, y, below, RANGES)
    other, same = censored_chaos(x, np.where(below, np.nan, y), below, RANGES)
    assert other(ENDS).tolist() == fit(ENDS).tolist()
    assert same == scatter


def test_errors_are_those_of_repeated_sets():
    """The stated error of the slope is its scatter over 100 made-up sets, within 4 / sqrt(200) of
    itself.
    """
    slopes, stated = [], []
    for seed in range(100):
        x, y, below = made_up(60, 2.0, seed)
        fit = most_likely(np.column_stack([np.ones(60), x[:, 0]]), y, below)
        slopes.append(fit.coefficients[1])
        stated.append(np.sqrt(fit.covariance[1, 1]))
    assert np.median(stated) == pytest.approx(np.std(slopes), rel=0.28)


def test_expected_values_give_the_same_line_by_least_squares():
    """At the maximum of the likelihood its slope is that of least squares with expected values."""
    x, y, below = made_up(100, 1.0, 2)
    matrix = np.column_stack([np.ones(100), x])
    fit = most_likely(matrix, y, below)
    assert fit.values[below].max() < 0.0
    np.testing.assert_allclose(np.linalg.lstsq(matrix, fit.values)[0], fit.coefficients, atol=1e-5)


def test_a_fit_that_does_not_settle_is_not_used(monkeypatch):
    monkeypatch.setattr(censored, "MOST_STEPS", 1)
    with pytest.raises(
        InputError, match=r"pad\.points: the fit of \d+ voltages .* did not settle in 1 steps"
    ):
        censored_chaos(*made_up(100, 1.0, 1), RANGES)
