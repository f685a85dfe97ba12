"""The reserve of a switch, and what frees one that sticks: against switches that are solved."""

import numpy as np
import pytest

from mesoscale.answer.reserve import _edge_between, bears_times, freed_by_device, reserve_of
from mesoscale.errors import InputError
from mesoscale.pad.curves import attracting
from mesoscale.studies.answer_stability import published_beam
from mesoscale.switch import release_or_nan_V, switch_of
from mesoscale.switch.plate import PlateStates
from tests.mesoscale.answer.test_release import MIDDLE, PLATE, SEPARATION

SOFT_BEAM = published_beam(thickness_um=2.5, hold_voltage_V=70.0)
SOFT_PLATE = PLATE.model_copy(update={"spring_N_per_m": 40.0, "hold_voltage_V": 60.0})
"""Held at a stated voltage: at its own pull-in a stiffer spring also presses harder."""


def pad_under(settings, times):
    pad = MIDDLE.pressed(2.0 * switch_of(settings).least_GPa(SEPARATION), SEPARATION)
    return attracting(pad, times)


@pytest.mark.parametrize("settings", [PLATE, published_beam()])
def test_the_switch_sticks_just_beyond_the_attraction_that_it_bears(settings):
    pad = pad_under(settings, 1.0)
    times = bears_times(settings, pad)
    assert release_or_nan_V(settings, attracting(pad, 1.03 * times)) == 0.0
    assert release_or_nan_V(settings, attracting(pad, times / 1.03)) > 0.0


def check_edge(settings, pad, row):
    """The value frees, and one a little nearer to the switch's own does not."""
    freed = settings.model_copy(update={row["key"]: row["frees"]})
    assert release_or_nan_V(freed, pad) > 0.0
    nearer = row["value"] + 0.95 * (row["frees"] - row["value"])
    assert release_or_nan_V(settings.model_copy(update={row["key"]: nearer}), pad) == 0.0


def test_what_frees_a_plate_frees_it_and_a_little_less_does_not():
    pad = pad_under(SOFT_PLATE, 1.0)
    pad = attracting(pad, 1.3 * bears_times(SOFT_PLATE, pad))
    reserve = reserve_of(SOFT_PLATE, pad, switch_of(SOFT_PLATE).states(pad))
    assert reserve["bears_times"] == pytest.approx(1.0 / 1.3, rel=0.05)
    freeing = [row for row in reserve["freed_by"] if row["frees"] is not None]
    assert "spring_N_per_m" in {row["key"] for row in freeing}
    for row in freeing:
        check_edge(SOFT_PLATE, pad, row)


def test_a_thicker_beam_is_freed():
    pad = attracting(pad_under(SOFT_BEAM, 1.0), 4.3)
    row = next(freed_by_device(SOFT_BEAM, pad, switch_of(SOFT_BEAM).states(pad).pull_in_V))
    assert row["key"] == "thickness_um"
    assert row["frees"] > row["value"]
    check_edge(SOFT_BEAM, pad, row)


def test_a_plate_is_freed_by_the_spring_that_balances_its_pad():
    """Its pull at rest of the spring is linear in the stiffness, so the edge is a minimum."""
    pad = pad_under(SOFT_PLATE, 1.0)
    states = switch_of(SOFT_PLATE).states(pad)
    scale = 1.3 * bears_times(SOFT_PLATE, pad)
    pad = attracting(pad, scale)
    row = next(freed_by_device(SOFT_PLATE, pad, states.pull_in_V))
    held = switch_of(SOFT_PLATE).states_on(pad)
    assert isinstance(held, PlateStates)
    rising = np.linspace(held.hold_nm, 100.0, 20_000)
    pull_N = -SOFT_PLATE.area_um2 * 1e-12 * 1e9 * pad.opening_GPa(rising, held.hold_nm)
    needed = (pull_N / ((1e3 * SOFT_PLATE.gap_um - rising) * 1e-9)).max()
    assert row["frees"] == pytest.approx(needed, rel=0.02)


def test_edges_end_where_the_switch_has_no_answer():
    def frees(value):
        if value > 3.0:
            raise InputError("it never closes")
        return value > 2.0

    assert _edge_between(frees, 1.0, 3.0) == pytest.approx(2.0, abs=0.03)
    assert _edge_between(frees, 1.0, 1.5) is None
    assert _edge_between(frees, 1.0, 4.0) is None


def test_a_switch_that_lets_go_names_no_cure():
    reserve = reserve_of(PLATE, pad := pad_under(PLATE, 0.5), switch_of(PLATE).states(pad))
    assert reserve["bears_times"] > 1.0
    assert reserve["freed_by"] == reserve["moved_by"] == []
