"""The section of the life of a held switch."""

import pytest

from workflow.report.stages.lifetime import (
    NARROWED,
    _allowed,
    _drive,
    of_ageing,
    of_drift,
    three_sentences,
)

ROWS = [
    {"guess": guess, "time_s": time, "release_q50_V": str(volts)}
    for guess, end in (("least", 12.0), ("central", 20.0), ("most", 40.0))
    for time, volts in (("0.0", 10.0), ("1.0", 11.0), ("3e8", end))
]


def life(decades, holds):
    guesses = {
        name: {"volts_a_decade": decade, "highest_hold_V": hold, "tried_V": 90.0}
        for name, decade, hold in zip(("least", "central", "most"), decades, holds, strict=True)
    }
    return {
        "years": 10.0,
        "hold_V": 70.0,
        "touching": 0.0123,
        "contact_factor": 1.5,
        "guesses": guesses,
    }


def test_three_sentences_say_what_a_life_does():
    said = three_sentences(life((8.0, 9.0, 11.0), (90.0, 60.0, None)), ROWS)
    assert said.count(". ") == 2
    assert "from 10.0 V to 20.0 V (12.0 V to 40.0 V" in said
    assert "1.23% of the pulled area touches" in said.replace(" %", "%")
    assert "for each 8.0 to 11 V more of hold; published lives" in said


@pytest.mark.parametrize("decades", [(None, None, None)])
def test_a_rate_that_no_volt_changes_is_said(decades):
    assert "does not depend on the hold voltage here" in three_sentences(
        life(decades, (None, None, None)), ROWS
    )


def test_the_largest_hold_is_said_by_guess():
    said = _allowed(life((8.0, 9.0, 11.0), (90.0, 60.0, None)))
    assert "at least 90.0 V (least charge), 60.0 V (central charge), none (most charge)" in said


def test_a_measured_drift_is_named_and_doubted():
    drift = {"rows": 16, "file": "drift.csv", "source": "our switches", "probability": 0.4}
    words = of_drift(drift)
    assert words == "16 shifts of drift.csv narrow the rates. Source: our switches."
    assert "No rates give this drift" in of_drift({**drift, "probability": 0.0})
    narrowed = three_sentences(life((8.0, 9.0, 11.0), (90.0, 60.0, None)), ROWS, NARROWED)
    assert "since a measured drift leaves the rates so far open" in narrowed


def test_the_drive_is_told():
    assert _drive({}) == "The electrode is held at one voltage from first closing on."
    cycles = {"period_s": 1e-3, "duty": 0.5, "other_polarity": 0.1}
    words = _drive({"cycles": cycles})
    assert "cycles of 0.001 s, of which the electrode is held for 0.5;" in words
    assert "Of the hold 0.1 is of the other polarity." in words


def test_ageing_is_said_by_effect_with_its_range():
    rows = [
        {"effect": effect, "guess": guess, "time_s": time, "release_V": str(volts)}
        for effect, ends in (("beam", (9.0, 6.0, 0.0)), ("bonds", (9.9, 9.5, 8.0)))
        for guess, end in zip(("least", "central", "most"), ends, strict=True)
        for time, volts in (("0.0", 10.0), ("3e8", end))
    ]
    ageing = {"strengths": {"beam": {}, "bonds": {}}, "menisci_99_s": 0.0231}
    said = of_ageing(ageing, rows)
    assert "lets go at 10.0 V at first" in said
    assert "By creep of the beam it goes to 6.00 V (sticks to 9.00 V)" in said
    assert "bonds it goes to 9.50 V (8.00 V to 9.90 V)" in said
    assert "within 23 ms of closing" in said
    assert "no effect acts here" in of_ageing({**ageing, "strengths": {}}, rows)
