"""Choices of atoms as the one driver takes them."""

import numpy as np
import pytest

from atomistic.for_studies import Deviations, HardCase, Variation
from mesoscale.studies.driver import rows_of
from workflow.run.studies_of_atoms import hard_rows, knobs_of


def rows(values, noise):
    found = Deviations(np.array(values), np.array(noise), 2.5)
    variation = Variation(
        "speed", [("B", "%"), ("force", "%")], [(50, lambda: found)], 50, "rest", "2 cuts"
    )
    return list(rows_of(knobs_of([variation], {"B": -0.2})))


def test_an_error_is_known_as_far_as_samples_and_noise_tell():
    modulus, force = rows([[3.0, 1.0], [5.0, 1.0]], [0.0, 0.7])
    assert modulus["error"] == pytest.approx(17**0.5)
    assert modulus["own_error"] == pytest.approx(1.0)
    assert force["own_error"] == pytest.approx(0.7)
    assert modulus["release_V"] == pytest.approx(0.2 * 17**0.5)
    assert force["release_V"] is None
    assert (modulus["cpu_s"], modulus["shipped"], modulus["reference"]) == (
        2.5,
        True,
        "rest; 2 cuts",
    )


def test_one_sample_is_known_by_its_noise_alone():
    assert [row["own_error"] for row in rows([[3.0, 1.0]], [0.4, 0.7])] == pytest.approx([0.4, 0.7])


def test_a_hard_case_that_raises_has_failed():
    def judge():
        raise ValueError("two\nlines")

    [row] = hard_rows([HardCase("case", "words", "checks", judge)])
    assert not row["passed"]
    assert row["detail"] == "ValueError: two lines"
