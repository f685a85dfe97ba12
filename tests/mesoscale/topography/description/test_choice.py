"""Which description is chosen by which evidence, and what it hands on."""

from dataclasses import replace

import numpy as np
import pytest

from mesoscale.contact.surface import random_surface
from mesoscale.errors import InputError
from mesoscale.inputs.contact import ContactInputs
from mesoscale.settings import ContactSettings, TopographySettings
from mesoscale.topography.description.heights import slope_ratio
from mesoscale.topography.height_synthesis import synthesize_heights
from mesoscale.topography.measurements.cleaning import Scan
from mesoscale.topography.measurements.loading import Measurement
from mesoscale.topography.pooling import pool
from mesoscale.topography.records import record
from mesoscale.topography.roughness_spectrum import RoughSpectrum
from mesoscale.topography.summary import parameters
from mesoscale.topography.synthesis import synthesize_spectrum
from mesoscale.topography.synthetic_scans import ScanSet, surface_patch, synthetic_scans
from tests.mesoscale.topography.test_height_synthesis import SKEWED

SETTINGS = TopographySettings(scans=("a",), line_alignment="none", tip_radius_nm=0)


def described(scans, settings=SETTINGS, cell_nm=1000.0):
    arrays, attributes = {}, {}
    for scan in scans:
        arrays[scan.name], attributes[scan.name] = record(
            Measurement(scan, settings.tip_radius_nm, True), settings
        )
        attributes[scan.name] |= {"file": "a", "sha256": "b"}
    pooled = pool(arrays, attributes, settings, cell_nm)
    return pooled, parameters(pooled, attributes, settings)


def patches(slope, q0, count=3):
    truth = RoughSpectrum.from_rms(4.0, q0, slope, 5.0)
    return [
        Scan(
            surface_patch(truth, 256, 1000.0, np.random.default_rng(seed)),
            (1000.0, 1000.0),
            f"s{seed}",
        )
        for seed in range(count)
    ]


def grainy(count=3):
    psd = RoughSpectrum.from_rms(4.0, 0.05, 3.0, 5.0).psd
    return [
        Scan(synthesize_heights(256, 1000.0, psd, SKEWED, 4.0, seed), (1000.0, 1000.0), f"g{seed}")
        for seed in range(count)
    ]


def test_a_fractal_gaussian_surface_is_described_by_the_power_law():
    truth = ScanSet(
        pixels=256, small_scans=3, large_scans=3, large_length_nm=4000.0, rms_variation=0.0
    )
    settings = SETTINGS.model_copy(update={"tip_radius_nm": 5.0, "line_alignment": "median"})
    pooled, content = described([item.scan for item in synthetic_scans(truth)], settings)
    assert pooled.choice.name == "power_law"
    assert pooled.surface == {}
    # the roll-off fits on a cell
    assert pooled.rows["rms"]["a"] == pooled.topography.estimates["rms"].scatter[0]
    assert content["inputs"]["q0"]["a"] < 0.025 < content["inputs"]["q0"]["b"]
    assert content["gate"]["passed"]


@pytest.mark.parametrize("description", ["power_law", "measured_spectrum"])
def test_a_cell_gets_the_roughness_of_its_own_waves_where_the_roll_off_is_longer(description):
    """By a sum over the waves of a cell, and between squares cut from the surface with and without
    their tilts.
    """
    truth = RoughSpectrum.from_rms(20.0, 2 * np.pi / 4000, 3.6, 0.2)
    scans = [
        Scan(
            surface_patch(truth, 512, 16000.0, np.random.default_rng(seed)),
            (16000.0, 16000.0),
            f"w{seed}",
        )
        for seed in range(3)
    ]
    across = np.arange(32) - 15.5
    plane = np.stack([np.ones((32, 32)), *np.meshgrid(across, across)]).reshape(3, -1).T
    squares = np.concatenate(
        [scan.heights_nm.reshape(16, 32, 16, 32).swapaxes(1, 2) for scan in scans]
    ).reshape(-1, 1024)
    left = squares.T - plane @ np.linalg.lstsq(plane, squares.T, rcond=None)[0]
    settings = SETTINGS.model_copy(update={"description": description, "on_doubt": "warn"})
    pooled, content = described(scans, settings)
    found = 0.5 * (pooled.rows["rms"]["a"] + pooled.rows["rms"]["b"])
    step = 2 * np.pi / 1000
    waves = step * np.hypot(*np.meshgrid(np.arange(-64, 64), np.arange(-64, 64)))
    # of three scans
    assert found == pytest.approx(step * np.sqrt(truth.psd(np.maximum(waves, step)).sum()), rel=0.1)
    assert np.std(left) < found < np.std(squares - squares.mean(axis=1, keepdims=True))
    assert "waves_beyond_cell" in [doubt["code"] for doubt in content["doubts"]]


def test_scans_that_see_no_wave_of_a_cell_are_refused_with_the_way_out():
    heights = surface_patch(
        RoughSpectrum.from_rms(20.0, 1e-4, 3.6, 0.2), 256, 400_000.0, np.random.default_rng(1)
    )
    coarse = Scan(heights, (400_000.0, 400_000.0), "coarse")
    with pytest.raises(
        InputError, match=r"coarse shows is .* nm long.*set contact.length_nm to \S+ or more"
    ):
        described([coarse])
    described([coarse], cell_nm=60_000.0)


