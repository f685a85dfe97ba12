"""The spectrum along a line and that of the isotropic surface under it."""

import numpy as np
import pytest
from scipy.special import gamma

from mesoscale.settings import TopographySettings
from mesoscale.topography.description.one_spectrum import merge
from mesoscale.topography.description.parameters import analyse
from mesoscale.topography.measurements.loading import Measurement
from mesoscale.topography.measurements.profiles import Profile
from mesoscale.topography.profile_conversion import (
    binned_line,
    isotropic_spectrum,
    line_spectrum,
    projected,
    spread,
)
from mesoscale.topography.records import record, trusted_record
from mesoscale.topography.roughness_spectrum import RoughSpectrum
from mesoscale.topography.synthetic_scans import surface_patch

LENGTH, POINTS = 4000.0, 2048


@pytest.mark.parametrize("slope", [2.4, 3.0, 4.5])
def test_projection_of_a_power_law_is_the_known_one(slope):
    """The integral of (k^2 + p^2)^(-s/2) over p is k^(1-s) sqrt(pi) Gamma((s-1)/2) / Gamma(s/2)."""
    q, k = np.geomspace(1e-2, 1e5, 4000), np.array([0.1, 1.0])
    exact = k ** (1 - slope) * np.sqrt(np.pi) * gamma((slope - 1) / 2) / gamma(slope / 2)
    # what is missing beyond the last point falls as its wave vector to the power of 1 - slope
    assert projected(q, q**-slope, k) == pytest.approx(exact, rel=1e-5)


def test_the_spectrum_along_a_line_holds_the_mean_square_height():
    heights = np.random.default_rng(0).standard_normal(4096)
    k, c1 = line_spectrum(Profile(heights, 4096.0, "noise"))
    assert 2 * np.sum(c1) * (k[1] - k[0]) == pytest.approx(heights.var(), rel=0.05)


def test_tapers_leave_the_plateau_and_spread_the_knee_as_stated():
    """Mean of 2048 lines, three waves below the knee: within 4 standard errors of a bin, and 1 %
    over the bins.
    """
    truth = RoughSpectrum.from_rms(6.0, 0.012, 2.84, 3.2)
    surface = surface_patch(truth, POINTS, LENGTH, np.random.default_rng(5))
    k, first = line_spectrum(Profile(surface[:, 0], LENGTH, "line"))
    c1 = np.mean(
        [first, *(line_spectrum(Profile(line, LENGTH, "line"))[1] for line in surface[:, 1:].T)],
        axis=0,
    )
    found = binned_line(k, c1, 2.5 * k[0], 0.2)
    q = np.geomspace(1e-4, 3.2, 4000)
    expected = np.mean(
        [projected(q, truth.psd(q), part) for part in spread(found.q, found.spacing)], axis=0
    )
    # neighbouring lines are alike within about a third of a wave of the knee
    lines = LENGTH * truth.q0 / 2
    assert (np.abs(found.psd / expected - 1) < 4 / np.sqrt(found.modes * lines)).all()
    assert np.mean(found.psd / expected) == pytest.approx(1, abs=0.01)


@pytest.mark.parametrize("slope", [2.5, 2.84, 3.6])
def test_lines_across_an_isotropic_surface_give_back_its_spectrum(slope):
    """Slope within 0.1, RMS within 10 % from profiles alone, and errors as stated."""
    truth = RoughSpectrum.from_rms(6.0, 0.025, slope, 3.2)
    logs, rms, away = [], [], []
    for seed in range(3):
        surface = surface_patch(truth, POINTS, LENGTH, np.random.default_rng(seed))
        for line in surface[:, ::256].T:
            result = isotropic_spectrum(
                Profile(line, LENGTH, "line"), 5 * np.pi / LENGTH, 0.5 * np.pi * POINTS / LENGTH
            )
            logs.append(np.log(result.psd))
            inside = np.trapezoid(2 * np.pi * result.q * result.psd, result.q)
            rms.append(np.sqrt(inside + np.pi * result.q[0] ** 2 * result.psd[0]))
            away.append((np.log(result.psd) - np.log(truth.psd(result.q))) * np.sqrt(result.modes))
    falling = (result.q > 0.06) & (result.q < 0.5)
    mean = np.mean(logs, axis=0)
    assert -np.polyfit(np.log(result.q[falling]), mean[falling], 1)[0] == pytest.approx(
        slope, abs=0.1
    )
    assert np.mean(rms) == pytest.approx(6.0, rel=0.1)
    assert np.mean(np.abs(away) < 1.645) > 0.85  # stated 90 % bands


def test_profiles_alone_recover_the_surface():
    """Eight lines of two lengths through the whole analysis."""
    truth = RoughSpectrum.from_rms(6.0, 0.025, 2.84, 3.2)
    spectra, settings = [], TopographySettings(scans=("a",), tip_radius_nm=0)
    for seed, (points, length) in enumerate([(2048, 8000.0), (2048, 2000.0)]):
        surface = surface_patch(truth, points, length, np.random.default_rng(seed))
        for number, line in enumerate(surface[:, :: points // 4].T):
            measured = Measurement(Profile(line, length, f"{seed}{number}"), 0.0, True)
            spectra.append(trusted_record(measured.data.name, *record(measured, settings)))
    result = analyse(spectra, settings)
    assert result.estimates["slope"].value == pytest.approx(2.84, abs=0.1)
    assert result.estimates["rms"].value == pytest.approx(6.0, rel=0.1)
    one = merge(spectra)
    assert np.sqrt(one.moment(0)) == pytest.approx(6.0, rel=0.1)
