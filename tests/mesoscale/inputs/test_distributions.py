"""Distributions by their moments and ends, and the correlation of joint samples."""

import numpy as np
import pytest

from mesoscale.errors import InputError
from mesoscale.inputs.distributions import (
    Distribution,
    InputTable,
    UncertainInput,
    correlation_matrix,
)


def table(*distributions, correlation=None):
    rows = tuple(
        UncertainInput(f"x{k}", "1", d, "literature", "") for k, d in enumerate(distributions)
    )
    return InputTable(rows, np.eye(len(rows)) if correlation is None else correlation)


@pytest.mark.parametrize(
    ("distribution", "mean", "deviation"),
    [
        (Distribution("uniform", 2, 15), 8.5, 13 / np.sqrt(12)),
        (
            Distribution("log_uniform", 2, 8),
            6 / np.log(4),
            np.sqrt(30 / np.log(4) - (6 / np.log(4)) ** 2),
        ),
        (Distribution("normal", 91, 3.8), 91, 3.8),
        (Distribution("truncated_normal", 0, 1, -1, 1), 0, 0.539560),  # 1 - 2 phi(1)/(2 Phi(1) - 1)
        (Distribution("fixed", 3), 3, 0),
        (Distribution("samples", values=np.array([1.0, 2.0, 3.0])), 2, 1 / np.sqrt(3)),
        (Distribution("normal", 5, 0), 5, 0),
    ],
)
def test_moments(distribution, mean, deviation):
    values = distribution.quantile((np.arange(200000) + 0.5) / 200000)
    assert values.mean() == pytest.approx(mean, abs=1e-3)
    assert values.std() == pytest.approx(deviation, rel=1e-3, abs=1e-9)


def test_the_median_of_a_range_over_orders_is_no_midpoint():
    """A line gave an RMS height of 576 nm as the middle of a skewed range; its truth was 4 nm."""
    assert Distribution("log_uniform", 0.01, 1600).quantile(np.array([0.5])) == pytest.approx([4.0])


def test_nodes_span_the_central_share_of_a_normal_and_all_of_the_others():
    assert Distribution("normal", 91, 3.8).span() == pytest.approx(
        (91 - 3.290527 * 3.8, 91 + 3.290527 * 3.8)
    )
    assert Distribution("uniform", 2, 15).span() == (2, 15)


def test_samples_carry_the_rank_correlation():
    matrix = correlation_matrix(["x0", "x1", "x2"], {("x0", "x1"): -0.6})
    given = table(
        Distribution("uniform", 0, 1),
        Distribution("normal", 0, 1),
        Distribution("uniform", 0, 1),
        correlation=matrix,
    )
    values = given.sample(40000, 1)
    ranks = values.argsort(axis=0).argsort(axis=0)
    measured = np.asarray(np.corrcoef(ranks.T))
    # standard error of a correlation: 1/sqrt(40000) = 0.005
    assert measured[0, 1] == pytest.approx(-0.6, abs=0.02)
    assert abs(measured[0, 2]) < 0.02
    assert values[:, 0].min() >= 0
    assert values[:, 0].max() <= 1


def test_contradicting_correlations_are_refused():
    with pytest.raises(InputError, match="contradict"):
        correlation_matrix(["a", "b", "c"], {("a", "b"): 0.95, ("b", "c"): 0.95, ("a", "c"): -0.95})


def test_same_seed_same_samples():
    given = table(Distribution("uniform", 0, 1), Distribution("normal", 0, 1))
    assert np.array_equal(given.sample(50, 3), given.sample(50, 3))
    assert not np.array_equal(given.sample(50, 3), given.sample(50, 4))