def test_what_pads_take_is_the_typical_place_and_the_scatter_of_places():
    truth = ScanSet(
        pixels=256, small_scans=8, large_scans=1, large_length_nm=4000.0, rms_variation=0.4
    )
    settings = SETTINGS.model_copy(update={"tip_radius_nm": 5.0, "line_alignment": "median"})
    _, content = described([item.scan for item in synthetic_scans(truth)], settings)
    film, anywhere = content["film"], content["inputs"]
    assert (film["rms"]["a"], film["rms"]["b"]) == pytest.approx(
        content["estimates"]["rms"]["interval"]
    )
    assert anywhere["rms"]["a"] < film["rms"]["a"] < film["rms"]["b"] < anywhere["rms"]["b"]
    assert (
        film["rms_scatter"]["a"]
        < 0.5 * content["likelihood"]["amplitude_sd"]
        < film["rms_scatter"]["b"]
    )


def test_a_slope_beyond_the_power_law_is_no_dead_end():
    pooled, content = described(patches(8.0, 0.05))
    assert pooled.choice.name == "measured_spectrum"
    assert content["gate"]["passed"]
    assert 0 < content["inputs"]["hurst"]["a"] < content["inputs"]["hurst"]["b"] < 2
    assert content["inputs"]["rms"]["a"] < 4.0 < content["inputs"]["rms"]["b"]
    assert any(doubt["code"] == "no_power_law" for doubt in content["doubts"])


def test_tall_grains_choose_the_measured_heights():
    pooled, content = described(grainy())
    assert pooled.choice.name == "measured_heights"
    assert len(content["surface"]["heights"]) == 111


def test_copies_of_a_file_are_one_place():
    """Three times the same file says no more of other places than once."""
    (scan,) = patches(3.0, 0.05, count=1)
    once, content = described([scan])
    thrice, repeated = described([scan, replace(scan, name="t1"), replace(scan, name="t2")])
    assert thrice.rows == once.rows
    assert "copies" not in [doubt["code"] for doubt in content["doubts"]]
    (doubt,) = (doubt for doubt in repeated["doubts"] if doubt["code"] == "copies")
    assert "t1 is a copy of s0" in doubt["text"]


def test_noise_says_nothing_and_is_refused():
    rng = np.random.default_rng(0)
    noise = [Scan(rng.standard_normal((128, 128)), (500.0, 500.0), f"n{k}") for k in range(2)]
    _, content = described(noise)
    assert not content["gate"]["passed"]
    assert content["inputs"] == {}
    assert any("not identifiable" in reason for reason in content["gate"]["reasons"])


@pytest.mark.parametrize("name", ["power_law", "measured_spectrum", "measured_heights"])
def test_a_scene_can_set_the_description(name):
    pooled, content = described(
        grainy(), SETTINGS.model_copy(update={"description": name, "on_doubt": "warn"})
    )
    assert pooled.choice.name == name
    assert content["description"]["overridden"]


def test_random_surfaces_follow_what_was_measured():
    """Spectrum and summit of surfaces made from the handed-on description are those of the
    scans.
    """
    scans = grainy(4)
    _, content = described(scans)
    middle = {
        name: (row["a"] + row["b"]) / 2 for name, row in content["inputs"].items() if name != "q1"
    }
    inputs = ContactInputs(hamaker=0.2, e_star=91, h_macro=2, h_prime=8, **middle)
    settings = ContactSettings(
        mechanics="asperity", pixels=256, length_nm=1000.0, surface=content["surface"]
    )
    highest = [-random_surface(inputs, settings, seed).min() for seed in range(6)]
    measured = [(scan.heights_nm - scan.heights_nm.mean()).max() for scan in scans]
    assert np.mean(highest) == pytest.approx(np.mean(measured), rel=0.15)


def test_the_inputs_bend_the_measured_spectrum():
    _, content = described(patches(8.0, 0.05))
    settings = ContactSettings(mechanics="asperity", pixels=128, surface=content["surface"])
    pivot = content["surface"]["spectrum"]
    base = {
        "hamaker": 0.2,
        "e_star": 91.0,
        "h_macro": 2.0,
        "h_prime": 8.0,
        "rms": 4.0,
        "q0": pivot["q0"],
    }
    flat, steep = (
        random_surface(ContactInputs(**base, hurst=pivot["hurst"] + shift), settings, 1)
        for shift in (-0.15, 0.15)
    )
    roughness = [np.std(np.diff(surface, axis=0)) for surface in (flat, steep)]
    assert roughness[0] > 1.02 * roughness[1]


def test_the_trusted_end_is_offered_with_its_uncertainty():
    _, content = described(grainy())
    end = content["trusted_end"]
    assert end["interval"][0] <= end["value"] <= end["interval"][1]
    assert end["limit"] in ("tip", "noise", "pixels")


def test_ridges_differ_from_isotropic_roughness():
    """A Gaussian surface stretched threefold along one axis has slopes three times as steep across
    it.
    """
    heights = synthesize_spectrum(384, 1000.0, lambda q: np.maximum(q, 0.03) ** -4.0, 1.0, 1)
    assert slope_ratio(heights[:128, :128]) < 1.25
    stretched = np.array(
        [np.interp(np.arange(384) / 3, np.arange(128), line) for line in heights[:384, :128]]
    )
    assert slope_ratio(stretched) == pytest.approx(3.0, rel=0.2)
