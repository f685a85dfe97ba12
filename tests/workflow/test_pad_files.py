"""pad/model.h5: what is written is what is read."""

import numpy as np

from mesoscale.device.points import Pad, Solved
from mesoscale.pad.memory import Flats
from mesoscale.settings import ContactSettings, DeviceSettings
from tests.mesoscale.device.test_release import MIDDLE, SEPARATION, TABLE, cells_of
from workflow.run.pads import ScenePoints, load_model, write_solved


def test_a_model_comes_back_from_its_file_and_from_its_parts(tmp_path):
    """With a point that could not be pressed, and one of whose halves one carries no switch."""
    points = ScenePoints(TABLE, ContactSettings(mechanics="asperity"), DeviceSettings(), 2)
    pad = Pad(cells_of(MIDDLE.pressed(np.full(SEPARATION.size, 0.05), SEPARATION), 0.1), Flats(0.2, 0.165))
    states = {"pull_in_V": 70.0, "release_V": 6.0, "capacitance_fF": 8e3, "deepened": 0.0}
    solved = {
        0: Solved(points.by_number[0], pad, states, (5.9, 6.1)),
        1: Solved(points.by_number[1], None, {}, (np.nan, np.nan), "the cells never reach the pressure"),
        2: Solved(points.by_number[2], pad, states | {"release_V": 0.0}, (np.nan, 0.0)),
    }
    whole, parts = tmp_path / "model.h5", [tmp_path / "a.h5", tmp_path / "b.h5"]
    write_solved(str(whole), solved, {}, points.design)
    write_solved(str(parts[0]), {0: solved[0], 2: solved[2]}, {})
    write_solved(str(parts[1]), {1: solved[1]}, {})
    for model in (load_model([str(whole)], points), load_model([str(part) for part in parts], points)):
        assert model.refused == ["the cells never reach the pressure"]
        assert model.states("release_V").tolist() == [0.0]
        assert model.central.halves_V == (5.9, 6.1)
        assert np.isnan(model.points[1].error_V)
        assert model.points[1].undecided
        assert model.points[0].pad is None
        assert model.central.pad is not None
        assert model.central.pad.flats == pad.flats
        for ours, theirs in ((model.central.pad.cells, pad.cells),):
            np.testing.assert_array_equal(ours.opening, theirs.opening)
            np.testing.assert_array_equal(ours.weight, theirs.weight)
            np.testing.assert_array_equal(ours.grid.depths, theirs.grid.depths)
