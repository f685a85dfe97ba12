"""The scans as judges of their description."""

from dataclasses import replace

import numpy as np
import pytest

from mesoscale.inputs.contact import ContactInputs
from mesoscale.scan_checks.judged import Described, _predicted, judge
from mesoscale.settings import ContactSettings, TopographySettings
from mesoscale.studies.topography_stability import trusted_scan
from mesoscale.topography.description.one_spectrum import merge
from mesoscale.topography.description.parameters import analyse
from mesoscale.topography.height_synthesis import synthesize_heights
from mesoscale.topography.measurements.cleaning import Scan
from mesoscale.topography.roughness_spectrum import RoughSpectrum
from tests.mesoscale.topography.test_height_synthesis import SKEWED

INPUTS = ContactInputs(hamaker=0.2, e_star=91, h_macro=2, h_prime=8, q0=0.05, hurst=0.5, rms=4)
SETTINGS = TopographySettings(scans=("a",), line_alignment="none", tip_radius_nm=0)
SPECTRUM = RoughSpectrum.from_rms(4.0, 0.05, 3.0, 5.0)


def grainy(count):
    """Scans of one grainy surface, cut from larger ones: not periodic."""
    for seed in range(count):
        larger = synthesize_heights(256, 2000.0, SPECTRUM.psd, SKEWED, 4.0, 100 + seed)
        yield Scan(larger[:128, :128], (1000.0, 1000.0), f"g{seed}")


def judged(scans, name):
    spectra = [trusted_scan(scan, SETTINGS) for scan in scans]
    return list(
        judge(scans, spectra, name, INPUTS, SETTINGS, ContactSettings(mechanics="asperity"))
    )


@pytest.fixture(scope="module")
def by_heights():
    """Four grainy scans, each judged by the description that the other three make."""
    return judged(list(grainy(4)), "measured_heights")


def test_scans_agree_with_the_description_that_the_others_make(by_heights):
    assert all(row["left_out"] for row in by_heights)
    assert np.mean([row["inside"] for row in by_heights]) >= 0.85


def test_a_gaussian_description_of_tall_grains_is_found_out(by_heights):
    grains, plain = (
        np.median(
            [row["pressed"] / row["median"] for row in rows if row["quantity"] == "first_contact"]
        )
        for rows in (by_heights, judged(list(grainy(4)), "measured_spectrum"))
    )
    assert abs(grains - 1) < 0.15
    assert plain > 1.1 * grains


def test_a_lone_scan_judges_the_description_made_from_itself():
    rows = judged(list(grainy(1)), "measured_heights")
    assert not any(row["left_out"] for row in rows)
    assert {row["quantity"] for row in rows} == {
        "rms",
        "first_contact",
        "separation_1uN",
        "separation_7uN",
        "area_7uN",
    }


@pytest.mark.parametrize("measured", [False, True], ids=["eq. 9", "measured spectrum"])
def test_the_first_surfaces_scatter_as_places_do(measured):
    """Twenty are pressed: too few to leave the scatter between places to chance."""
    factors = np.exp(0.4 * np.array([-1.3, -0.6, 0.0, 0.6, 1.3]))
    scans = [
        replace(scan, heights_nm=k * scan.heights_nm)
        for k, scan in zip(factors, grainy(5), strict=True)
    ]
    spectra = [trusted_scan(scan, SETTINGS) for scan in scans]
    topography, one = analyse(spectra, SETTINGS), merge(spectra) if measured else None
    levels = [
        np.log(psd(np.array([0.1]))[0]) / 2 for psd in Described(topography, one, ()).spectra(20)
    ]
    place = (one.place_sd if one else topography.likelihood.amplitude_sd) / 2
    assert np.std(levels) == pytest.approx(place, rel=0.3)


def test_a_scan_that_the_others_say_nothing_of_is_passed_over():
    first, second = grainy(2)
    blind = trusted_scan(second, SETTINGS)
    spectra = [trusted_scan(first, SETTINGS), replace(blind, high=blind.low, reach=blind.low)]
    rows = judge(
        [first, second],
        spectra,
        "power_law",
        INPUTS,
        SETTINGS,
        ContactSettings(mechanics="asperity"),
    )
    assert {row["scan"] for row in rows} == {"g1"}


def test_a_load_that_merges_all_contacts_is_no_judge():
    """The same heights a thousand times as far apart: 7 MPa press all of them flat."""
    (scan,) = grainy(1)
    wide = Scan(scan.heights_nm, (1e6, 1e6), "wide")
    assert {row["quantity"] for row in judged([wide], "measured_heights")} <= {
        "rms",
        "first_contact",
        "separation_1uN",
    }


@pytest.mark.parametrize(("count", "outside"), [(20, 1), (40, 2)])
def test_one_more_value_lies_between_the_ends_as_often_as_is_said(count, outside):
    """By counting: of count + 1 alike, each is equally likely to be the one more."""
    values = np.random.default_rng(1).standard_normal(count)
    low, _, high = _predicted(values, positive=False)
    assert (low, high) == (np.sort(values)[outside - 1], np.sort(values)[-outside])
    assert 0.9 <= 1 - 2 * outside / (count + 1) < 0.91
