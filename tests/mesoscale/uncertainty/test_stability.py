"""Every unusual case gives its known answer or says that there is none."""

from mesoscale.uncertainty.studies.stability import CASES, COLUMNS, stability_rows


def test_every_case_of_the_study_passes():
    rows = list(stability_rows())
    assert {row["case"]: row["detail"] for row in rows if not row["passed"]} == {}
    assert len(rows) == len(CASES)
    assert tuple(rows[0]) == COLUMNS


def test_a_case_that_raises_is_a_failed_case(monkeypatch):
    def broken():
        raise RuntimeError("lost")

    monkeypatch.setattr("mesoscale.uncertainty.studies.stability.CASES", [("lost", "raises", broken)])
    (row,) = stability_rows()
    assert not row["passed"]
    assert row["detail"] == "RuntimeError: lost"
