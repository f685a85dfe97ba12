"""Stiff and extreme beams: each is solved with numbers that can be, or refused in one line that
says why.
"""

import pytest

from mesoscale.answer.spread import check_spread
from mesoscale.errors import InputError
from mesoscale.studies.answer_stability import (
    HIGHER,
    REFUSED,
    SOLVED,
    hard_beams,
    hard_cases,
    made_up_pad,
    published_beam,
    solved_beam,
)
from mesoscale.switch.beam import lumped_beam

CASES = list(hard_beams())


@pytest.mark.parametrize("case", CASES, ids=[case.name for case in CASES])
def test_hard_beams_are_solved_or_refused_in_one_line(case):
    passed, detail = case.judge()
    assert passed, detail


def test_no_hard_beam_is_left_out():
    assert (len(SOLVED), len(REFUSED), len(HIGHER)) == (25, 7, 6)
    assert len(CASES) == 38


def test_a_scene_is_tried_with_its_own_device_on_its_own_pad():
    device = published_beam(gap_um=2.3)
    own = [
        case for case in hard_cases(device, made_up_pad(2.0)) if case.name.startswith("own device")
    ]
    assert len(own) == 11
    assert own[0].description == "gap_um = 1.15"
    for case in own:
        passed, detail = case.judge()
        assert passed, f"{case.name}: {detail}"


def test_a_spread_that_leaves_no_device_and_a_beam_without_lumps_are_refused_in_one_line():
    wide = {"dielectric_nm": {"distribution": "normal", "values": [0, 0.5], "relative": True}}
    with pytest.raises(
        InputError,
        match=r"spread\.dielectric_nm: reaches dielectric_nm = -129.1: accepted is 0 nm or more",
    ):
        check_spread(published_beam(spread=wide))
    check_spread(published_beam())
    with pytest.raises(InputError, match="circuits are made of beams clamped at both ends"):
        lumped_beam(published_beam(ends="cantilever"), 8)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"electrode": (0.5, 1.2)}, r"electrode = \[0\.5, 1\.2\]: accepted are two rising shares"),
        ({"contact": (0.6, 0.4)}, r"contact = \[0\.6, 0\.4\]: accepted are two rising shares"),
        (
            {"spread": {"gap_um": {"values": [0, 1], "varies": ["common", "each"]}}},
            r"varies.*'common' or 'each'",
        ),
        (
            {"spread": {"gap_um": {"distribution": "normal", "values": [0]}}},
            "are none of distribution normal",
        ),
        ({"ends": "free"}, "'clamped' or 'cantilever'"),
    ],
)
def test_a_device_that_is_none_is_refused_in_one_line(change, words):
    with pytest.raises(InputError, match=words) as caught:
        published_beam(**change)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("electrode", "contact", "words"),
    [
        (
            (0.0, 0.05),
            (0.9, 1.0),
            r"null holds the beam with 47\d\d V, at which it touches before it would snap and is"
            " not pressed; raise hold_voltage_V above that, or place electrode nearer to contact",
        ),
        ((0.0, 0.02), (0.0, 1.0), "place electrode nearer to contact, or take a softer beam"),
        (
            (0.05, 0.2),
            (0.45, 0.55),
            r"at 390.1 V the electrode lands beside the contact part and presses .* GPa on",
        ),
        ((0.1, 0.3), (0.6, 0.9), r"at 202.6 V the beam does not land on the pad"),
    ],
)
def test_an_electrode_beside_its_contact_is_refused_for_a_true_reason(electrode, contact, words):
    """By its place, and not by voltages that nobody has or by a fault of the solver."""
    with pytest.raises(InputError, match=words):
        solved_beam(published_beam(electrode=electrode, contact=contact), made_up_pad(2.0))
