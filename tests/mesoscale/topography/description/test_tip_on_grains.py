"""What a tip adds to the long waves of tall grains, and takes from those of grooves."""

from dataclasses import replace

import numpy as np
import pytest

from mesoscale.settings import TopographySettings
from mesoscale.topography.description.heights import common_heights, height_quantiles
from mesoscale.topography.description.parameters import analyse
from mesoscale.topography.description.tip import tip_lift, with_lift_error, without_lift
from mesoscale.topography.height_synthesis import Z, synthesize_heights
from mesoscale.topography.measurements.cleaning import Scan
from mesoscale.topography.measurements.loading import Measurement
from mesoscale.topography.records import record, trusted_record
from mesoscale.topography.roughness_spectrum import RoughSpectrum
from mesoscale.topography.spectrum import radial_spectrum
from mesoscale.topography.synthetic_scans import dilate

SIDE, SITES, RADIUS = 1000.0, 512, 6.0
SPECTRUM = RoughSpectrum.from_rms(4.0, 0.03, 2.8, 1.6)
GRAINS, GROOVES, GAUSS = (common_heights([z]) for z in (np.exp(0.25 * Z), -np.exp(-0.25 * Z), Z))
SETTINGS = TopographySettings(
    scans=("a",), tip_radius_nm=RADIUS, line_alignment="none", detrend="none"
)


def images(heights, count=3):
    """Surfaces and what a tip makes of them, and ln of the ratio of their long waves."""
    for seed in range(count):
        surface = synthesize_heights(SITES, SIDE, SPECTRUM.psd, heights, 4.0, seed)
        image = dilate(surface, RADIUS, SIDE / SITES)
        before, after = (
            radial_spectrum(z, (SIDE, SIDE), 9, 0.75, flat=0.0) for z in (surface, image)
        )
        long = (before.q > 0.02) & (before.q < 0.08)
        yield (
            Scan(image, (SIDE, SIDE), f"s{seed}"),
            float(np.log(after.psd / before.psd)[long].mean()),
        )


def analysed(heights):
    scans, lifts = zip(*images(heights), strict=True)
    measured = [(scan.name, *record(Measurement(scan, RADIUS, True), SETTINGS)) for scan in scans]
    spectra = [trusted_record(*each) for each in measured]
    quantiles = {scan.name: height_quantiles(scan.heights_nm) for scan in scans}
    return spectra, quantiles, float(np.mean(lifts))


@pytest.mark.parametrize(("heights", "sign"), [(GRAINS, 1), (GROOVES, -1)])
def test_what_a_tip_changes_is_found_within_its_error(heights, sign):
    """Grains are lifted, grooves are filled."""
    spectra, quantiles, true = analysed(heights)
    topography = analyse(spectra, SETTINGS)
    seen = max(item.high for item in spectra)
    gain, error = tip_lift(
        RADIUS,
        topography.likelihood,
        seen,
        topography.cutoff,
        np.mean(list(quantiles.values()), axis=0),
    )
    assert sign * true > 0.15  # a fifth of the power: dilation, not the analysis, says so
    assert abs(gain - true) < 1.645 * error
    assert error < 0.6 * sign * gain


def test_a_gaussian_surface_is_not_lifted():
    """The mean lift of a Gaussian surface is the same everywhere."""
    spectra, _, true = analysed(GAUSS)
    topography = analyse(spectra, SETTINGS)
    gain, _ = tip_lift(RADIUS, topography.likelihood, 0.3, topography.cutoff, np.array(GAUSS))
    assert abs(true) < 0.06
    assert gain == pytest.approx(0.0, abs=1e-3)


def test_taking_the_lift_off_lowers_maps_and_widens_the_rms():
    spectra, quantiles, _ = analysed(GRAINS)
    topography = analyse(spectra, SETTINGS)
    lowered, error = without_lift(spectra, topography, quantiles)
    ratio = lowered[0].spectrum.psd / spectra[0].spectrum.psd
    assert ratio[0] < 0.9
    assert lowered[0].rms_nm == pytest.approx(spectra[0].rms_nm * np.sqrt(ratio[0]), rel=1e-3)
    # waves that the tip takes anyway are lifted less
    trusted = spectra[0].trusted
    assert np.all(np.diff(ratio[trusted][::20]) > 0)
    wider = with_lift_error(topography, error).estimates["rms"].interval
    plain = topography.estimates["rms"].interval
    assert wider[0] < plain[0]
    assert wider[1] > plain[1]
    sharp = [replace(item, tip_radius_nm=0.0) for item in spectra]
    assert without_lift(sharp, topography, quantiles) == (sharp, 0.0)
