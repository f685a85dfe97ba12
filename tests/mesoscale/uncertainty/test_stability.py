"""Every unusual case gives its known answer or says that there is none."""

import pytest

from mesoscale.uncertainty.studies.stability import stability_checks


@pytest.mark.parametrize("check", stability_checks(), ids=lambda check: check[0])
def test_every_case_of_the_study_passes(check):
    passed, detail = check[3]()
    assert passed, detail
