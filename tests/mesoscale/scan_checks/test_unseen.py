"""What unseen waves do to the contact."""

import pytest

from mesoscale.inputs.contact import ContactInputs
from mesoscale.scan_checks.unseen import unseen_shares
from mesoscale.settings import ContactSettings, LawSettings

INPUTS = ContactInputs(hamaker=0.2, e_star=91, h_macro=2, h_prime=8, q0=0.025, hurst=0.6, rms=4)
CONTACT = ContactSettings(pixels=128, length_nm=500.0)


def rows(seen, inputs=INPUTS):
    return {row["quantity"]: row for row in unseen_shares(inputs, CONTACT, LawSettings(), seen)}


def test_waves_that_end_before_the_instrument_change_nothing():
    for row in rows(seen=5.0).values():
        assert (row["shift"], row["share"]) == (0, 0)
        assert row["seen"] == row["all"]


def test_the_less_is_seen_the_more_is_extrapolated():
    little, more = rows(seen=0.1), rows(seen=0.4)
    # shorter waves only add height: contact comes earlier
    assert little["first_contact"]["shift"] > more["first_contact"]["shift"] > 0
    assert little["first_contact"]["share"] > more["first_contact"]["share"] > 0
    assert 0 <= little["pull_off"]["share"] < 1
    assert little["first_contact"]["end_q"] == pytest.approx(CONTACT.nyquist_per_nm)


def test_without_attraction_nothing_is_said_of_it():
    assert "share" not in rows(0.2, ContactInputs(**{**vars(INPUTS), "hamaker": 0.0}))["pull_off"]


def test_where_q1_ends_the_surfaces_it_is_said_what_more_waves_would_do():
    ended = CONTACT.model_copy(update={"q1_per_nm": 0.4})
    made = list(unseen_shares(INPUTS, ended, LawSettings(), 0.2))
    first = [row for row in made if row["quantity"] == "first_contact"]
    assert [row["end_q"] for row in first] == pytest.approx([0.4, CONTACT.nyquist_per_nm])
    assert 0 < first[0]["shift"] < first[1]["shift"]
    # without the end the same waves have the same heights: the RMS height is that up to q1
    assert first[0]["seen"] == first[1]["seen"]
