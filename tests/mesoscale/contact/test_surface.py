"""Contacting surfaces beyond eq. 9: spectra by points, two rough surfaces, skewed heights."""

from itertools import pairwise

import numpy as np
import pytest
from pydantic import ValidationError

from mesoscale.contact import run_cycle
from mesoscale.contact.surface import random_surface
from mesoscale.errors import InputError
from mesoscale.inputs.contact import ContactInputs
from mesoscale.settings import ContactSettings
from mesoscale.topography.description.heights import common_heights
from mesoscale.topography.height_synthesis import Z
from mesoscale.topography.roughness_spectrum import RoughSpectrum, SpectrumTable, slope_from_hurst
from tests.mesoscale.topography.plain_spectrum import power_spectrum

INPUTS = ContactInputs(
    hamaker=0.215, e_star=91.0, h_macro=1.95, h_prime=8.375, q0=0.05, hurst=0.75, rms=4.0
)
LENGTH, PIXELS = 500.0, 256


def settings(**surface):
    return ContactSettings.model_validate(
        {"pixels": PIXELS, "length_nm": LENGTH, "surface": surface}
    )


def moments(heights):
    z = (heights - heights.mean()) / heights.std()
    return float(np.mean(z**3)), float(np.mean(z**4))


def bands(heights):
    """Mean C on bands of equal width in log q, and their wave vectors."""
    psd = power_spectrum(heights, (LENGTH, LENGTH))
    k = np.fft.fftfreq(PIXELS, LENGTH / PIXELS) * 2 * np.pi
    q = np.hypot(k[:, None], k[None, :])
    edges = np.geomspace(0.06, 1.5, 9)
    inside = [(q >= low) & (q < high) for low, high in pairwise(edges)]
    return np.array([q[i].mean() for i in inside]), np.array([psd[i].mean() for i in inside])


def test_points_of_eq_9_give_the_surface_of_eq_9():
    """The noise is the same, and a power law is straight between its points."""
    q = np.array([0.01, 0.05, 10.0])
    psd = RoughSpectrum.from_rms(1.0, 0.05, slope_from_hurst(0.75, "areal"), 20.0).psd(q)
    by_points = random_surface(INPUTS, settings(spectrum={"q": q.tolist(), "psd": psd.tolist()}), 3)
    np.testing.assert_allclose(by_points, random_surface(INPUTS, settings(), 3), atol=1e-9)


def test_a_table_outside_the_grid_is_refused():
    spectrum = {"q": [1e-5, 1e-4], "psd": [1.0, 1.0]}
    with pytest.raises(InputError, match="no power on a surface of 500 nm"):
        random_surface(INPUTS, settings(spectrum=spectrum), 3)


@pytest.mark.parametrize(
    ("q", "psd", "word"),
    [
        ([1, 2, 3], [1, 1], "one length"),
        ([2, 1], [1, 1], "rising"),
        ([0, 1], [1, 1], "greater than or equal to"),
    ],
)
def test_a_table_that_is_no_function_is_refused(q, psd, word):
    with pytest.raises(ValidationError, match=word):
        settings(spectrum={"q": q, "psd": psd})


def test_a_table_integrates_to_the_rms_it_is_scaled_to():
    rough = RoughSpectrum.from_rms(7.0, 0.03, 2.5, 2.0)
    q = np.geomspace(0.01, 2.0, 400)
    table = SpectrumTable(q, 3.0 * rough.psd(q)).scaled(7.0, 2.0)
    # 400 points: the knee is cut a little
    np.testing.assert_allclose(table.psd(q), rough.psd(q), rtol=1e-3)


def test_tall_peaks_touch_first():
    """Positive skewness is tall peaks: the flat meets them farther away."""
    few = [settings(heights=common_heights([side * np.exp(side * 0.3 * Z)])) for side in (1, -1)]
    peaks, plateaus = (
        run_cycle(INPUTS, s.model_copy(update={"model": "elastic"}), 2, 300.0) for s in few
    )
    assert peaks.first_contact_nm > 1.5 * plateaus.first_contact_nm
