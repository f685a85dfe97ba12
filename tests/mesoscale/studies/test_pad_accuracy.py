"""The accuracy table of the pad: what it must hold, on pads of few small cells."""

import numpy as np
import pytest

from mesoscale.device.points import PadModel, central_point, plan_points, solve_point, solve_points
from mesoscale.inputs.distributions import Distribution, InputTable, UncertainInput
from mesoscale.settings import ContactSettings, DeviceSettings
from mesoscale.studies.pad_accuracy import Tried, accuracy_points

FIXED = {"e_star": 91.0, "h_macro": 1.95, "h_prime": 8.375, "q0": 0.025, "hurst": 0.75}
RANGES = {"hamaker": (0.2, 0.23), "rms": (7.5, 9.5)}
DISTRIBUTIONS = {name: Distribution("fixed", value) for name, value in FIXED.items()} | {
    name: Distribution("uniform", *ends) for name, ends in RANGES.items()
}
TABLE = InputTable(
    tuple(UncertainInput(name, "", distribution, "literature", "") for name, distribution in DISTRIBUTIONS.items()),
    np.eye(len(DISTRIBUTIONS)),
)
CONTACT = ContactSettings(mechanics="asperity", pixels=64)
DEVICE = DeviceSettings()


@pytest.fixture(scope="module")
def rows():
    """The table, whose cells, grids and beams are few here."""
    central = solve_point(central_point(TABLE, CONTACT, DEVICE), CONTACT, 8, 1000)
    design = plan_points(TABLE, CONTACT, DEVICE, 32)
    numbered = list(enumerate(design.points, 1))[:1]
    (one,) = solve_points(numbered, CONTACT, 2)
    model = PadModel(central, design, (one,) * 32)
    tried = Tried(cells=(2, 4), others=2, sides=(2,), elements=(16, 32, 64, 128))
    return list(accuracy_points(model, TABLE, CONTACT, 2, tried=tried))


def test_every_choice_has_errors_and_times(rows):
    knobs = {row["knob"] for row in rows}
    of_pad = {"cells", "steps of separation, nm", "depths", "sites a side", "points", "elements of the beam"}
    assert knobs == of_pad
    assert all(np.isfinite(row["cpu_s"]) and np.isfinite(row["error"]) for row in rows)


def test_errors_fall_towards_the_finest(rows):
    errors = [row["error"] for row in rows if row["knob"] == "elements of the beam"]
    # towards 256 elements by some power
    assert errors[-1] <= errors[0] + 1e-9
    assert errors[-1] < 0.2


def test_more_cells_take_more_time(rows):
    cells = [row for row in rows if row["knob"] == "cells"]
    assert [row["value"] for row in cells] == [2, 4]
    assert cells[0]["cpu_s"] < cells[1]["cpu_s"]
