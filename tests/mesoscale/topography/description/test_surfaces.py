"""One surface or several: which maps go together, how often chance parts them, and what is said."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from mesoscale.settings import TopographySettings
from mesoscale.studies.topography_stability import trusted_scan
from mesoscale.topography.description import surfaces
from mesoscale.topography.description.overlaps import overlaps
from mesoscale.topography.description.surfaces import best_cut, by_chance, several_surfaces
from mesoscale.topography.synthetic_scans import ScanSet, synthetic_scans
from tests.mesoscale.topography.description.test_one_spectrum import measured


def doubts_of(spectra, files=None):
    return several_surfaces(spectra, overlaps(spectra), files or {})


def maps(seed, **truth):
    """Maps of 1 and 5 um of one surface."""
    made = synthetic_scans(
        ScanSet(pixels=256, small_scans=2, large_scans=2, large_length_nm=5000, seed=seed, **truth)
    )
    settings = TopographySettings(tip_radius_nm=5.0)
    return [
        replace(trusted_scan(item.scan, settings), name=f"{item.scan.name}_{seed}") for item in made
    ]


@pytest.mark.parametrize("n", [4, 6])
@pytest.mark.parametrize("alike", [True, False])
def test_the_best_cut_is_the_best_by_brute_force(n, alike):
    """Over all partitions where all places have like errors, else over those that a cut can
    make.
    """
    rng = np.random.default_rng(n)
    values, mixed = rng.standard_normal(n), 0.2 * rng.standard_normal((n, n))
    covariance = 0.04 * np.eye(n) + 0.01 if alike else mixed @ mixed.T
    scores = []
    for count in range(1, n):
        for chosen in itertools.combinations(range(n), count):
            heap = np.isin(np.arange(n), chosen)
            if not alike and values[heap].min() < values[~heap].max():
                continue
            contrast = heap / count - ~heap / (n - count)
            inside = np.eye(n) - np.outer(heap, heap) / count - np.outer(~heap, ~heap) / (n - count)
            scatter = max(values @ inside @ values - np.trace(inside @ covariance), 0) / (n - 2)
            variance = contrast @ covariance @ contrast + scatter * (1 / count + 1 / (n - count))
            scores.append(contrast @ values / np.sqrt(variance))
    cut = best_cut(values, covariance)
    assert cut.score == pytest.approx(max(scores))
    assert cut.apart == pytest.approx(values[cut.high].mean() - values[cut.low].mean())


def test_places_of_one_film_are_parted_no_more_often_than_stated(monkeypatch):
    """400 films of six places: 20 false alarms are expected at 5 %, at most 32 in 99 % of such
    counts.
    """
    monkeypatch.setattr(surfaces, "SIMULATED", 199)
    rng, errors = np.random.default_rng(1), np.eye(6) * 0.05**2
    for scatter in (0.0, 0.4):
        films = np.hypot(0.05, scatter) * rng.standard_normal((200, 6))
        alarms = [
            by_chance(values, errors, best_cut(values, errors).score) <= 0.05 for values in films
        ]
        assert sum(alarms) <= 18  # of 200, by the same measure


def test_maps_of_one_surface_are_not_doubted():
    """Sizes, steepness and places that differ by 40 % in RMS height, seen through tip, noise and
    levelling.
    """
    for seed, slope in enumerate((2.4, 3.2, 4.0)):
        assert doubts_of(maps(seed, slope=slope)) == []


def test_maps_of_two_surfaces_are_named_by_group_and_the_remedy_by_file():
    first, second = maps(10, rms_variation=0.0), maps(11, rms_variation=0.0, rms_nm=12.0)
    spectra = [*first, *second]
    files = {item.name: f"{item.name}.gwy" for item in spectra}
    (doubt,) = doubts_of(spectra, files)
    assert doubt.code == "several_surfaces"
    assert doubt.fatal
    names = [", ".join(item.name for item in part) for part in (first, second)]
    assert doubt.text.startswith(f"{names[0]} and {names[1]} look like two surfaces")
    scans = [", ".join(files[item.name] for item in part) for part in (first, second)]
    assert (
        f"topography: {{scans: [{scans[0]}]}} and topography: {{scans: [{scans[1]}]}}"
        in doubt.remedy
    )


def test_two_maps_of_unlike_spectra_are_doubted():
    rng = np.random.default_rng(1)
    place = measured("place", 0.01, 0.5, 1.0, rng)
    steeper = measured("steeper", 0.02, 0.8, 1.0, rng)
    steeper = replace(
        steeper, spectrum=replace(steeper.spectrum, psd=steeper.spectrum.psd * steeper.spectrum.q)
    )
    for other, words in (
        (steeper, "differ in shape"),
        (measured("rough", 0.02, 0.8, 60.0, rng), "by a factor of"),
    ):
        (doubt,) = doubts_of([place, other])
        assert doubt.code == "several_surfaces"
        assert f"place and {other.name} look like two surfaces" in doubt.text
        assert words in doubt.text


def test_two_maps_of_unlike_levels_may_be_either():
    rng = np.random.default_rng(1)
    place, other = measured("place", 0.01, 0.5, 1.0, rng), measured("other", 0.02, 0.8, 5.0, rng)
    (doubt,) = doubts_of([place, other])
    assert doubt.code == "few_places"
    assert not doubt.fatal
    assert "cannot tell two surfaces from places of one" in doubt.text
    assert doubts_of([place, measured("same", 0.02, 0.8, 1.0, rng)]) == []


def test_measurements_without_a_shared_band_are_not_doubted():
    apart = [measured(str(k), 10.0**-k, 3 * 10.0**-k, 3.0**k) for k in range(5)]
    assert doubts_of(apart) == []
