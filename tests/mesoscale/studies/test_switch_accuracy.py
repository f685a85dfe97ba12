"""Accuracy tables of answer, circuit and failure, on pads of a closed form."""

import numpy as np
import pytest

from evidence.failure.rare_failures import PLATE, known_pad, population
from mesoscale.answer import switches
from mesoscale.circuit.numerics import CIRCUIT
from mesoscale.errors import InputError
from mesoscale.failure.population import FAILURE
from mesoscale.studies import answer_accuracy, circuit_accuracy, failure_accuracy
from mesoscale.studies.answer_stability import published_beam
from mesoscale.switch.beam import ELEMENTS
from mesoscale.switch.beam_kernels import OPENING_NM
from mesoscale.switch.beam_switch import RELEASE_TOLERANCE
from tests.mesoscale.answer.test_release import model_of, pad_of_two

STAGES = {"answer": answer_accuracy, "circuit": circuit_accuracy}


def pressed_as_known(monkeypatch):
    def press_pad(point, contact, cells, first_seed, **_):
        law = known_pad(point).curves
        return pad_of_two(law, 0.1 / np.sqrt(cells / 2))

    monkeypatch.setattr(switches, "press_pad", press_pad)


@pytest.fixture(scope="module")
def tables():
    with pytest.MonkeyPatch.context() as patched:
        pressed_as_known(patched)
        for module in STAGES.values():
            patched.setattr(module, "SWITCHES", 2)
        model = model_of(published_beam(), 2)
        return {stage: list(module.accuracy_points(model)) for stage, module in STAGES.items()}


def releases(rows, knob):
    return [row["error"] for row in rows if row["knob"] == knob and row["case"] == "release"]


@pytest.mark.parametrize("stage", STAGES)
def test_every_choice_has_errors_and_the_value_in_use(tables, stage):
    rows = tables[stage]
    in_use = {row["knob"]: row["value"] for row in rows if row["shipped"]}
    assert set(in_use) == {row["knob"] for row in rows}
    for row in rows:
        assert np.isfinite([row["error"], row["own_error"], row["cpu_s"]]).all()
        assert (row["release_V"] == row["error"]) == (row["case"] == "release")


def test_the_values_in_use_are_those_of_the_numerics(tables):
    in_use = {row["knob"]: row["value"] for row in tables["answer"] if row["shipped"]}
    assert in_use == {
        answer_accuracy.BY_ELEMENTS: ELEMENTS,
        answer_accuracy.STEPS: OPENING_NM,
        answer_accuracy.TOLERANCE: RELEASE_TOLERANCE,
    }
    (lumps,) = {
        row["value"]
        for row in tables["circuit"]
        if row["shipped"] and row["knob"] == circuit_accuracy.LUMPS
    }
    assert lumps in CIRCUIT.lump_counts


def test_errors_fall_towards_the_finest(tables):
    for stage, knob in (
        ("answer", answer_accuracy.BY_ELEMENTS),
        ("answer", answer_accuracy.TOLERANCE),
        ("circuit", circuit_accuracy.LUMPS),
        ("circuit", circuit_accuracy.STRAIGHT),
    ):
        coarsest, *_, finest = releases(tables[stage], knob)
        assert finest <= coarsest, knob
    # a release is no farther off than it is said to be
    _, usual, finer = releases(tables["answer"], answer_accuracy.TOLERANCE)
    assert usual < RELEASE_TOLERANCE * 100.0
    assert finer <= usual


def test_a_plate_on_a_spring_has_no_such_choices(monkeypatch):
    pressed_as_known(monkeypatch)
    model = model_of(PLATE, 2)
    for module in STAGES.values():
        assert list(module.accuracy_points(model)) == []


def test_a_failure_rate_tells_what_points_switches_and_runs_leave_open(monkeypatch):
    plates = population()
    monkeypatch.setattr(failure_accuracy, "just_allowed", lambda *_: 1.42)
    monkeypatch.setattr(failure_accuracy, "SEEDS", 2)
    monkeypatch.setattr(failure_accuracy, "PARTS", 2)
    rows = list(failure_accuracy.accuracy_points(plates, 0.01, lambda *_: None))
    assert {row["knob"] for row in rows} == {
        failure_accuracy.SAMPLED,
        failure_accuracy.LEARNED,
        failure_accuracy.RUNS,
    }
    assert all(row["unit"] == "% of the probability" and row["error"] > 0.0 for row in rows)
    runs = {row["value"]: row["error"] for row in rows if row["knob"] == failure_accuracy.RUNS}
    assert runs[FAILURE.runs] == pytest.approx(0.5 * runs[FAILURE.runs // 4], rel=1e-9)


def test_a_failure_rate_of_few_points_is_refused_in_one_line():
    with pytest.raises(
        InputError, match=r"pad.points: \d+ of 8 switches .* at least 32; raise pad.points"
    ):
        list(failure_accuracy.accuracy_points(population(8), 0.01, lambda *_: None))
