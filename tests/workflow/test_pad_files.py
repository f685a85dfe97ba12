"""pad/model.h5: what is written is what is read."""

from dataclasses import replace

import h5py
import numpy as np
import pytest

from mesoscale.answer.switches import Solved
from mesoscale.settings import ContactSettings
from mesoscale.studies.answer_stability import published_beam
from mesoscale.switch import States
from tests.mesoscale.answer.test_release import MIDDLE, SEPARATION, TABLE, pad_of_two
from workflow.run.pads import CURVES, STATES, ScenePoints, UnfitModel, load_model, write_solved


def test_a_model_comes_back_from_its_file_and_from_its_parts(tmp_path):
    """With a point that could not be pressed, and one of whose halves one carries no switch."""
    points = ScenePoints(TABLE, ContactSettings(mechanics="asperity"), published_beam(), 2)
    pad = pad_of_two(MIDDLE.pressed(np.full(SEPARATION.size, 0.05), SEPARATION), 0.1)
    states = States(pull_in_V=70.0, release_V=6.0, capacitance_fF=8e3)
    solved = {
        0: Solved(points.by_number[0], pad, states, (5.9, 6.1)),
        1: Solved(
            points.by_number[1], None, None, (np.nan, np.nan), "the cells never reach the pressure"
        ),
        2: Solved(points.by_number[2], pad, replace(states, release_V=0.0), (np.nan, 0.0)),
    }
    whole, parts = tmp_path / "model.h5", [tmp_path / "a.h5", tmp_path / "b.h5"]
    write_solved(str(whole), solved, {}, points.design)
    write_solved(str(parts[0]), {0: solved[0], 2: solved[2]}, {})
    write_solved(str(parts[1]), {1: solved[1]}, {})
    for model in (
        load_model([str(whole)], points),
        load_model([str(part) for part in parts], points),
    ):
        assert model.refused == ["the cells never reach the pressure"]
        assert model.states("release_V").tolist() == [0.0]
        assert model.central.halves_V == (5.9, 6.1)
        assert np.isnan(model.points[1].error_V)
        assert model.points[1].undecided
        assert model.points[0].pad is None
        assert model.central.pad is not None
        assert model.central.pad.flats == pad.flats
        np.testing.assert_array_equal(model.central.pad.opening, pad.opening)
        np.testing.assert_array_equal(model.central.pad.weight, pad.weight)
        np.testing.assert_array_equal(model.central.pad.grid.depths, pad.grid.depths)


def replaced(name, value):
    """A forger who writes another dataset in the place of one of the central point."""

    def forge(file):
        del file[f"point_0000/{name}"]
        if value is not None:
            file[f"point_0000/{name}"] = value

    return forge


def said(name, value, point="point_0000"):
    """A forger who writes another attribute."""

    def forge(file):
        if value is None:
            del file[point].attrs[name]
        else:
            file[point].attrs[name] = value

    return forge


FORGED = {
    **{f"no {name}": replaced(name, None) for name in CURVES},
    **{f"{name} of text": replaced(name, "x") for name in CURVES},
    **{f"{name} of another shape": replaced(name, np.ones((3, 1))) for name in CURVES},
    **{
        f"no {name}": said(name, None)
        for name in (*STATES, "halves_V", "refused", "hamaker", "offset_nm")
    },
    **{f"{name} of -5": said(name, -5.0) for name in (*STATES, "hamaker", "offset_nm")},
    **{f"{name} not a number": said(name, np.nan) for name in (*STATES, "hamaker", "offset_nm")},
    **{f"{name} of text": said(name, "5") for name in (*STATES, "halves_V")},
    "halves of three": said("halves_V", [1.0, 2.0, 3.0]),
    "a half of -5 V": said("halves_V", [-5.0, 5.0]),
    "a reason of numbers": said("refused", 1.0),
    "a reason beside states": said("refused", "it is none"),
    "separations that rise": replaced("separation_nm", SEPARATION),
    "separations that are infinite": replaced("separation_nm", np.full(SEPARATION.size, np.inf)),
    "depths beyond the separations": replaced("depth", [10**6]),
    "weights of 7": replaced("weight", [3.0, 4.0]),
    "no ratio": replaced("rms_ratio", [0.0, 1.0]),
    "cells pulled by repulsion": lambda file: file["point_0000/closing_GPa"].write_direct(
        -file["point_0000/closing_GPa"][()]
    ),
    "no central point": lambda file: file.__delitem__("point_0000"),
    "a point of another scene": lambda file: file.move("point_0001", "point_0099"),
    "a point without a number": lambda file: file.move("point_0001", "point_x"),
}


@pytest.mark.parametrize("name", FORGED)
def test_a_forged_model_is_refused_in_one_line(tmp_path, name):
    """None is believed, and none ends in an error of this program."""
    points = ScenePoints(TABLE, ContactSettings(mechanics="asperity"), published_beam(), 1)
    pad = pad_of_two(MIDDLE.pressed(np.full(SEPARATION.size, 0.05), SEPARATION), 0.1)
    states = States(pull_in_V=70.0, release_V=6.0, capacitance_fF=8e3)
    path = str(tmp_path / "model.h5")
    solved = {0: Solved(points.by_number[0], pad, states, (5.9, 6.1))}
    solved[1] = Solved(points.by_number[1], pad, states, (5.9, 6.1))
    write_solved(path, solved, {}, points.design)
    load_model([path], points)
    with h5py.File(path, "r+") as file:
        FORGED[name](file)
    with pytest.raises(UnfitModel, match="delete the file and run again") as caught:
        load_model([path], points)
    assert "\n" not in str(caught.value)
