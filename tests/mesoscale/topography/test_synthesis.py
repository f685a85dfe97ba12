from itertools import pairwise

import numpy as np
import pytest

from mesoscale.errors import InputError
from mesoscale.topography import synthesis
from mesoscale.topography.roughness_spectrum import slope_from_hurst
from mesoscale.topography.synthesis import synthesize
from tests.mesoscale.topography.plain_spectrum import power_spectrum


def test_every_realisation_has_the_wanted_rms_and_mean_zero():
    for seed, rms in ((0, 8.5), (1, 0.01), (2, 200.0)):
        heights = synthesize(128, 1000.0, 0.025, 0.75, rms, seed)
        assert np.sqrt(np.mean(heights**2)) == pytest.approx(rms, rel=1e-12)
        assert abs(heights.mean()) < 1e-13 * rms


def test_a_finer_grid_shows_the_same_surface():
    """The noise belongs to the waves, not to the pixels."""
    coarse = synthesize(100, 1000.0, 0.025, 0.75, 8.5, 7, q1=0.25)
    fine = synthesize(300, 1000.0, 0.025, 0.75, 8.5, 7, q1=0.25)
    np.testing.assert_allclose(fine[::3, ::3], coarse, atol=1e-11)


def test_the_same_seed_gives_the_same_noise_whatever_the_parameters():
    """Long waves are only rescaled, since the plateau of the spectrum is flat."""
    one = np.fft.rfft2(synthesize(128, 1000.0, 0.03, 0.5, 4.0, 3))[1:3, 1:3]
    other = np.fft.rfft2(synthesize(128, 1000.0, 0.03, 1.0, 9.0, 3))[1:3, 1:3]
    ratio = other / one
    np.testing.assert_allclose(ratio, ratio[0, 0], rtol=1e-9)
    assert not np.allclose(
        synthesize(64, 1e3, 0.03, 0.5, 1, 3), synthesize(64, 1e3, 0.03, 0.5, 1, 4)
    )


@pytest.mark.parametrize("pixels", [32, 33])
def test_every_wave_gets_its_own_noise(pixels):
    """With a white filter the power is that of all random numbers: none is skipped or used
    twice.
    """
    highest = (pixels - 1) // 2
    normals = np.random.default_rng(1).standard_normal(4 * highest * (highest + 1))
    spectrum = np.zeros((pixels, pixels // 2 + 1), complex)
    amplitude = np.ones(2 * highest**2 + 1)
    power = synthesis._fill_spectrum(spectrum, normals, amplitude, highest)
    assert power == pytest.approx(2 * np.sum(normals**2), rel=1e-12)
    heights = np.fft.irfft2(spectrum, s=(pixels, pixels)) * pixels
    assert np.sum(heights**2) == pytest.approx(power, rel=1e-12)


@pytest.mark.parametrize("convention", ["profile", "areal"])
def test_the_spectrum_is_flat_to_the_roll_off_and_falls_with_the_stated_slope(convention):
    pixels, length, q0, hurst = 256, 1000.0, 0.1, 0.75
    power = np.zeros((pixels, pixels))
    for seed in range(20):
        heights = synthesize(pixels, length, q0, hurst, 1.0, seed, convention)
        power += np.abs(np.fft.fft2(heights)) ** 2
    k = np.fft.fftfreq(pixels, 1 / pixels) * 2 * np.pi / length
    q = np.hypot(*np.meshgrid(k, k))
    bands = np.array([0.02, 0.04, 0.08, 0.11, 0.22, 0.44, 0.78])
    mean = np.array([power[(q >= a) & (q < b)].mean() for a, b in pairwise(bands)])
    centre = np.array([q[(q >= a) & (q < b)].mean() for a, b in pairwise(bands)])
    assert mean[0] == pytest.approx(mean[1], rel=0.15)
    slope = np.polyfit(np.log(centre[3:]), np.log(mean[3:]), 1)[0]
    # band means, 20 surfaces
    assert slope == pytest.approx(-slope_from_hurst(hurst, convention), abs=0.15)
    assert power[q > np.pi * pixels / length].max() < 1e-15 * power.max()


def test_a_spectrum_without_a_single_wave_is_refused():
    with pytest.raises(InputError, match=r"q1 = 0\.001"):
        synthesize(64, 1000.0, 0.025, 0.75, 8.5, 1, q1=0.001)


@pytest.mark.parametrize("convention", ["profile", "areal"])
@pytest.mark.parametrize("hurst", [0.5, 0.9])
def test_one_surface_returns_its_slope_within_two_hundredths(hurst, convention):
    pixels, length, q0 = 512, 1000.0, 0.025
    heights = synthesize(pixels, length, q0, hurst, 8.5, 1, convention)
    psd = power_spectrum(heights, (length, length))
    k = np.fft.fftfreq(pixels, length / pixels) * 2 * np.pi
    q = np.hypot(k[:, None], k[None, :])
    inside = (q > 2 * q0) & (q < np.pi * pixels / length)
    # the mean of ln C of single waves lies below ln of its mean by a constant, which leaves the
    # slope alone
    slope = np.polyfit(np.log(q[inside]), np.log(psd[inside]), 1)[0]
    assert slope == pytest.approx(-slope_from_hurst(hurst, convention), abs=0.02)
