"""Unusual inputs and outputs of the propagation, as target `stability` runs them."""

import pytest

from mesoscale.studies.driver import HardCase
from mesoscale.studies.uncertainty_stability import hard_cases
from mesoscale.uncertainty import sensitivity


@pytest.fixture(autouse=True)
def small_samples(monkeypatch):
    """Few samples behind indices, so that the cases take a second."""
    monkeypatch.setattr(sensitivity, "SOBOL_SAMPLES", 512)
    monkeypatch.setattr(sensitivity, "SOBOL_RESAMPLES", 4)


@pytest.mark.parametrize("case", hard_cases(), ids=lambda case: case.name)
def test_known_answer_or_missing_and_counted(case: HardCase):
    passed, detail = case.judge()
    assert passed, detail
