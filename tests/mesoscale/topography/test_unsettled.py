"""Fits that end before they settle say so."""

import numpy as np
import pytest
import scipy.optimize

from mesoscale.errors import InputError
from mesoscale.settings import TopographySettings
from mesoscale.topography import profile_conversion
from mesoscale.topography.description import line_fits, trusted_range
from mesoscale.topography.description.choice import description_doubts
from mesoscale.topography.description.parameters import analyse
from mesoscale.topography.description.trusted_range import TrustedSpectrum, with_ends
from mesoscale.topography.measurements.profiles import Profile
from mesoscale.topography.profile_conversion import isotropic_spectrum
from mesoscale.topography.roughness_spectrum import RoughSpectrum
from mesoscale.topography.spectrum import Spectrum
from mesoscale.topography.synthetic_scans import surface_patch

TRUTH = RoughSpectrum.from_rms(6.0, 0.025, 2.84, 3.2)


def spectra(tip_radius_nm=0.0, seed=1):
    """Scans of a known spectrum, with the chance of so many modes a shell."""
    rng = np.random.default_rng(seed)
    items = []
    for number, length in enumerate((2000.0, 1000.0)):
        spacing = 2 * np.pi / length
        q = spacing * np.arange(1, 257)
        modes = 1.5 * np.arange(1, 257)
        psd = TRUTH.psd(q) * rng.gamma(modes) / modes
        spectrum = Spectrum(q, psd, modes, spacing, 256 * spacing)
        low, high = 2.5 * spacing, 0.7 * 256 * spacing
        items.append(
            TrustedSpectrum(
                f"scan{number}", spectrum, low, high, "pixels", tip_radius_nm, 6.0, high
            )
        )
    return items


def test_a_search_for_the_likelihood_that_is_cut_short_is_doubted(monkeypatch):
    """Three steps of the simplex do not reach its tolerance; a whole search does."""
    settings = TopographySettings()
    assert "fit_unsettled" not in {doubt.code for doubt in analyse(spectra(), settings).doubts}
    search = scipy.optimize.minimize

    def cut_short(function, start, **options):
        options["options"] = {**options.get("options", {}), "maxiter": 3}
        return search(function, start, **options)

    monkeypatch.setattr(scipy.optimize, "minimize", cut_short)
    assert "fit_unsettled" in {doubt.code for doubt in analyse(spectra(), settings).doubts}


def test_a_knee_that_swings_is_doubted(monkeypatch):
    settings = TopographySettings()

    def codes():
        topography = analyse(spectra(), settings)
        doubts = description_doubts(topography, "power_law", None, {}, (), 500.0)
        assert topography.line_fit is not None
        return topography.line_fit.settled, {doubt.code for doubt in doubts}

    settled, sound = codes()
    assert settled
    assert "knee_unsettled" not in sound
    monkeypatch.setattr(line_fits, "MOST_ROUNDS", 1)
    settled, doubted = codes()
    assert not settled
    assert "knee_unsettled" in doubted


def test_a_tip_whose_correction_goes_on_is_refused(monkeypatch):
    """Where roughness is half as curved as the tip, the second round changes ln C by a tenth."""
    blunt = spectra(tip_radius_nm=5.0)[1]
    with_ends(blunt)
    monkeypatch.setattr(trusted_range, "MOST_ROUNDS", 2)
    with pytest.raises(InputError, match="scan1: the correction of a tip of 5 nm does not settle"):
        with_ends(blunt)


def test_a_profile_whose_spectrum_is_not_found_is_refused(monkeypatch):
    points, length = 2048, 4000.0
    heights = surface_patch(TRUTH, points, length, np.random.default_rng(3))[:, 0]
    profile = Profile(heights, length, "line")
    low, high = 5 * np.pi / length, 0.5 * np.pi * points / length
    isotropic_spectrum(profile, low, high)
    monkeypatch.setattr(profile_conversion, "MOST_STEPS", 1)
    with pytest.raises(InputError, match=r"line: .* does not settle in 1 steps"):
        isotropic_spectrum(profile, low, high)
