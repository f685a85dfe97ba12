"""What a run with measurements says at its end."""

from workflow.terminal.closing_words import judgement, unseen


def row(**values):
    return {"scan": "a", "quantity": "first_contact", "left_out": "False", "low": "3", "high": "5", **values}


def test_unseen_waves_are_told_with_their_share():
    ends = {"seen_q": "0.31", "end_q": "1.6"}
    known = {"quantity": "pull_off", "shift": "-0.5", "share": "0.12", **ends}
    lines = list(unseen([{"quantity": "C_r", "shift": "", "share": "", **ends}, known]))
    assert lines == ["unseen waves of 0.31 to 1.6 /nm would change (share of the variance): pull_off -50% (12%)"]
    assert list(unseen([{"quantity": "C_r", "shift": "", "share": "", **ends}])) == []


def test_a_scan_outside_its_description_is_a_doubt():
    assert not any("DOUBT" in line for line in judgement([row(pressed="4", inside="True")]))
    (line,) = judgement([row(pressed="9", inside="False")])
    assert line.startswith("DOUBT (pressing_disagrees")
    assert "a touches first at 9 nm, its description says 3 to 5 nm" in line
    (line,) = judgement([])
    assert line.startswith("no scan could be pressed")
