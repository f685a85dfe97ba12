"""Normalisation, windows and slopes of the spectra against exact statements."""

import numpy as np
import pytest

from mesoscale.topography.roughness_spectrum import RoughSpectrum
from mesoscale.topography.spectrum import (
    flat_window,
    radial_spectrum,
    section_pixels,
)
from mesoscale.topography.synthetic_scans import surface_patch
from tests.mesoscale.topography.plain_spectrum import power_spectrum


def test_parseval_holds_to_round_off():
    heights = np.random.default_rng(0).standard_normal((48, 64))
    heights -= heights.mean()
    lengths = (300.0, 500.0)
    total = power_spectrum(heights, lengths).sum() * (2 * np.pi) ** 2 / (lengths[0] * lengths[1])
    assert total == pytest.approx(np.mean(heights**2), rel=1e-13)


def test_cosine_puts_its_power_into_its_own_shell():
    n, length = 128, 1000.0
    x = np.arange(n) * length / n
    heights = 3.0 * np.cos(2 * np.pi * 10 * x / length)[:, None] * np.ones(n)[None, :]
    spectrum = radial_spectrum(heights, (length, length), sections=1, fraction=1.0, flat=1.0)
    power = spectrum.psd * spectrum.modes * 2 * (2 * np.pi / length) ** 2
    assert np.argmax(power) == 9
    assert power[9] == pytest.approx(4.5, rel=1e-5)  # amplitude^2 / 2; single precision transform
    assert power.sum() == pytest.approx(4.5, rel=1e-4)


@pytest.mark.parametrize("flat", [0.99, 0.0])
def test_sections_and_window_keep_the_level_of_white_noise(flat):
    heights = np.random.default_rng(1).standard_normal((256, 256))
    spectrum = radial_spectrum(heights, (256.0, 256.0), 25, 0.75, flat)
    level = np.average(spectrum.psd, weights=spectrum.modes)
    # 1 nm^2 over the band (2 pi / 1 nm)^2
    assert level == pytest.approx(1 / (2 * np.pi) ** 2, rel=0.02)


def test_modes_tell_the_scatter_of_the_spectrum():
    """The variance of a shell's mean over many surfaces is C^2 over its number of modes."""
    rng = np.random.default_rng(2)
    shells = [
        radial_spectrum(rng.standard_normal((96, 96)), (96.0, 96.0), 9, 0.75, 0.0, skip_lines=True)
        for _ in range(150)
    ]
    # broad bands, because a window makes neighbouring shells move together
    modes = shells[0].modes
    bands = [(4, 12), (12, 24), (24, 36)]
    for low, high in bands:
        means = [np.average(s.psd[low:high], weights=modes[low:high]) for s in shells]
        measured = np.var(means) / np.mean(means) ** 2
        # chi-square of 150: 12 %
        assert measured == pytest.approx(1 / modes[low:high].sum(), rel=0.35)


def test_the_paper_cuts_768_of_1024():
    assert section_pixels(1024, 0.75) == 768
    assert flat_window(768, 0.99).mean() == pytest.approx(0.995, abs=0.002)


@pytest.mark.parametrize("slope", [2.5, 3.6])
def test_hann_window_returns_steep_slopes(slope):
    truth = RoughSpectrum.from_rms(5.0, 0.03, slope, 1.6)
    heights = surface_patch(truth, 512, 1000.0, np.random.default_rng(3))
    spectrum = radial_spectrum(heights, (1000.0, 1000.0), 25, 0.75, 0.0, skip_lines=True)
    used = (spectrum.q > 0.08) & (spectrum.q < 1.2)
    measured = -np.polyfit(
        np.log(spectrum.q[used]), np.log(spectrum.psd[used]), 1, w=np.sqrt(spectrum.modes[used])
    )[0]
    assert measured == pytest.approx(slope, abs=0.03)
