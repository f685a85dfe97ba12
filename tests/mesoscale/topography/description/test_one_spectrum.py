"""One spectrum from many measurements: what it joins, how sure it is, and what it refuses."""

from dataclasses import replace

import numpy as np
import pytest

from mesoscale.errors import InputError
from mesoscale.topography.description.intervals import REACH
from mesoscale.topography.description.one_spectrum import merge
from mesoscale.topography.description.overlaps import overlaps, refuse_different_films
from mesoscale.topography.description.trusted_range import TrustedSpectrum
from mesoscale.topography.roughness_spectrum import RoughSpectrum
from mesoscale.topography.spectrum import Spectrum

TRUTH = RoughSpectrum.from_rms(6.0, 0.02, 3.0, 100.0)


def measured(name, low, high, factor=1.0, rng=None, modes=50.0):
    """Shells of a measurement of `factor` times the true spectrum, with the scatter of `modes`
    independent waves.
    """
    spacing = low / 2.5
    q = spacing * np.arange(1, int(high / spacing) + 1)
    psd = factor * TRUTH.psd(q)
    if rng is not None:
        psd *= rng.gamma(modes, 1 / modes, len(q))
    spectrum = Spectrum(q, psd, np.full(len(q), modes), spacing, 1.4 * high, sharp=True)
    return TrustedSpectrum(name, spectrum, low, high, "pixels", 0.0, 6.0, high)


def test_ranges_that_overlap_give_the_spectrum_over_all_scales():
    one = merge(
        [
            measured("large", 1e-3, 0.05),
            measured("small", 0.01, 0.5),
            measured("side view", 0.2, 5.0),
        ]
    )
    seen = one.count > 0
    assert one.q[seen][0] < 1.3e-3
    assert one.q[-1] > 4
    assert np.log(one.psd[seen]) == pytest.approx(np.log(TRUTH.psd(one.q[seen])), abs=0.08)
    assert np.sqrt(one.moment(0)) == pytest.approx(6.0, rel=0.02)


def test_moments_are_those_of_the_spectrum():
    one = merge([measured("all", 1e-3, 5.0, modes=1e4)])
    end = RoughSpectrum(TRUTH.plateau, TRUTH.q0, TRUTH.slope, float(one.q[-1]))
    statistics = one.statistics()
    assert statistics["rms_slope"]["value"] == pytest.approx(end.rms_slope, rel=0.05)
    for entry in statistics.values():
        assert entry["interval"][0] < entry["value"] < entry["interval"][1]


def test_places_that_differ_widen_the_band_and_agree_on_the_middle():
    rng = np.random.default_rng(0)
    factors = np.exp(0.5 * rng.standard_normal(12))
    one = merge([measured(str(k), 0.01, 0.5, factor, rng) for k, factor in enumerate(factors)])
    assert one.place_sd == pytest.approx(np.std(np.log(factors)), rel=0.15)
    middle = np.mean(np.log(one.psd / TRUTH.psd(one.q)))
    assert middle == pytest.approx(np.mean(np.log(factors)), abs=0.1)
    typical, anywhere = (
        np.std(np.log(one.draws(places=places)[:, -5])) for places in (False, True)
    )
    assert anywhere > 2 * typical


def test_bands_cover_the_truth_as_often_as_they_say():
    """Places of known scatter, 60 surfaces: the band of the typical place at 90 %."""
    inside = []
    for seed in range(60):
        rng = np.random.default_rng(seed)
        places = [
            measured(str(k), 0.01, 0.5, np.exp(0.4 * rng.standard_normal()), rng) for k in range(10)
        ]
        one = merge(places)
        low, high = one.band()
        inside.append(np.mean((low < TRUTH.psd(one.q)) & (TRUTH.psd(one.q) < high)))
    assert 0.8 < np.mean(inside) <= 1.0


