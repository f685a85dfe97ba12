"""Where the measured roughness ends: what the contact takes as its short-wave cut-off."""

from dataclasses import replace

import numpy as np
import pytest

from mesoscale.settings import TopographySettings
from mesoscale.topography.description.inputs import cutoff_row, rms_before, trusted_end
from mesoscale.topography.description.parameters import analyse
from mesoscale.topography.roughness_spectrum import RoughSpectrum
from tests.mesoscale.topography.description.test_parameters import spectra


def test_the_cutoff_is_where_the_tip_ends_with_an_error_of_its_radius():
    items = spectra()
    result = analyse(items, TopographySettings())
    end = trusted_end(items)
    limited = cutoff_row(replace(result, q1_limited=True), items)
    assert limited == {"distribution": "uniform", "a": end["interval"][0], "b": end["interval"][1]}
    assert limited["a"] <= end["value"] <= limited["b"]
    # the steeper the spectrum, the less the end moves with the radius: q ~ R^(-1/(3 - s/2))
    if end["limit"] == "tip":
        assert 1.05 < limited["b"] / end["value"] < 1.2


def test_a_power_law_that_is_seen_to_end_fixes_the_cutoff():
    items = spectra()
    result = replace(analyse(items, TopographySettings()), q1=0.4, q1_limited=False)
    assert cutoff_row(result, items) == {"distribution": "fixed", "a": 0.4}


def test_the_rms_height_before_the_cutoff_is_the_integral_of_the_spectrum():
    result = analyse(spectra(), TopographySettings())
    fitted, cutoff = result.likelihood, result.cutoff
    q1 = {"distribution": "uniform", "a": 0.2, "b": 0.4}
    cut = rms_before(q1, {"distribution": "uniform", "a": 3.0, "b": 6.0}, result, {})
    whole = RoughSpectrum(fitted.plateau, fitted.q0, fitted.slope, cutoff)
    q = np.geomspace(1e-6, cutoff, 200001)
    heights = 2 * np.pi * q * whole.psd(q)
    share = np.trapezoid(np.where(q <= 0.3, heights, 0.0), q) / np.trapezoid(heights, q)
    assert cut["a"] / 3.0 == pytest.approx(np.sqrt(share), rel=1e-4)
    assert cut["b"] / 6.0 == pytest.approx(np.sqrt(share), rel=1e-4)


def test_the_rms_height_before_the_cutoff_of_a_measured_spectrum():
    result = analyse(spectra(), TopographySettings())
    # C ~ q^-3 from 0.02 to 2: its integral up to q is 2 pi (0.02 + 1/0.02 - 1/q) with the plateau
    # below
    q = np.geomspace(0.02, 2.0, 40)
    surface = {"spectrum": {"q": q.tolist(), "psd": (q**-3).tolist()}}
    before = rms_before(
        {"distribution": "fixed", "a": 0.2}, {"distribution": "fixed", "a": 5.0}, result, surface
    )
    plateau = 0.5 / 0.02
    share = (plateau + 1 / 0.02 - 1 / 0.2) / (plateau + 1 / 0.02 - 1 / 2.0)
    assert before == {"distribution": "fixed", "a": pytest.approx(5.0 * np.sqrt(share), rel=1e-3)}
