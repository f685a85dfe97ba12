"""Surfaces with a wanted spectrum and wanted heights."""

import numpy as np
import pytest

from mesoscale.contact.surface import random_surface
from mesoscale.errors import InputError
from mesoscale.inputs.contact import ContactInputs
from mesoscale.settings import ContactSettings
from mesoscale.topography.description.heights import (
    common_heights,
    compare_heights,
    height_quantiles,
    not_gaussian,
)
from mesoscale.topography.height_synthesis import Z, synthesize_heights
from mesoscale.topography.roughness_spectrum import RoughSpectrum
from mesoscale.topography.spectrum import log_bins, radial_spectrum
from mesoscale.topography.synthesis import synthesize_spectrum

SPECTRUM = RoughSpectrum.from_rms(5.0, 0.05, 3.0, 10.0)
SKEWED = common_heights([np.exp(0.4 * Z)])  # log-normal: tall grains


def made(heights, seed=0, pixels=256):
    return synthesize_heights(pixels, 1000.0, SPECTRUM.psd, heights, 5.0, seed)


def test_normal_heights_give_the_gaussian_surface():
    plain = synthesize_spectrum(256, 1000.0, SPECTRUM.psd, 5.0, 3)
    assert made(common_heights([Z]), seed=3) == pytest.approx(plain, abs=1e-3 * 5.0)


def test_rms_is_exact_and_spectrum_and_heights_are_the_wanted_ones():
    surfaces = [made(SKEWED, seed) for seed in range(6)]
    for surface in surfaces:
        assert np.std(surface) == pytest.approx(5.0, rel=1e-12)
    # skewness of the log-normal distribution of shape s: (e^(s^2) + 2) sqrt(e^(s^2) - 1), 1.32 at
    # 0.4
    standard = np.array(surfaces) / 5.0
    assert np.mean(standard**3) == pytest.approx(1.32, abs=0.15)
    result = [
        log_bins(radial_spectrum(surface, (1000.0, 1000.0), 9, 0.75, 0.0), 5)
        for surface in surfaces
    ]
    ratio = np.mean([np.log(item.psd / SPECTRUM.psd(item.q)) for item in result], axis=0)
    inside = (result[0].q > 0.02) & (result[0].q < 0.5)
    assert np.abs(ratio[inside]).max() < 0.25


def test_the_summit_is_as_random_as_summits_are_and_grows_with_the_area():
    highest = [made(SKEWED, seed, 128).max() for seed in range(8)]
    assert np.std(highest) > 0.3
    larger = [
        synthesize_heights(256, 2000.0, SPECTRUM.psd, SKEWED, 5.0, seed).max() for seed in range(8)
    ]
    assert np.mean(larger) > np.mean(highest)


def test_measured_heights_come_back_from_their_own_surface():
    surface = made(SKEWED, 5)
    result = common_heights([height_quantiles(surface)])
    inside = np.abs(Z) < 2.5
    assert np.array(result)[inside] == pytest.approx(np.array(SKEWED)[inside], abs=0.25)
    assert np.all(np.diff(result) >= 0)


def test_only_heights_that_no_gaussian_surface_has_stand_out():
    gaussian = [synthesize_spectrum(256, 1000.0, SPECTRUM.psd, 5.0, seed) for seed in range(3)]
    grainy = [made(SKEWED, seed) for seed in range(3)]
    tests = [
        [compare_heights("a", surface, (1000.0, 1000.0)) for surface in set_]
        for set_ in (gaussian, grainy)
    ]
    assert not_gaussian(tests[0]) == ""
    assert "skewness" in not_gaussian(tests[1])
    assert not_gaussian([]) == ""


@pytest.mark.parametrize(
    "heights", [SKEWED[:-1], SKEWED[::-1], [0.0] * len(Z), [*SKEWED[:-1], float("nan")]]
)
def test_what_is_no_map_of_heights_is_refused(heights):
    with pytest.raises(InputError, match="heights: accepted are"):
        made(heights)


def test_contact_is_at_the_tall_grains():
    """The contact's surface is turned upside down: its minima are the summits."""
    inputs = ContactInputs(hamaker=0.2, e_star=91, h_macro=2, h_prime=8, q0=0.05, hurst=0.5, rms=5)
    settings = ContactSettings(mechanics="asperity", pixels=128, surface={"heights": SKEWED})
    heights = random_surface(inputs, settings, 1)
    assert np.mean((heights / heights.std()) ** 3) < -0.8
