"""What a run with measurements says at its end."""

import math

import numpy as np
import pytest

from mesoscale.scan_checks.judged import disagreeing
from workflow.run.closing_words import judgement


def row(**values):
    return {
        "scan": "a",
        "quantity": "first_contact",
        "left_out": "True",
        "low": "3",
        "high": "5",
        **values,
    }


def test_a_scan_outside_its_description_is_a_doubt():
    (line,) = judgement([row(pressed="4", inside="True")])
    assert line.endswith("differ by no more than chance")
    (line,) = judgement([row(pressed="9", inside="False")])
    assert line.startswith("DOUBT (pressing_disagrees")
    assert "a touches first at 9 nm, its description says 3 to 5 nm" in line
    (line,) = judgement([])
    assert line.startswith("no scan could be pressed")


def test_a_description_made_from_the_scan_itself_is_not_testable():
    (line,) = judgement([row(pressed="4", inside="True", left_out="False", low="0.7", high="56")])
    assert "not testable" in line


@pytest.mark.parametrize("scans", [1, 6])
def test_of_right_descriptions_one_in_twenty_is_doubted(scans):
    rng = np.random.default_rng(scans)
    ends = {"low": math.exp(-1.645), "high": math.exp(1.645)}
    sets = [
        [row(**ends, pressed=math.exp(rng.standard_normal())) for _ in range(scans)]
        for _ in range(2000)
    ]
    # three standard deviations of a share of 0.05 in 2000
    assert np.mean([bool(disagreeing(rows)) for rows in sets]) == pytest.approx(0.05, abs=0.015)
