"""The switch on pad curves whose answers are known."""

import numpy as np
import pytest

from mesoscale.errors import InputError
from mesoscale.pad.curves import Flats, PadCurves
from mesoscale.studies.answer_stability import published_beam
from mesoscale.switch.plate import PlateSwitch, closed_on_pad
from mesoscale.units import NM, VACUUM_PERMITTIVITY

PLATE = PlateSwitch(published_beam(spring_N_per_m=170.0)).plate
DEPTHS = (18.0, 20.0, 22.0, 24.0, 26.0, 28.0)


def made_up_pad(adhesion_kPa=0.0, hamaker=1e-6):
    """Closing 7 MPa at 24 nm, e-fold 2 nm; opening loses contact 6 nm above the depth, with a well
    1 nm wide there.
    """
    s = np.arange(17.0, 80.0, 0.02)
    closing = np.stack([7e-3 * np.exp((24.0 - s) / 2.0) * (s < 40.0), np.full(s.size, -1e-12)])
    opening = np.full((len(DEPTHS), 2, s.size), np.nan)
    for k, depth in enumerate(DEPTHS):
        above = s >= depth - 1e-9
        start = 7e-3 * np.exp((24.0 - depth) / 2.0)
        risen = s[above] - depth
        opening[k, 0, above] = start * np.maximum(1.0 - risen / 6.0, 0.0)
        opening[k, 1, above] = -1e-12 - adhesion_kPa * 1e-6 * np.exp(-((risen - 7.0) ** 2) / 0.1)
    return PadCurves(s, closing, np.array(DEPTHS), opening, Flats(hamaker, 0.0))


def test_pull_in_is_that_of_an_ideal_plate():
    assert closed_on_pad(PLATE, made_up_pad(), None).pull_in_V == pytest.approx(
        PLATE.pull_in_V, rel=1e-6
    )


def test_the_held_state_balances_the_forces():
    law = made_up_pad()
    found = closed_on_pad(PLATE, law, 60.0)
    electric = (
        VACUUM_PERMITTIVITY * 60.0**2 / (2 * ((found.hold_nm + PLATE.dielectric_nm) * NM) ** 2)
    )
    spring = PLATE.spring_N_per_m * (PLATE.gap_nm - found.hold_nm) * NM / PLATE.area_m2
    assert float(law.closing_GPa(found.hold_nm)) * 1e9 == pytest.approx(electric - spring, rel=1e-3)


def test_release_without_adhesion_is_at_the_last_touch():
    found = closed_on_pad(PLATE, made_up_pad(), 60.0)
    last = found.hold_nm + 6.0
    electric_gap = (last + PLATE.dielectric_nm) * NM
    spring = PLATE.spring_N_per_m * (PLATE.gap_nm - last) * NM
    wanted = np.sqrt(2 * spring * electric_gap**2 / (VACUUM_PERMITTIVITY * PLATE.area_m2))
    assert found.release_V == pytest.approx(wanted, rel=2e-3)
    assert found.release_V > 0


def test_adhesion_above_the_spring_sticks_and_below_lowers_the_release():
    free, pulled, stuck = (closed_on_pad(PLATE, made_up_pad(kPa), 60.0) for kPa in (0.0, 5.0, 12.0))
    assert free.release_V > pulled.release_V > 0
    assert stuck.release_V == 0


def test_nothing_beyond_the_computed_closing_is_used():
    with pytest.raises(InputError, match=r"the pad was computed for 18 \.\. 28 nm"):
        closed_on_pad(PLATE, made_up_pad(), 300.0)


def test_a_voltage_that_does_not_hold_is_refused():
    with pytest.raises(InputError, match="too little"):
        closed_on_pad(PLATE, made_up_pad(), 0.01)
