"""The synthetic AFM: surfaces of known spectrum, tip, reproducibility."""

import numpy as np
import pytest

from mesoscale.topography.roughness_spectrum import RoughSpectrum, mean_square
from mesoscale.topography.synthetic_scans import ScanSet, dilate, surface_patch, synthetic_scans

SMALL = ScanSet(small_scans=1, large_scans=1, pixels=64)


def test_model_spectrum_integrates_to_its_rms():
    truth = RoughSpectrum.from_rms(7.0, 0.02, 2.5, 3.0)
    q = np.geomspace(1e-5, 3.0, 200_001)
    assert truth.rms_nm == pytest.approx(7.0)
    assert np.trapezoid(2 * np.pi * q * truth.psd(q), q) == pytest.approx(49.0, rel=1e-4)
    assert np.trapezoid(2 * np.pi * q**3 * truth.psd(q), q) == pytest.approx(
        truth.rms_slope**2, rel=1e-4
    )
    assert mean_square(1.0, 0.02, 1.0, 3.0) > 0  # a slope whose integral is elementary on its own


def test_point_sampling_keeps_the_whole_mean_square():
    """Coarse pixels fold short waves back; they do not lose them."""
    truth = RoughSpectrum.from_rms(5.0, 0.05, 2.5, 3.0)
    squares = [
        np.var(surface_patch(truth, 128, 4000.0, np.random.default_rng(k))) for k in range(12)
    ]
    assert np.mean(squares) == pytest.approx(25.0, rel=0.04)


def test_tip_leaves_itself_on_a_spike_and_nothing_on_a_flat():
    surface = np.zeros((41, 41))
    assert np.array_equal(dilate(surface, 10.0, 1.0), surface)
    surface[20, 20] = 5.0
    traced = dilate(surface, 10.0, 1.0)
    assert traced[20 + 3, 20 + 4] == pytest.approx(5.0 - 25 / 20)  # h - r^2 / 2R
    assert traced[0, 0] == 0.0
    assert np.all(traced >= surface)


def test_blunter_tips_see_higher_surfaces():
    rng = np.random.default_rng(0)
    surface = surface_patch(RoughSpectrum.from_rms(3.0, 0.05, 2.5, 3.0), 64, 100.0, rng)
    sharp, blunt = dilate(surface, 2.0, 100 / 64), dilate(surface, 20.0, 100 / 64)
    assert np.all(blunt >= sharp)


def test_scan_k_does_not_depend_on_the_number_of_scans():
    one = next(synthetic_scans(SMALL)).scan.heights_nm
    more = next(synthetic_scans(SMALL.model_copy(update={"small_scans": 3}))).scan.heights_nm
    assert np.array_equal(one, more)
    other = next(synthetic_scans(SMALL.model_copy(update={"seed": 2}))).scan.heights_nm
    assert not np.array_equal(one, other)
