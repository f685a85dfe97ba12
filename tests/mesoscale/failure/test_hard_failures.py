"""Rare, certain and impossible failures beside exact ones, and what the accuracy of a failure rate
tells.
"""

import numpy as np
import pytest

from evidence.failure.rare_failures import population
from mesoscale.studies.failure_accuracy import relative_errors
from mesoscale.studies.failure_stability import hard_cases

CASES = hard_cases(population(4))


@pytest.mark.parametrize("case", CASES, ids=[case.name for case in CASES])
def test_hard_failures_are_as_known(case):
    passed, detail = case.judge()
    assert passed, detail


def test_no_hard_failure_is_left_out():
    assert len(CASES) == 41
    assert len({case.name for case in CASES}) == len(CASES)


def test_the_error_of_correcting_runs_is_that_of_a_share():
    """Of runs with equal chances the mean is a share p, known to sqrt((1 - p) / (p n))."""
    factors = 2.0 * (np.random.default_rng(0).random(400) < 0.25)
    share = float((factors > 0).mean())
    error, own = relative_errors(factors, 100)
    assert error == pytest.approx(100.0 * np.sqrt((1.0 - share) / (share * 100)), rel=2e-3)
    assert 0.0 < own < 0.2 * error
    assert np.isnan(relative_errors(np.zeros(64), 64)).all()
    assert np.isnan(relative_errors(np.zeros(0), 64)).all()
