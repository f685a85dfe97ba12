"""One answer of one model: what the switch does, what that hangs on, what to do next."""

import re
from types import SimpleNamespace

import pytest

from workflow.report.first import (
    _bands,
    _conditions,
    _known,
    _largest,
    _release,
    _unsolved,
    release_bar,
)
from workflow.report.gates import _attraction, trust
from workflow.report.page import Gate
from workflow.report.stages.circuit import marks
from workflow.report.verdict import CELLS, verdict

SOUND = [
    Gate("law", False, ("misses",), answer=False),
    Gate("hardness", False, ("too few runs",), used=False),
]
BOTH_LAWS = [
    {"times": 1 / 3, "release_V": 9.0},
    {"times": 1.0, "release_V": 7.4},
    {"times": 3.0, "release_V": 0.0},
]


def _described(low, middle, high):
    return {"quantiles": {"0.05": low, "0.5": middle, "0.95": high}}


def _probability(value):
    return {"value": value, "low": max(value - 0.05, 0), "high": min(value + 0.05, 1)}


def _pad(stuck=0.02, cells=0.1, explained=0.9, **more):
    """As answer/pad_switch.json with an answer for the inputs, D0 and geometry; the release's
    variance is 4 V².
    """
    rows = [("bow_nm", "each", 0.5), ("rms", "common", 0.25), ("gap_cutoff_nm", "common", 0.1)]
    return {
        "electrode": "bending",
        "central": {"release_V": 7.4},
        "by_attraction": BOTH_LAWS,
        "answer": {
            "release_V": _described(3.1, 6.6, 9.4),
            "stuck": _probability(stuck),
            "causes": {"common": 0.4, "each": 0.5, "cells": cells},
            "sensitivity": [
                {
                    "name": name,
                    "varies": varies,
                    "share_of_variance": share,
                    "interval_shrinks_by": share / 2,
                }
                for name, varies, share in rows
            ],
            **{"points": 64, "explained": explained, "cells_error_V": 2.0 * cells**0.5},
        },
        "answer_status": "ok",
        **more,
    }


def _results(pad, coupled=False, attraction="clamped"):
    return SimpleNamespace(
        has=lambda *names: pad is not None,
        json=lambda name: pad,
        coupled=coupled,
        contact={"attraction": attraction},
    )


def said(pad, gates=SOUND, **about):
    return verdict(_results(pad, **about), gates)


def test_verdict_says_outcome_and_next_step():
    assert (
        said(_pad()).sentence
        == "The switch lets go at 6.60 V (5\u00a0%:\u00a03.10 V; 95\u00a0%:\u00a09.40 V); 2% stick."
        " Control next the bow of the electrode at rest: known exactly, it shrinks the interval"
        " by 25%."
    )
    assert said(_pad()).causes == (("bow", 0.5), ("RMS roughness", 0.25), ("D₀", 0.1), (CELLS, 0.1))


@pytest.mark.parametrize(
    ("stuck", "words"),
    [
        (1.0, "The switch sticks"),
        (0.4, "is open: 40% stick; the median is 6.60 V"),
        (0.0, "The switch lets go at"),
    ],
)
def test_verdict_says_when_it_is_not_decided(stuck, words):
    assert words in said(_pad(stuck)).outcome


@pytest.mark.parametrize(("stuck", "words"), [(False, "lets go at 6.66 V"), (True, "sticks")])
def test_without_an_interval_the_same_model_gives_its_central_value_and_the_reason(stuck, words):
    """Not the flat electrode's, which sticks more: 7.86 V of one scene stood beside "sticks" of
    another.
    """
    central = {"release_V": 0.0 if stuck else 6.66}
    why = "13 of 64 switches cannot be solved"
    without = said({**_pad(), "answer": None, "answer_status": why, "central": central})
    reason = "no interval, because 13 of 64 switches cannot be solved."
    assert without.outcome == f"At central inputs the switch {words}; {reason}"
    assert without.stuck is None
    assert without.electrode == said(_pad()).electrode == "bending electrode"


def test_a_pad_that_gives_no_number_says_why():
    gate = {"passed": False, "reasons": ["the beam does not land"]}
    pad = {
        "electrode": "bending",
        "central": None,
        "answer": None,
        "answer_status": "no points",
        "gate": gate,
    }
    assert said(pad).outcome == "The release voltage is not known, because the beam does not land."
    assert verdict(_results(None), SOUND) is None


def test_a_coupled_switch_that_sticks_does_so_by_an_upper_bound():
    assert "Measure a pull-off force next" in said(_pad(1.0), coupled=True).sentence
    assert "stiffer" in said(_pad(1.0)).sentence


