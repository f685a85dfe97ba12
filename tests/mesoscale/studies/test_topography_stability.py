"""Hard cases: each recovers known truth, doubts or refuses; another answer than the expected one
fails.
"""

from dataclasses import replace

import pytest

from mesoscale.settings import TopographySettings
from mesoscale.studies.topography_files import FILE_CASES, check_files
from mesoscale.studies.topography_stability import CASES, TRUTH, check

BY_NAME = {case.name: case for case in CASES}


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_hard_case(case):
    passed, detail = check(case, TopographySettings())
    assert passed, detail


@pytest.mark.parametrize("case", FILE_CASES, ids=lambda case: case.name)
def test_hard_files(case):
    passed, detail = check_files(case)
    assert passed, detail


def test_there_are_thirty_hard_cases_and_another_answer_of_files_fails():
    assert len(CASES) + len(FILE_CASES) >= 30
    by_name = {case.name: case for case in FILE_CASES}
    assert not check_files(replace(by_name["level"], word="another reason"))[0]
    assert not check_files(replace(by_name["container"], word="refused"))[0]


@pytest.mark.parametrize(
    ("name", "change", "detail"),
    [
        (
            "standard",
            {"truth": TRUTH.model_copy(update={"rms_nm": 1.2 * TRUTH.rms_nm})},
            "rms -0.1",
        ),
        ("standard", {"expected": "doubts"}, "no doubts: "),
        ("standard", {"expected": "refuses"}, "was not refused"),
        ("constant", {"expected": "recovers"}, "rms +inf"),
        ("saturated", {"word": "another reason"}, "cut off"),
    ],
)
def test_another_answer_fails(name, change, detail):
    passed, text = check(replace(BY_NAME[name], **change), TopographySettings())
    assert not passed
    assert detail in text
