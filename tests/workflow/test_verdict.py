"""The sentence that opens the report: what the switch does, what that hangs on, what to do next."""

from types import SimpleNamespace

import pytest

from workflow.report.page import Gate
from workflow.report.verdict import release_cards, release_causes, verdict

SOUND = [Gate("law", True), Gate("hardness", False, ("too few runs",), used=False)]


def _described(low, middle, high):
    return {"samples": 96, "quantiles": {"0.05": low, "0.5": middle, "0.95": high}}


def _probability(value):
    return {"value": value, "low": max(value - 0.05, 0), "high": min(value + 0.05, 1), "samples": 96}


def _pad(stuck=0.02, cells=0.1, **more):
    """As device/pad_switch.json with an answer for the inputs, D0 and geometry."""
    causes = {"inputs": 0.3, "gap_cutoff": 0.1, "geometry": 0.5, "cells": cells}
    rows = [("bow_nm", 0.5), ("rms", 0.25), ("gap_cutoff_nm", 0.1)]
    return {
        "mean": {},
        "answer": {
            "electrode": "bending",
            "release_V": _described(3.1, 6.6, 9.4),
            "stuck": _probability(stuck),
            "causes": [{"cause": cause, "share_of_variance": share} for cause, share in causes.items()],
            "sensitivity": [
                {"name": name, "share_of_variance": share, "interval_shrinks_by": share / 2} for name, share in rows
            ],
        },
        **more,
    }


def _results(pad, coupled=False):
    return SimpleNamespace(has=lambda *names: pad is not None, json=lambda name: pad, coupled=coupled)


def test_verdict_says_outcome_cause_and_next_step():
    said = verdict(_results(_pad()), SOUND)
    assert said == (
        "The switch lets go at 6.60 V (5 to 95 %: 3.10 to 9.40 V); 50% of the spread comes from bow; next, measure the "
        "bow of the electrode at rest: known exactly, it shrinks the interval by 25%."
    )


@pytest.mark.parametrize(
    ("stuck", "words"),
    [(1.0, "The switch sticks;"), (0.4, "it sticks with a probability of 40%"), (0.0, "The switch lets go at")],
)
def test_verdict_says_when_it_is_not_decided(stuck, words):
    assert words in verdict(_results(_pad(stuck)), SOUND)


def test_a_coupled_switch_that_sticks_does_so_by_an_upper_bound():
    assert "measure a pull-off force next" in verdict(_results(_pad(1.0), coupled=True), SOUND)
    assert "upper bound" in release_cards(_results(_pad(0.3), coupled=True))[1]["detail"]
    assert "upper bound" not in release_cards(_results(_pad(0.3)))[1]["detail"]


def test_few_cells_are_named_before_any_measurement():
    said = verdict(_results(_pad(cells=0.7)), SOUND)
    assert "70% of the spread is the finite number of cells; compute more cells next (pad.cells)" in said


def test_a_failed_gate_comes_before_any_advice_and_an_unused_one_does_not():
    assert "mend what failed: law" in verdict(_results(_pad()), [Gate("law", False), *SOUND])
    assert "mend" not in verdict(_results(_pad()), SOUND)


def test_without_a_pad_there_is_no_verdict():
    assert verdict(_results(None), SOUND) == ""
    assert release_cards(_results(None)) == []
    assert release_causes(_results(None)) == []


def test_a_pad_that_was_pressed_too_hard_gives_no_number():
    pad = {"mean": None, "gate": {"passed": False, "reasons": ["too hard"]}}
    gates = [Gate("pad", False, ("too hard",))]
    assert verdict(_results(pad), gates).startswith("The release voltage is not known; before anything else, mend")
    assert release_cards(_results(pad)) == []


def test_cards_say_what_the_interval_holds():
    release, sticking = release_cards(_results(_pad()))
    assert release["value"] == "6.60 V"
    assert "3.10 to 9.40 V" in release["detail"]
    assert "holds inputs, D₀, bow and tilt, the finite number of cells" in release["detail"]
    assert sticking["value"] == "2%"
    assert "from 96 switches" in sticking["detail"]


def test_central_pad_alone_says_that_its_interval_is_of_the_cells():
    estimate = {"release_V": _described(0.0, 0.0, 1.2), "stuck": _probability(0.9)}
    pad = {"mean": {}, "cells_computed": 16, "estimate": estimate, "beam": {"stuck": False, "release_V": 6.66}}
    said = verdict(_results(pad), SOUND)
    assert said.startswith("At central inputs, its electrode flat on the pad: whether the switch lets go is open: it")
    assert "probability of 90%" in said
    assert "where the electrode bends, it lets go at 6.66 V; compute more cells next" in said
    release, _ = release_cards(_results(pad))
    assert release["value"] == "sticks"
    assert "holds the 16 computed cells alone" in release["detail"]


def test_a_switch_that_always_sticks_is_not_said_to_depend_on_an_input():
    pad = _pad(1.0)
    answer = pad["answer"]
    answer["causes"] = [{**row, "share_of_variance": 0.0} for row in answer["causes"]]
    answer["release_V"] = _described(0.0, 0.0, 0.0)
    answer["design"] = {"points": 64}
    said = verdict(_results(pad), SOUND)
    assert said.startswith("The switch sticks; it does so in all 64 computed combinations of inputs, D₀, bow and tilt")
    assert "stiffer" in said
    assert release_cards(_results(pad))[0]["detail"].endswith("sticks; nothing uncertain changes that")