def test_what_varies_is_named_in_words():
    """ "Measure next s_RMS better" told nobody to scan more places."""
    rows = [
        {
            "name": "rms_scatter",
            "varies": "common",
            "share_of_variance": 0.5,
            "interval_shrinks_by": 0.3,
        }
    ]
    pad = _pad()
    assert said({**pad, "answer": {**pad["answer"], "sensitivity": rows}}).next_step.startswith(
        "Scan more places next"
    )
    rows[0]["varies"] = "each"
    controlled = said({**pad, "answer": {**pad["answer"], "sensitivity": rows}}).next_step
    assert controlled.startswith("Control next the roughness from place to place:")
    rows[0] |= {"name": "h_macro", "varies": "common"}
    hardness = said({**pad, "answer": {**pad["answer"], "sensitivity": rows}})
    assert hardness.next_step.startswith("Measure next the macroscopic hardness H_macro:")


def test_few_cells_are_named_before_any_measurement():
    assert said(_pad(cells=0.7)).causes[0] == (CELLS, 0.7)
    assert said(_pad(cells=0.7)).next_step == "Compute more cells next (pad.point_cells)."


def test_no_cause_is_named_where_the_fit_behind_it_explains_little():
    doubted = said(_pad(explained=0.29))
    assert doubted.causes == ()
    assert "explains only 29%" in doubted.no_cause
    assert doubted.next_step == "More switches might tell what decides it (pad.points)."
    nothing = said(_pad(explained=-0.7))
    assert "64 computed switches are too few to tell" in nothing.no_cause
    assert nothing.next_step == "Compute more switches next (pad.points)."


def test_only_what_the_answer_rests_on_is_mended_first():
    failed = Gate("pad", False, ("cells do not settle",))
    assert said(_pad(), [failed, *SOUND]).next_step == "Mend first what failed: pad."
    assert trust([failed, *SOUND])[0] == "fail"
    assert trust(SOUND)[0] == "pass"
    assert trust([Gate("topography", True, ("one place",)), *SOUND])[0] == "warn"


def test_both_laws_of_attraction_are_shown():
    assert said(_pad()).other_law_V == (7.4, 9.0)
    assert said(_pad(), attraction="offset").other_law_V == (7.4, 0.0)
    assert (
        said(_pad(by_attraction=[{**row, "release_V": None} for row in BOTH_LAWS])).other_law_V
        is None
    )


def test_the_light_knows_that_the_other_law_changes_the_outcome():
    """It was green beside "as by the other law, it sticks"."""
    (gate,) = _attraction(_results(_pad(), attraction="offset"))
    assert trust([gate, *SOUND])[0] == "warn"
    assert not list(_attraction(_results(_pad())))


def test_a_switch_that_always_sticks_is_not_said_to_depend_on_an_input():
    pad = _pad(1.0)
    answer = pad["answer"]
    answer["causes"] = dict.fromkeys(answer["causes"], 0.0)
    answer["sensitivity"] = [{**row, "share_of_variance": 0.0} for row in answer["sensitivity"]]
    answer["release_V"] = _described(0.0, 0.0, 0.0)
    assert said(pad).causes == ()
    assert "all 64 computed combinations" in said(pad).no_cause


def test_the_bar_has_the_zone_of_sticking_apart_from_the_axis_of_volts():
    bar = release_bar(said(_pad()))
    assert 'class="zone"' in bar
    assert 'class="interval"' in bar
    assert " 2\u202f%" in bar
    assert 'class="other"' in bar
    assert 'class="interval"' not in release_bar(said({**_pad(), "answer": None}))


def test_switches_without_answer_are_named_with_the_reason_of_the_first():
    assert _unsolved({"points": 126, "refused": []}) == ""
    words = _unsolved({"points": 126, "refused": ["asperities merge", "another"]})
    assert words.startswith("Of 128 switches, 2 without an answer are left out.")
    assert words.endswith("The reason of the first: asperities merge.")


def test_devices_that_never_close_stand_on_the_first_screen():
    never = {"value": 0.25, "low": 0.15, "high": 0.4}
    words = _unsolved({"points": 96, "refused": [], "never_close": never})
    assert words.startswith("25% of the devices never close at the stated hold voltage")
    assert "15% to 40%" in words
    none = {"value": 0.0, "low": 0.0, "high": 0.04}
    assert _unsolved({"points": 96, "refused": [], "never_close": none}) == ""


def test_the_next_step_is_to_measure_pull_in_where_that_tells_most():
    pad = _pad()
    pad["answer"]["pull_in_shrinks_by"] = 0.45
    assert "Measure next the pull-in of the device" in said(pad).next_step
    assert "shrinks the interval by 45%" in said(pad).next_step
    pad["measured"] = {"measured": {"pull_in_V": {}}}
    assert said(pad).next_step.startswith("Control next the bow")
    pad = _pad(electrode="flat")
    pad["answer"]["pull_in_shrinks_by"] = 0.45
    assert said(pad).next_step.startswith("Control next the bow")


def test_the_page_says_which_voltage_is_the_release():
    fallen = [{"release_at": "jump", "release_V": 9.3}, {"release_at": 0.5, "release_V": 31.0}]
    results = _results({"by_capacitance": fallen})
    results.record = {"scene": {"device": {}}}
    assert "jumps open" in _release(results)
    assert "fallen to half before, at 31.0 V" in _release(results)
    results.record["scene"]["device"]["release_at"] = 0.5
    assert _release(results).startswith("Release: where the capacitance has fallen to 50%")
    assert _release(results).endswith("jumps open at 9.30 V, at central inputs.")


