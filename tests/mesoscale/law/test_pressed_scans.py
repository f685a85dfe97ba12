"""Measured scans closed and opened, with the law fitted."""

import math

import numpy as np
import pytest

from mesoscale.inputs.contact import ContactInputs
from mesoscale.law.pressed_scans import press_scan
from mesoscale.settings import ContactSettings, LawSettings, TopographySettings
from mesoscale.topography.description.parameters import MAX_MISFIT
from mesoscale.topography.measurements.cleaning import Scan
from mesoscale.topography.pressing import SURFACES
from mesoscale.topography.roughness_spectrum import RoughSpectrum
from mesoscale.topography.synthesis import synthesize

SIDE, PIXELS = 500.0, 128
INPUTS = ContactInputs(hamaker=0.05, e_star=91.0, h_macro=1.95, h_prime=8.375, q0=0.1, hurst=0.75, rms=9.0)
CONTACT = ContactSettings(pixels=64)


def press(fitted, misfit):
    scan = Scan(-synthesize(PIXELS, SIDE, 0.1, 0.75, 3.0, 11), (SIDE, SIDE), "a")
    return list(press_scan(scan, fitted, misfit, INPUTS, TopographySettings(), CONTACT, LawSettings()))


def test_every_surface_is_pressed_at_its_own_height_and_gives_two_rows():
    pressed = press(RoughSpectrum.from_rms(3.0, 0.1, 2.5, np.pi * PIXELS / SIDE), misfit=0.0)
    assert [item.surface for item in pressed] == list(SURFACES)
    for item in pressed:
        # the scan's RMS height (3 nm before levelling), not that of the inputs (9 nm)
        assert item.cycle.inputs.rms == pytest.approx(3.0, rel=0.1)
        assert item.description["cell_area_nm2"] == pytest.approx(SIDE**2)
        assert item.max_force_nN == pytest.approx(CONTACT.max_force_nN / 4)  # a quarter of the area
        assert item.cycle.closing.repulsive_nN[-1] == pytest.approx(item.max_force_nN, rel=0.01)
        closing, opening = item.rows()
        assert (closing["branch"], opening["branch"]) == ("closing", "opening")
        assert closing["d_c_nm"] == pytest.approx(item.cycle.first_contact_nm)
        assert opening["d_c_nm"] < closing["d_c_nm"]  # plastic flow lowers the surface


def test_where_the_scans_share_no_spectrum_each_uses_its_own():
    wrong = RoughSpectrum(1.0, 0.01, 2.0, math.inf)
    shared, own = (press(wrong, misfit)[-1].cycle for misfit in (MAX_MISFIT, 1.01 * MAX_MISFIT))
    measured = press(wrong, 0.0)[0].cycle
    # a single long wave of the wrong spectrum closes unlike the scan; the scan's own spectrum closes like it
    ratios = [cycle.closing.separation_nm[-1] / measured.closing.separation_nm[-1] for cycle in (shared, own)]
    assert abs(ratios[1] - 1) < abs(ratios[0] - 1)
    assert ratios[1] == pytest.approx(1, rel=0.2)  # one realisation each
