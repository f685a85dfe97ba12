"""Recovery of known roughness, and "not identifiable" where there is nothing to recover."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.special import beta, betainc

from mesoscale.settings import TopographySettings
from mesoscale.studies.topography_stability import trusted_scan
from mesoscale.topography.description import likelihood
from mesoscale.topography.description.inputs import rms_scatter_row, rows_of
from mesoscale.topography.description.parameters import MAX_MISFIT, analyse
from mesoscale.topography.description.trusted_range import TrustedSpectrum, blur
from mesoscale.topography.measurements.cleaning import Scan
from mesoscale.topography.roughness_spectrum import (
    RoughSpectrum,
    hurst_from_slope,
    mean_square,
    slope_from_hurst,
)
from mesoscale.topography.spectrum import Spectrum
from mesoscale.topography.synthetic_scans import ScanSet, synthetic_scans

TRUTH = ScanSet(pixels=512, small_scans=4, large_scans=2, rms_variation=0.0)


@cache
def spectra(truth=TRUTH):
    settings = TopographySettings()
    scans = [item.scan for item in synthetic_scans(truth)]
    return [trusted_scan(scan, settings) for scan in scans]


def from_heights(heights, length=1000.0, settings=None):
    settings = settings or TopographySettings()
    scan = Scan(heights, (length, length), "scan")
    return analyse([trusted_scan(scan, settings)], settings)


def test_recovers_truth_through_tip_noise_tilt_and_drift():
    result = analyse(spectra(), TopographySettings())
    assert result.reasons == ()
    estimates = result.estimates
    assert estimates["q0"].value == pytest.approx(TRUTH.q0, rel=0.2)
    assert estimates["slope"].value == pytest.approx(TRUTH.slope, abs=0.15)
    assert estimates["rms"].value == pytest.approx(TRUTH.rms_nm, rel=0.05)


def test_the_line_fits_of_the_paper_recover_truth():
    fitted = analyse(spectra(), TopographySettings()).line_fit
    assert fitted.q0 == pytest.approx(TRUTH.q0, rel=0.2)
    assert fitted.slope == pytest.approx(TRUTH.slope, abs=0.15)
    rms = np.sqrt(mean_square(fitted.plateau, fitted.q0, fitted.slope, TRUTH.q1))
    assert rms == pytest.approx(TRUTH.rms_nm, rel=0.05)
    assert fitted.slope_low < fitted.slope < fitted.slope_high
    assert fitted.plateau_low < fitted.plateau < fitted.plateau_high


def test_places_of_different_roughness_widen_the_range_of_rms_only():
    varied = analyse(
        spectra(TRUTH.model_copy(update={"rms_variation": 0.5, "small_scans": 5})),
        TopographySettings(),
    )
    low, high = varied.estimates["rms"].scatter
    assert high / low > 1.5
    assert varied.likelihood is not None
    assert varied.likelihood.amplitude_sd > 0.3
    assert varied.estimates["slope"].value == pytest.approx(TRUTH.slope, abs=0.2)


def drawn_set(rng, sd):
    """Trusted spectra of eight small and three large scans, drawn from Whittle's distribution about
    eq. 9.

    The plateaus of the places are log-normal with standard deviation `sd` of ln RMS about 6 nm.
    """
    items = []
    for number, (length, end) in enumerate([(750.0, 0.4)] * 8 + [(7500.0, 0.08)] * 3):
        spacing = 2 * np.pi / length
        shell = np.arange(1, int(end / spacing))
        truth = RoughSpectrum.from_rms(6 * np.exp(sd * rng.standard_normal()), 0.025, 2.84, 3.2)
        modes = 5.0 * shell  # some pi k waves in shell k, and a little more than one section's area
        lift = np.where(spacing * shell > 0.025, np.exp(blur(2.84, shell)), 1.0)
        psd = truth.psd(spacing * shell) * lift * rng.gamma(modes) / modes
        spectrum = Spectrum(spacing * shell, psd, modes, spacing, 3.2)
        items.append(
            TrustedSpectrum(str(number), spectrum, 2.5 * spacing, end, "noise", 0.0, truth.rms_nm)
        )
    return items


def test_the_interval_of_the_typical_rms_covers_it_though_places_differ():
    """Eleven places say little about the typical one; the 90 % interval says how little."""
    rng = np.random.default_rng(5)
    estimates = [
        analyse(drawn_set(rng, 0.4), TopographySettings()).estimates["rms"] for _ in range(20)
    ]
    covered = [estimate.interval[0] <= 6.0 <= estimate.interval[1] for estimate in estimates]
    assert sum(covered) >= 15  # fewer of 20 happen once in 400 times at 90 %
    assert not all(high / low > 2 for low, high in (estimate.interval for estimate in estimates))
    errors = [np.log(estimate.value / 6.0) for estimate in estimates]
    # the scatter of the mean of eleven places
    assert np.std(errors) == pytest.approx(0.4 / np.sqrt(11), rel=0.4)


def test_the_range_of_the_scatter_between_places_covers_it():
    rng = np.random.default_rng(6)
    rows = [
        rms_scatter_row(analyse(drawn_set(rng, 0.4), TopographySettings()), None) for _ in range(20)
    ]
    # fewer of 20 happen once in 400 times at 90 %
    assert sum(row["a"] <= 0.4 <= row["b"] for row in rows) >= 15
    # eleven places: 2.16 by chi-squared of ten degrees of freedom, besides what is known of each
    # level
    assert max(row["b"] / row["a"] for row in rows) < 2.3


def test_one_scan_says_nothing_of_other_places():
    alone = analyse(drawn_set(np.random.default_rng(7), 0.4)[-1:], TopographySettings())
    assert rms_scatter_row(alone, None) == {"distribution": "fixed", "a": 0.0}


def test_two_places_leave_their_scatter_open_up_to_where_measurements_share_no_level():
    row = rms_scatter_row(
        analyse(drawn_set(np.random.default_rng(8), 0.4)[:2], TopographySettings()), None
    )
    assert 0 < row["a"] < row["b"] == 0.75


def test_instruments_without_a_common_level_are_no_power_law():
    """Half of the scans a hundred times as high in C: each has the shape of eq. 9, together they
    have no RMS height.
    """
    items = drawn_set(np.random.default_rng(5), 0.0)
    lifted = [
        replace(
            item, spectrum=replace(item.spectrum, psd=item.spectrum.psd * (100.0 if k % 2 else 1.0))
        )
        for k, item in enumerate(items)
    ]
    codes = [
        {doubt.code for doubt in analyse(set_, TopographySettings()).doubts}
        for set_ in (items, lifted)
    ]
    assert "levels_differ" not in codes[0]
    assert "levels_differ" in codes[1]


def test_heights_and_spectrum_scale_together():
    """Twice the heights: twice the RMS, the same q0 and slope (the tip scaled along)."""
    scans = [item.scan for item in synthetic_scans(TRUTH.model_copy(update={"tip_radius_nm": 0.0}))]
    settings = TopographySettings(tip_radius_nm=0.0)

    def result(factor):
        items = [Scan(scan.heights_nm * factor, scan.lengths_nm, scan.name) for scan in scans]
        return analyse([trusted_scan(item, settings) for item in items], settings)

    one, two = result(1.0), result(2.0)
    assert two.estimates["rms"].value == pytest.approx(2 * one.estimates["rms"].value, rel=1e-3)
    assert two.estimates["q0"].value == pytest.approx(one.estimates["q0"].value, rel=1e-3)
    assert two.estimates["slope"].value == pytest.approx(one.estimates["slope"].value, abs=2e-3)


def test_conventions_differ_by_one_half():
    assert hurst_from_slope(2.84, "profile") == pytest.approx(0.92)
    assert hurst_from_slope(2.84, "areal") == pytest.approx(0.42)
    assert slope_from_hurst(0.42, "areal") == pytest.approx(2.84)


def test_inputs_are_ranges_of_q0_hurst_and_rms():
    result = analyse(spectra(), TopographySettings())
    rows = rows_of(result, None, TopographySettings(), 100.0)
    assert set(rows) == {"q0", "hurst", "rms"}
    for row in rows.values():
        assert row["distribution"] == "uniform"
        assert 0 < row["a"] < row["b"]
    narrow = rows_of(result, None, TopographySettings(ranges="interval"), 100.0)
    assert narrow["rms"]["b"] - narrow["rms"]["a"] <= rows["rms"]["b"] - rows["rms"]["a"]


def test_white_noise_has_no_power_law():
    result = from_heights(np.random.default_rng(0).standard_normal((256, 256)))
    assert any("not identifiable" in reason for reason in result.reasons)


def test_constant_scan_is_not_identifiable():
    result = from_heights(np.zeros((128, 128)))
    assert any("not identifiable" in reason for reason in result.reasons)


def test_small_scans_alone_show_no_plateau():
    only_small = [item for item in spectra() if item.name.startswith("small")]
    result = analyse(only_small, TopographySettings())
    assert any("no plateau" in reason for reason in result.reasons)


@pytest.mark.parametrize(("q0", "slope"), [(0.015, 2.3), (0.03, 3.6)])
def test_the_spectrum_along_a_line_is_compared_with_the_one_of_eq_9_along_a_line(q0, slope):
    """The fit against the closed form of C1: 2 sqrt(q0^2 - k^2) and an incomplete beta function."""
    k = np.geomspace(1e-3, 0.5, 60)
    plateau = np.where(k < q0, 2 * np.sqrt(np.maximum(q0**2 - k**2, 0)), 0.0)
    half = (slope - 1) / 2
    fall = (
        q0**slope
        * k ** (1 - slope)
        * beta(half, 0.5)
        * betainc(half, 0.5, np.minimum(k / q0, 1.0) ** 2)
    )
    measured = Spectrum(k, 40.0 * (plateau + fall), np.full(60, 50.0), 1e-3, 1.0, sharp=True)
    item = TrustedSpectrum("line", measured, 1e-3, 0.5, "pixels", 0.0, line=measured)
    fitted = likelihood.fit([item])
    assert fitted.q0 == pytest.approx(q0, rel=0.01)
    assert fitted.slope == pytest.approx(slope, abs=0.01)
    assert fitted.plateau == pytest.approx(40.0, rel=0.01)
    assert fitted.misfit < 0.02


def test_chance_is_no_misfit():
    """Long waves of few lines scatter by as much as they are: no reason to doubt the power law."""
    rng = np.random.default_rng(2)
    truth = RoughSpectrum(40.0, 0.02, 3.0, 5.0)
    items = []
    for number in range(4):
        q = np.geomspace(1e-3, 0.5, 60)
        modes = 0.5 + (q / 0.02) ** 2
        psd = truth.psd(q) * rng.gamma(modes) / modes
        spectrum = Spectrum(q, psd, modes, 1e-9, 1.0, sharp=True)
        items.append(TrustedSpectrum(str(number), spectrum, 1e-3, 0.5, "pixels", 0.0))
    assert likelihood.fit(items).misfit < MAX_MISFIT


def test_the_ends_of_q0_are_where_the_deviance_has_risen_enough():
    """Brute force: the deviance on a grid of slopes, beside the search that the interval makes."""
    items = likelihood.skip_blurred_shells(spectra(), TRUTH.q0)
    fitted = likelihood.fit(items, knee=TRUTH.q0)
    low, high = likelihood.q0_interval(items, fitted, 1.645)
    data = likelihood._Data(items, fitted.q0)
    level = np.log(fitted.amplitudes)

    def lowest(q0):
        slopes = np.linspace(fitted.slope - 0.3, fitted.slope + 0.3, 241)
        return min(
            likelihood._deviance(data, np.log(q0), s, fitted.amplitude_sd, level)[0] for s in slopes
        )

    risen = 1.645**2 * max(fitted.dispersion, 1.0)
    best = min(lowest(fitted.q0 * np.exp(shift)) for shift in (-0.005, 0.0, 0.005))
    assert low < fitted.q0 < high
    for end in (low, high):
        assert lowest(end) - best == pytest.approx(risen, rel=0.1)


def test_without_a_plateau_q0_has_no_lower_end():
    """A pure power law: any smaller q0 does as well."""
    q = np.geomspace(0.05, 0.5, 200)
    rng = np.random.default_rng(3)
    spectrum = Spectrum(q, q**-3.0 * rng.gamma(20, 1 / 20, 200), np.full(200, 20.0), 0.001, 1.0)
    item = TrustedSpectrum("a", spectrum, 0.05, 0.5, "pixels", 0.0)
    fitted = likelihood.fit([item])
    low, high = likelihood.q0_interval([item], fitted, 1.645)
    assert low < 0.001
    assert high < 0.1