def test_the_loop_marks_where_it_lands_loses_half_and_opens():
    """Lands at 70 V, has 50 of 100 left between 30 and 40 V, opens between 0 and 10 V."""
    up = [1.0, 1.0, 1.0, 1.0, 1.1, 1.2, 1.4, 95.0, 100.0]
    down = [1.0, 17.0, 20.0, 45.0, 60.0, 70.0, 80.0, 95.0, 100.0]
    rows = [
        {"voltage_V": 10.0 * k, "up_central_fF": u, "down_central_fF": d}
        for k, (u, d) in enumerate(zip(up, down, strict=True))
    ]
    assert marks(rows) == {"lands": (70.0, 95.0), "half": (40.0, 60.0), "opens": (10.0, 17.0)}
    # a loop of both polarities, as of a charged switch
    other = [{**row, "voltage_V": str(-float(row["voltage_V"]))} for row in rows[:0:-1]]
    assert marks([*other, *rows]) == marks(rows)


@pytest.mark.parametrize(
    ("span", "air", "words"),
    [
        (None, None, "In dry air"),
        ((0.0, 0.8), None, "In air of 0% to 80% humidity"),
        ((0.4, 0.4), None, "In air of 40% humidity"),
        (None, {"humidity": 0.4}, "In air of 40% humidity"),
    ],
)
def test_the_first_screen_says_which_air_it_is_of(span, air, words):
    scene = {"contact": {"air": air}, "device": {"temperature_C": 85.0}}
    results = SimpleNamespace(
        has=lambda name: True, record={"scene": scene}, span_of=lambda name: span
    )
    said = _conditions(results)
    assert said.startswith(words)
    assert said.endswith(", at 85 °C, uncharged.")


def test_a_switch_that_sticks_is_told_what_frees_it():
    thick = {"key": "thickness_um", "unit": "um", "value": 1.0, "frees": 1.8}
    gap = {"key": "gap_um", "unit": "um", "value": 1.5, "frees": None}
    smooth = {"key": "rms", "unit": "nm", "value": 3.0, "frees": 4.0}
    rows = [thick, gap, smooth]
    assert "freed by: RMS roughness 4.00 nm" in said(_pad(1.0, reserve={"freed_by": rows})).sentence
    assert "no single property" in said(_pad(1.0, reserve={"freed_by": [gap]})).sentence


def test_where_a_share_sticks_the_next_step_says_with_what_fewer_would():
    rows = [
        {"key": "thickness_um", "unit": "um", "value": 4.0, "other": 5.6, "stuck": 0.12},
        {"key": "gap_um", "unit": "um", "value": 3.0, "other": 4.2, "stuck": 0.2},
    ]
    words = " With thickness 5.60 µm, 12% of the 64 switches would stick instead of 40%."
    assert said(_pad(0.4, sticking_by_key=rows)).next_step.endswith(words)
    assert "would stick" not in said(_pad(0.4, sticking_by_key=[])).next_step


def test_a_cause_of_nothing_is_not_listed():
    rows = [("bow_nm", "each", 0.004), ("gap_um", "each", 0.3), ("rms", "common", 0.5)]
    names = ("name", "varies", "share_of_variance")
    answer = {"sensitivity": [dict(zip(names, row, strict=True)) for row in rows]}
    assert _largest(answer, "each") == [("gap", 30)]


def _with_bands(error_V):
    ends = {"0.05": 3.0, "0.5": 6.0, "0.95": 9.0}
    band = {end: {"value": value, "error": error_V} for end, value in ends.items()}
    known = {"unknown_V": band, "between_V": band}
    known["stuck_share"] = {"0.95": {"value": 0.1, "high": 0.1}}
    return {**_pad()["answer"], "known": known}


def test_bands_have_their_error_and_fit_on_the_axis():
    answer = _with_bands(0.4)  # the interval is 6.3 V wide
    assert "3.00\u00a0±\u00a00.4 to 9.00\u00a0±\u00a00.4 V" in _known(answer, _bands(answer))
    bar = release_bar(said(_pad()), _bands(answer), {"0.05": 0.3, "0.95": 0.5})
    assert 'class="unknown error"' in bar
    assert "from device to device" in bar
    right_ends = [float(path) for path in re.findall(r"H(\d+\.\d)", bar)]
    assert max(right_ends) < 410.0


def test_bands_that_few_switches_cannot_tell_apart_are_not_drawn():
    answer = _with_bands(2.0)
    assert _bands(answer) == {}
    assert "cannot be told apart by a fit to 64 switches" in _known(answer, {})
    assert "between" not in release_bar(said(_pad()), {})


def test_where_most_stick_it_is_told_what_frees_the_one_at_central_inputs():
    rows = [{"key": "rms", "unit": "nm", "value": 4.0, "frees": 9.0}]
    pad = _pad(0.9, central={"release_V": 0.0}, reserve={"freed_by": rows})
    assert said(pad).next_step.startswith("At central inputs it is freed by: RMS roughness 9.00 nm")
