"""Measured scans as contacting surfaces, closed and opened, with the law fitted."""

import math

import numpy as np
import pytest

from mesoscale.contact import run_cycle
from mesoscale.errors import InputError
from mesoscale.inputs.contact import ContactInputs
from mesoscale.scan_checks.pressing import SURFACES, contacting_heights, periodic_part, press_scan, surfaces
from mesoscale.settings import ContactSettings, LawSettings, TopographySettings
from mesoscale.topography.description.parameters import MAX_MISFIT
from mesoscale.topography.measurements.cleaning import Scan
from mesoscale.topography.roughness_spectrum import RoughSpectrum
from mesoscale.topography.synthesis import synthesize

SIDE, PIXELS = 500.0, 128
INPUTS = ContactInputs(hamaker=0.05, e_star=91.0, h_macro=1.95, h_prime=8.375, q0=0.1, hurst=0.75, rms=9.0)
CONTACT = ContactSettings(pixels=64)


def test_a_periodic_surface_is_nearly_left_alone():
    """Its neighbours across the edges differ no more than any neighbours do."""
    smooth = synthesize(128, 500.0, 0.05, 1.0, 3.0, 1, "areal", q1=0.2)
    assert np.std(periodic_part(smooth) - smooth) < 0.05 * 3.0


def test_a_tilted_surface_loses_its_jump_and_keeps_its_waves():
    surface = synthesize(128, 500.0, 0.1, 1.0, 1.0, 1, "areal", q1=0.4)
    tilted = surface + np.linspace(-10, 10, 128)[:, None]
    periodic = periodic_part(tilted)
    assert np.abs(periodic[0] - periodic[-1]).mean() < 0.03 * np.abs(tilted[0] - tilted[-1]).mean()
    assert np.std(periodic - surface) < 0.05 * np.std(tilted - surface)  # a tilt is the smoothest jump


def test_the_largest_centred_square_is_turned_upside_down():
    heights = np.zeros((96, 64))
    heights[48, 32] = 5.0  # a peak in the middle
    surface, side = contacting_heights(Scan(heights, (960.0, 640.0), "a"))
    assert surface.shape == (64, 64)
    assert side == pytest.approx(640.0)
    assert np.unravel_index(np.argmin(surface), surface.shape) == (32, 32)
    with pytest.raises(InputError, match="square pixels"):
        contacting_heights(Scan(heights, (960.0, 700.0), "a"))


def test_a_gaussian_scan_closes_like_random_surfaces_of_its_statistics():
    """The scan is itself a random surface of eq. 9, so all three surfaces are of one kind and one pressure."""
    side, pixels = 500.0, 256
    scan = Scan(-synthesize(pixels, side, 0.1, 0.75, 3.0, 11), (side, side), "a")
    fitted = RoughSpectrum.from_rms(3.0, 0.1, 2.5, np.pi * pixels / side)
    inputs = ContactInputs(hamaker=0.0, e_star=91.0, h_macro=1.95, h_prime=8.375, q0=0.1, hurst=0.75, rms=3.0)
    made = list(surfaces(scan, fitted, TopographySettings(), ContactSettings(pixels=64)))
    assert [name for name, *_ in made] == list(SURFACES)
    touch = {}
    for name, heights, chosen, force in made:
        assert np.std(heights) == pytest.approx(np.std(made[0][1]), rel=1e-9)
        assert (chosen.pixels, chosen.length_nm) == (pixels, pytest.approx(side))
        assert force == pytest.approx(7000.0 / 4)  # the same pressure on a quarter of the area
        touch[name] = run_cycle(inputs, chosen, 1, force, heights, contact_at="lowest").closing.separation_nm[-1]
    assert touch["own spectrum"] == pytest.approx(touch["measured"], rel=0.15)  # one realisation each
    assert touch["eq. 9"] == pytest.approx(touch["own spectrum"], rel=0.15)


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
