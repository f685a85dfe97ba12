"""Beams that touch before they would snap, that collapse, and that have buckled away."""

import numpy as np
import pytest

from evidence.switch.touch import DEVICES, Differences, pulling_pad
from mesoscale.errors import InputError
from mesoscale.pad.curves import attracting
from mesoscale.pad.local import LocalPad
from mesoscale.studies.answer_stability import made_up_pad, published_beam, solved_beam
from mesoscale.switch import switch_of
from mesoscale.switch.beam import beam_of
from mesoscale.switch.beam_motion import MovingBeam

PAD = pulling_pad()
DIMPLE = {"electrode": (0.2, 0.8), "contact": (0.4, 0.6), "dimple_nm": 3200.0}


@pytest.mark.parametrize(
    "case",
    ["default", "dimple 2800", "dimple 3400", "cantilever on a dimple", "buckled down on a dimple"],
)
def test_touch_and_snap_are_those_of_finite_differences(case):
    settings = published_beam(**DEVICES[case])
    pull_in = MovingBeam(beam_of(settings, 64), settings, LocalPad(PAD)).come_down()
    voltage, touches = Differences(settings, PAD, 200).pull_in()
    assert pull_in.voltage == pytest.approx(voltage, rel=5e-3)
    assert pull_in.touches == touches


def test_a_hold_above_touch_presses_and_one_below_never_closes():
    held = solved_beam(published_beam(**DIMPLE, hold_voltage_V=60.0), made_up_pad())
    assert held.touches
    assert held.pull_in_V < 60.0
    assert held.landed_share > 0.1
    for hold_V, words in ((40.0, "which touches at 44"), (None, "raise hold_voltage_V above that")):
        with pytest.raises(InputError, match=words):
            solved_beam(published_beam(**DIMPLE, hold_voltage_V=hold_V), made_up_pad())


def test_only_its_pad_tells_whether_a_hold_closes_a_beam_that_touches_first():
    """A pad is touched earlier than the bare dielectric that a plan knows."""
    bare = switch_of(published_beam(**DIMPLE))
    between = published_beam(**DIMPLE, hold_voltage_V=0.98 * bare.pull_in_V)
    assert switch_of(between).never_closes == ""
    assert solved_beam(between, made_up_pad()).pull_in_V < between.hold_voltage_V
    assert "raise hold_voltage_V" in bare.never_closes


def test_a_beam_that_attraction_alone_pulls_down_has_collapsed():
    soft = published_beam(gap_um=0.12, thickness_um=0.2)
    with pytest.raises(InputError, match=r"without any voltage \(collapse\)") as caught:
        solved_beam(soft, attracting(PAD, 10.0))
    assert "\n" not in str(caught.value)
    assert solved_beam(soft, attracting(PAD, 0.0)).pull_in_V > 0.005


def test_buckled_beams_pull_in_without_jumps():
    """One of these came out at 796 V with 128 elements, one at 7,954 V."""
    stresses = np.array([-153.5, -153.0, -152.5, -102.5, -102.0, -101.5])
    volts = []
    for stress in stresses.tolist():
        settings = published_beam(residual_stress_MPa=stress)
        volts.append(MovingBeam(beam_of(settings), settings).come_down().voltage)
    for three in (volts[:3], volts[3:]):
        assert three[1] == pytest.approx(0.5 * (three[0] + three[2]), rel=1e-4)