def test_a_gap_is_bridged_with_an_uncertainty_that_grows_into_it():
    one = merge([measured("large", 1e-3, 0.01), measured("small", 0.2, 2.0)])
    gap = (one.count == 0) & (one.q > 0.01)
    assert gap.sum() > 8
    sees = int(np.searchsorted(one.q, 5e-3))  # beside the level of the place, which no band tells
    covariance = one.covariance
    shape_sd = np.sqrt(np.diag(covariance) + covariance[sees, sees] - 2 * covariance[sees])
    assert shape_sd[gap].max() > 5 * shape_sd[(one.q > 2e-3) & (one.q < 0.01)].max()
    away = np.abs(np.log(one.psd[gap] / TRUTH.psd(one.q[gap])))
    assert np.all(away < 2 * one.log_sd[gap])


def test_overlaps_agree_or_say_how_far_they_are_apart():
    (alike,) = overlaps([measured("a", 0.01, 0.5), measured("b", 0.05, 1.0)])
    assert alike.agrees
    (apart,) = overlaps([measured("a", 0.01, 0.5), measured("b", 0.05, 1.0, 4.0)])
    assert not apart.agrees
    assert apart.ratio == pytest.approx(4.0, rel=0.05)
    refuse_different_films([alike, apart])
    assert overlaps([measured("a", 0.01, 0.1), measured("c", 1.0, 5.0)]) == []


def test_files_of_different_films_are_refused_by_name():
    pairs = overlaps([measured("smooth", 0.01, 0.5), measured("rough", 0.05, 1.0, 1e4)])
    with pytest.raises(InputError, match="smooth and rough cannot be one surface"):
        refuse_different_films(pairs)


def test_too_little_gives_none():
    assert merge([]) is None


def test_the_mean_square_of_the_largest_map_bounds_waves_that_no_band_measures():
    """A map begins beyond the knee: its bands alone leave the RMS height open, its levelled heights
    do not.
    """
    side = 2 * np.pi / (0.05 / 2.5 * 0.75)
    low = 0.72 * 2 * np.pi / side
    q = np.geomspace(low, 1.0, 1000)
    rms = np.sqrt(np.trapezoid(2 * np.pi * q * TRUTH.psd(q), q))
    alone = replace(measured("map", 0.05, 1.0), rms_nm=rms)
    open_ended, bounded = merge([alone]), merge([replace(alone, side_nm=side)])
    widths = [
        np.ptp(np.quantile(np.log(one.moment(0, psd=one.draws(False))), [0.05, 0.95]))
        for one in (open_ended, bounded)
    ]
    assert widths[1] < 0.8 * widths[0]
    assert np.median(
        np.sqrt(bounded.moment(0, low=low, psd=bounded.draws(False)))
    ) == pytest.approx(rms, rel=0.2)


def test_a_longer_line_knows_the_long_waves_of_a_map_better():
    small = replace(measured("map", 0.05, 1.0), rms_nm=1.6, side_nm=400.0)
    assert merge([measured("line", 1e-3, 0.1), small]).logs is None


def test_bands_of_few_places_hold_the_truth_as_often_as_they_say():
    """Three places of known scatter, 200 surfaces: the band of the typical place, and one more
    place, at 90 %.
    """
    typical, another = [], []
    for seed in range(200):
        rng = np.random.default_rng(seed)
        one = merge(
            [
                measured(str(k), 0.01, 0.5, np.exp(0.4 * rng.standard_normal()), rng)
                for k in range(3)
            ]
        )
        middle = int(np.argmin(np.abs(one.q - 0.1)))
        true = np.log(TRUTH.psd(one.q[middle]))
        typical.append(abs(true - one.log_psd[middle]) < REACH * one.log_sd[middle])
        drawn = np.log(one.draws(places=True)[:, middle])
        low, high = np.quantile(drawn, [0.05, 0.95])
        another.append(low < true + 0.4 * rng.standard_normal() < high)
    # three standard deviations of 200 counts at 90 % are 0.064
    assert 0.84 < np.mean(typical) < 0.96
    assert 0.84 < np.mean(another) < 0.96


def test_the_mean_over_a_band_of_a_steep_spectrum_is_not_taken_for_its_middle():
    one = merge([measured(str(k), 0.05, 1.0, modes=1e6) for k in range(4)])
    beyond = (one.q > 0.1) & (one.q < 0.8)
    assert np.log(one.psd / TRUTH.psd(one.q))[beyond] == pytest.approx(0.0, abs=0.005)
