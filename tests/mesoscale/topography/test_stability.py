"""Hard cases: each recovers known truth, doubts or refuses."""

import pytest

from mesoscale.settings import TopographySettings
from mesoscale.topography.studies.stability import CASES, check

SLOW = {"4096"}  # a minute; part of `snakemake stability`


QUICK = [case for case in CASES if case.name not in SLOW]


@pytest.mark.parametrize("case", QUICK, ids=lambda case: case.name)
def test_hard_case(case):
    passed, detail = check(case, TopographySettings())
    assert passed, detail
