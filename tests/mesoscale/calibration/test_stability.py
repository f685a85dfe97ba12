"""Hard cases of the calibration that take no long chain; `stability/calibration.csv` has them all."""

import pytest

from mesoscale.calibration.studies.stability import CASES, Bench, stability_checks

QUICK = ("one unknown", "fixed input", "same datum twice", "outside the model", "failing cycles", "chain too short")


@pytest.fixture(scope="module")
def checks():
    return {case: check for case, _, _, check in stability_checks(Bench.computed())}


def test_there_are_at_least_fifteen_cases_of_different_names():
    assert len({case for case, _, _ in CASES}) == len(CASES) >= 15


@pytest.mark.parametrize("case", QUICK)
def test_known_answer_or_refused(checks, case):
    assert checks[case]() == (True, "")
