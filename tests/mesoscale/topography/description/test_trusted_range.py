"""What the instrument leaves undisturbed: the end of the trusted range and its cause."""

import numpy as np
import pytest

from mesoscale.topography.description.trusted_range import trusted_range
from mesoscale.topography.roughness_spectrum import RoughSpectrum
from mesoscale.topography.spectrum import Spectrum

SPACING, NYQUIST = 2 * np.pi / 750, np.pi * 1024 / 1000


def trusted(rms=3.0, noise=0.0, tip=0.0, slope=2.5):
    """Trusted range of the exact spectrum of a surface plus white noise (nm^4)."""
    q = SPACING * np.arange(1, int(NYQUIST / SPACING))
    psd = RoughSpectrum.from_rms(rms, 0.03, slope, 10.0).psd(q) + noise
    return trusted_range(
        "a", Spectrum(q, psd, 5 * np.arange(1.0, len(q) + 1), SPACING, NYQUIST), tip
    )


def test_pixels_end_the_range_of_a_perfect_scan():
    found = trusted(slope=14.0)  # far above what is left at the Nyquist wave vector
    assert (found.limit, found.high) == ("pixels", pytest.approx(0.7 * NYQUIST))
    assert found.low == pytest.approx(2.5 * SPACING)


def test_noise_ends_it_where_the_surface_sinks_towards_its_floor():
    quiet, loud = trusted(noise=1e-3, slope=4.0), trusted(noise=1e-1, slope=4.0)
    assert quiet.limit == loud.limit == "noise"
    surface = RoughSpectrum.from_rms(3.0, 0.03, 4.0, 10.0)
    for found, noise in ((quiet, 1e-3), (loud, 1e-1)):
        # 20 times the floor in all
        assert surface.psd(np.array(found.high)) == pytest.approx(19 * noise, rel=0.3)


def test_a_blunt_tip_ends_it_where_an_octave_is_curved_like_the_tip():
    sharp, blunt = trusted(tip=2.0, slope=3.0), trusted(tip=10.0, slope=3.0)
    assert sharp.limit == blunt.limit == "tip"
    surface = RoughSpectrum.from_rms(3.0, 0.03, 3.0, 10.0)
    for found, radius in ((sharp, 2.0), (blunt, 10.0)):
        curvature = np.sqrt(2 * np.pi * found.high**6 * surface.psd(np.array(found.high)))
        assert radius * curvature == pytest.approx(0.5, rel=0.05)
    # R q^(3 - slope / 2) is the same at both ends
    assert sharp.high / blunt.high == pytest.approx(5 ** (1 / 1.5), rel=0.05)
