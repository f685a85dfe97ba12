"""How many switches stick if the device were another: against each switch, solved by itself."""

from dataclasses import replace

import numpy as np
import pytest

from mesoscale.answer.sticking import sticking_by_key
from mesoscale.switch import release_or_nan_V
from tests.mesoscale.answer.test_release import CONTACT, PLATE, TABLE, known, model_of

__all__ = ["known"]  # a fixture: pads of a closed form

SOFT = PLATE.model_copy(update={"spring_N_per_m": 38.0, "hold_voltage_V": 60.0})


@pytest.fixture
def model(known):
    """Six switches, of which some stick."""
    return model_of(SOFT, 6)


def test_the_share_is_that_of_switches_solved_one_by_one(model):
    rows = sticking_by_key(model, TABLE, CONTACT, SOFT)
    now = np.mean([point.sticks for point in model.points])
    assert 0.1 < now < 0.9
    shares = [row["stuck"] for row in rows]
    assert shares == sorted(shares)
    stiffer = next(row for row in rows if row["key"] == "spring_N_per_m")
    assert (stiffer["value"], stiffer["other"]) == (38.0, pytest.approx(53.2))
    stuck = 0
    for point in model.points:
        device = point.point.device.model_copy(update={"spring_N_per_m": stiffer["other"]})
        stuck += not release_or_nan_V(device, point.pad.curves) > 0.0
    assert stiffer["stuck"] == stuck / len(model.points) < now


def test_where_few_stick_or_the_device_was_measured_there_is_no_cure(model):
    free = [point for point in model.points if not point.sticks]
    few = replace(model, points=tuple(free))
    assert sticking_by_key(few, TABLE, CONTACT, SOFT) == []
    measured = SOFT.model_copy(update={"measured": object()})
    assert sticking_by_key(model, TABLE, CONTACT, measured) == []
