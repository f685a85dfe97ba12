"""Release at a share of the held capacitance, beside the curve of capacitance against voltage."""

import numpy as np
import pytest

from mesoscale.answer.other_devices import by_capacitance
from mesoscale.errors import InputError
from mesoscale.pad.curves import Flats, PadCurves, on_deep_enough
from mesoscale.settings import DeviceSettings
from mesoscale.studies.answer_stability import made_up_pad, published_beam
from mesoscale.switch import switch_of
from mesoscale.switch.beam import COARSE_ELEMENTS, beam_of
from mesoscale.switch.beam_switch import BeamSwitch

PAD = made_up_pad(40.0)
BEAM = published_beam()


def released_V(settings):
    return switch_of(settings, coarse=True).states(PAD).release_V


def test_a_beam_has_lost_the_stated_share_of_its_capacitance():
    """The curve is solved voltage by voltage, without any search."""
    release_V = released_V(BEAM.model_copy(update={"release_at": 0.5}))
    beam = BeamSwitch(BEAM, beam_of(BEAM, COARSE_ELEMENTS))
    volts = np.array([0.0, 0.99, 1.01, 2.6]) * release_V
    (_, falling_fF), _ = on_deep_enough(PAD, lambda pad: beam.loop_fF(pad, volts))
    held_fF = beam.states(PAD).capacitance_fF
    assert falling_fF[1] < 0.5 * held_fF < falling_fF[2]
    assert release_V > 2.0 * released_V(BEAM)


def test_a_share_that_the_jump_passes_is_the_jump():
    jump_V = released_V(BEAM)
    assert released_V(BEAM.model_copy(update={"release_at": 0.05})) == pytest.approx(
        jump_V, rel=2e-3
    )


def test_a_plate_on_an_elastic_pad_has_lost_a_share_where_its_gap_says():
    """Over a pad of exponential pressure p, closing and opening alike, V^2 = 2 (k (g - s) / A + p)
    e^2 / eps0 with e = s + t / eps, and C falls as 1 / e.
    """
    plate = published_beam(
        spring_N_per_m=1e4, hold_voltage_V=600.0, dielectric_nm=20.0, permittivity=2.0
    )
    separation = np.linspace(1.0, 400.0, 1597)
    closing = np.array([20.0 * np.exp(-separation / 15.0), 0.0 * separation])
    depths = separation[[0, 800]]
    opening = np.where(separation < depths[:, None, None], np.nan, closing)
    pad = PadCurves(separation, closing, depths, opening, Flats(0.0, 0.2))
    held = switch_of(plate).states(pad)
    share = 0.8
    states = switch_of(plate.model_copy(update={"release_at": share})).states(pad)
    gap_nm = held.hold_nm + 10.0
    lost_nm = gap_nm / share - 10.0
    spring_Pa = 1e4 * (3490.0 - lost_nm) * 1e-9 / (plate.area_um2 * 1e-12)
    pressed_Pa = 20e9 * np.exp(-lost_nm / 15.0)
    squared = 2.0 * (spring_Pa + pressed_Pa) * ((lost_nm + 10.0) * 1e-9) ** 2 / 8.8541878e-12
    assert states.release_V == pytest.approx(np.sqrt(squared), rel=2e-3)
    assert states.release_V > 1.05 * held.release_V


def test_the_page_has_the_shares_of_the_central_switch():
    rows = {row["release_at"]: row["release_V"] for row in by_capacitance(BEAM, PAD)}
    assert rows[0.75] > rows[0.5] > rows[0.25] > rows["jump"] > 0.0


@pytest.mark.parametrize("stated", [0.0, 1.0, 1.5, "half"])
def test_what_is_no_share_is_refused(stated):
    with pytest.raises(InputError, match="release_at") as refused:
        DeviceSettings(release_at=stated)
    assert "\n" not in str(refused.value)
    assert "release_at" not in DeviceSettings().model_dump()
