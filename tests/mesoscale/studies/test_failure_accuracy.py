"""The accuracy table of the failure rate, on the plates of the study."""

import numpy as np
import pytest

from evidence.pad.rare_failures import population
from mesoscale.studies.failure_accuracy import LEVELS, RUNS, accuracy_points


@pytest.fixture(scope="module")
def rows():
    return list(accuracy_points(population(), 1e-3))


def of(rows, knob):
    return [(row["value"], row["error"], row["cpu_s"]) for row in rows if row["knob"] == knob]


def test_every_number_of_samples_has_its_error_and_time(rows):
    assert [value for value, *_ in of(rows, "points of a level")] == list(LEVELS)
    assert [value for value, *_ in of(rows, "switches that correct it")] == list(RUNS)
    learned = [value for value, *_ in of(rows, "switches it learns from")]
    assert learned == sorted(set(learned))
    assert all(np.isfinite(row["error"]) and row["cpu_s"] > 0.0 for row in rows)


def test_more_switches_correct_better(rows):
    """As the root of their number, until the scatter of the sampling is left."""
    (_, few, _), *_, (_, many, _) = of(rows, "switches that correct it")
    assert many < 0.8 * few
    assert many < 0.3  # one in a thousand in four levels of 4000 points is known to some 8 %
