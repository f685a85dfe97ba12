"""An error of the tip's radius is part of the intervals."""

import numpy as np

from mesoscale.settings import TopographySettings
from mesoscale.studies.topography_stability import trusted_scan
from mesoscale.topography.description.one_spectrum import merge
from mesoscale.topography.description.parameters import analyse
from mesoscale.topography.description.tip import spectrum_with_radius_error, with_radius_error
from mesoscale.topography.synthetic_scans import ScanSet, synthetic_scans


def test_a_radius_told_too_large_leaves_the_truth_inside():
    """A tip of 5 nm told as 6: the slope alone is biased, its interval holds the error of the
    radius.
    """
    truth = ScanSet(pixels=512, small_scans=4, large_scans=2, rms_variation=0.0)
    settings = TopographySettings(tip_radius_nm=6.0)
    spectra = [trusted_scan(item.scan, settings) for item in synthetic_scans(truth)]
    plain = analyse(spectra, settings)
    wider = with_radius_error(plain, spectra, settings)
    for name, true in {"q0": truth.q0, "slope": truth.slope, "rms": truth.rms_nm}.items():
        low, high = wider.estimates[name].interval
        assert low < true < high
        assert low <= plain.estimates[name].interval[0] < plain.estimates[name].interval[1] <= high
    lengths = [
        ends[1] - ends[0] for ends in (item.estimates["slope"].interval for item in (plain, wider))
    ]
    assert lengths[1] > lengths[0]


def test_without_a_tip_nothing_changes():
    settings = TopographySettings(tip_radius_nm=0.0)
    truth = ScanSet(pixels=128, small_scans=1, large_scans=1, tip_radius_nm=0.0)
    spectra = [trusted_scan(item.scan, settings) for item in synthetic_scans(truth)]
    plain = analyse(spectra, settings)
    assert with_radius_error(plain, spectra, settings) is plain


def test_the_band_of_the_spectrum_holds_what_the_radius_changes():
    """Of a tip told too large the short waves are corrected by too much: the wider band says so."""
    truth = ScanSet(pixels=256, small_scans=4, large_scans=0, rms_variation=0.0)
    spectra = [
        trusted_scan(item.scan, TopographySettings(tip_radius_nm=6.0))
        for item in synthetic_scans(truth)
    ]
    plain = merge(spectra)
    wider = spectrum_with_radius_error(plain, spectra)
    assert np.array_equal(wider.log_psd, plain.log_psd)
    assert wider.log_sd[-1] > 1.2 * plain.log_sd[-1]  # where the tip takes waves
    middle = np.argmin(np.abs(plain.q - 0.03))
    assert wider.log_sd[middle] < 1.1 * plain.log_sd[middle]  # where it does not
    plain_low, wider_low = (one.statistics()["rms_slope"]["interval"][0] for one in (plain, wider))
    assert wider_low < plain_low
