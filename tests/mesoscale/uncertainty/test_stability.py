"""Every unusual case gives its known answer or says that there is none; a wrong answer is named."""

import pytest

from mesoscale.uncertainty.studies import stability
from mesoscale.uncertainty.studies.stability import stability_checks


@pytest.mark.parametrize("check", stability_checks(), ids=lambda check: check[0])
def test_every_case_of_the_study_passes(check):
    passed, detail = check[3]()
    assert passed, detail


def test_a_wrong_index_is_named(monkeypatch):
    right = stability.sensitivity_rows
    monkeypatch.setattr(
        stability, "sensitivity_rows", lambda *given: [row | {"sobol_total": 0.5} for row in right(*given)]
    )
    (check,) = (run for name, *_, run in stability_checks() if name == "zero width")
    assert check() == (False, "index one of the other")
