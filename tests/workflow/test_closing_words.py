"""What a run with measurements says at its end."""

from workflow.run.closing_words import judgement


def row(**values):
    return {"scan": "a", "quantity": "first_contact", "left_out": "False", "low": "3", "high": "5", **values}


def test_a_scan_outside_its_description_is_a_doubt():
    assert not any("DOUBT" in line for line in judgement([row(pressed="4", inside="True")]))
    (line,) = judgement([row(pressed="9", inside="False")])
    assert line.startswith("DOUBT (pressing_disagrees")
    assert "a touches first at 9 nm, its description says 3 to 5 nm" in line
    (line,) = judgement([])
    assert line.startswith("no scan could be pressed")
