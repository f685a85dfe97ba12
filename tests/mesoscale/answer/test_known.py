"""What is known of the release: two kinds of numbers, and the limits where all are of one kind."""

import numpy as np
import pytest
from scipy.stats import qmc

from mesoscale.answer.known import _fit, fit_additive, known

UNITS = qmc.LatinHypercube(3, rng=2).random(200)
X = 2.0 * UNITS - 1.0
COMMON = np.array([True, False, False])


def test_shares_of_the_variance_are_those_of_a_known_function():
    """y = 9 + 3 x1 + x2^2: variances 9/3 and 4/45."""
    fit = fit_additive(UNITS, 9.0 + 3.0 * X[:, 0] + X[:, 1] ** 2)
    total = 3.0 + 4.0 / 45.0
    np.testing.assert_allclose(fit.shares(), [3.0 / total, 4.0 / 45.0 / total, 0.0], atol=0.02)
    assert (fit.power, fit.degree) == (1, 2)
    assert fit.explained > 0.9999


def test_a_square_that_is_a_sum_is_fitted_as_a_square_and_below_zero_the_switch_sticks():
    squares = 16.0 + 15.0 * X[:, 0] + 8.0 * X[:, 1]
    release = np.sqrt(np.maximum(squares, 0.0))
    fit = fit_additive(UNITS, release)
    assert fit.power == 2
    stuck = release == 0.0
    assert 3 < stuck.sum() < 40
    assert fit.values[stuck].max() < 0.0
    # what is fitted knows only that they lie below zero
    np.testing.assert_allclose(fit.coefficients[1:3] * np.sqrt(3.0), [15.0, 8.0], rtol=0.03)


@pytest.mark.parametrize("share", [0.25, 0.5, 0.75])
def test_switches_that_stick_bias_neither_the_sum_nor_its_scatter(share):
    """Means over 20 made-up populations, within four of their standard errors."""
    coefficients, scatters = [], []
    for seed in range(20):
        rng = np.random.default_rng(seed)
        units = rng.random((128, 3))
        x = 2.0 * units - 1.0
        values = 10.0 * x[:, 0] + 5.0 * x[:, 1] + 2.0 * rng.normal(size=128)
        release = np.maximum(values - np.quantile(values, share), 0.0)
        fit = _fit(units, release, 1, 1)
        coefficients.append(fit.coefficients[1:3] * np.sqrt(3.0))
        scatters.append(fit.missed)
    for found, truth in ((coefficients, [10.0, 5.0]), (scatters, 2.0)):
        off = np.abs(np.mean(found, axis=0) - truth)
        assert (off < 4.0 * np.std(found, axis=0) / np.sqrt(20)).all()


@pytest.mark.parametrize("free", [0, 1, 3])
def test_hardly_a_switch_that_lets_go_tells_nothing_of_causes(free):
    release = np.zeros(200)
    release[:free] = 1.0 + np.arange(free)
    fit = fit_additive(UNITS, release)
    assert fit.shares().tolist() == [0.0, 0.0, 0.0]
    bands = known(fit, COMMON, 0.0)
    assert bands["stuck_share"]["0.5"]["value"] > 0.9
    assert bands["unknown_V"]["0.5"]["value"] == 0.0


def test_bands_and_share_are_those_of_the_function():
    bands = known(fit_additive(UNITS, 3.0 + 2.0 * X[:, 0] + 0.5 * X[:, 1]), COMMON, 0.0)
    for kind, half in (("unknown", 0.9 * 2.0), ("between", 0.9 * 0.5)):
        for q, value in (("0.05", 3.0 - half), ("0.5", 3.0), ("0.95", 3.0 + half)):
            assert bands[f"{kind}_V"][q]["value"] == pytest.approx(value, abs=0.08)
    assert bands["rest_V"] < 0.01


@pytest.mark.parametrize(("common", "kinds"), [(True, {0.0149, 1.0}), (False, None)])
def test_where_all_is_common_all_stick_or_none_and_where_nothing_is_there_is_one_share(
    common, kinds
):
    """Shares below three in the number of switches are not told: 0.015."""
    fit = fit_additive(UNITS, np.maximum(1.0 + 2.0 * X[:, 0] + X[:, 1], 0.0))
    shares = {row["value"] for row in known(fit, np.full(3, common), 0.0)["stuck_share"].values()}
    if kinds:
        assert all(min(abs(share - kind) for kind in kinds) < 0.06 for share in shares)
        assert len(shares) > 1
    else:
        assert len(shares) == 1
        assert shares.pop() == pytest.approx(0.25, abs=0.05)


def test_error_bars_of_the_bands_hold_the_truth():
    """Sums with noise, 40 switches each: the band's ends within two errors in at least 18 of 20."""
    held, rng = 0, np.random.default_rng(1)
    for _ in range(20):
        units = rng.random((40, 3))
        x = 2.0 * units - 1.0
        fit = fit_additive(units, 9.0 + 2.0 * x[:, 0] + 0.5 * x[:, 1] + 0.3 * rng.normal(size=40))
        row = known(fit, COMMON, 0.0)["unknown_V"]["0.95"]
        held += abs(row["value"] - 9.0 - 1.8) < 1.96 * row["error"] + 0.05  # 0.05: a thousand draws
    assert held >= 18


def test_switches_none_of_which_sticks_know_no_smaller_share_than_three_in_them():
    """Of 33 less than 8.7 %: 0.913^33 = 0.05."""
    rng = np.random.default_rng(3)
    units = rng.random((33, 3))
    fit = fit_additive(units, 9.0 + units @ [1.0, 0.5, 0.2])
    for share in known(fit, COMMON, 0.0)["stuck_share"].values():
        assert (1.0 - share["value"]) ** 33 == pytest.approx(0.05)
        assert share["high"] == share["value"]
        assert share["low"] < 1e-6
