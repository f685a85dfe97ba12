"""The side of cells: enough measured waves on it, and room for it below the electrode."""

import numpy as np
import pytest

from mesoscale.errors import InputError
from mesoscale.settings import ContactSettings, TopographySettings
from mesoscale.topography.description.cell import finer_waves_doubt, grown_cell, suited_cell
from mesoscale.topography.description.trusted_range import TrustedSpectrum
from mesoscale.topography.measurements.cleaning import Scan
from mesoscale.topography.measurements.loading import Measurement
from mesoscale.topography.pooling import pool
from mesoscale.topography.records import record
from mesoscale.topography.roughness_spectrum import RoughSpectrum
from mesoscale.topography.spectrum import Spectrum
from mesoscale.topography.synthetic_scans import surface_patch

SETTINGS = TopographySettings(scans=("a",), line_alignment="none", tip_radius_nm=0)
SIDE_NM = 50_000.0
TRUTH = RoughSpectrum.from_rms(80.0, 3e-4, 3.4, 0.2)


def seen(wave_nm, name="film"):
    """A measurement that shows waves down to `wave_nm`."""
    q = np.geomspace(1e-5, 1.0, 30)
    return TrustedSpectrum(
        name, Spectrum(q, q**-3, np.ones(30), 1e-5, 1.0), 1e-5, 2 * np.pi / wave_nm, "pixels", 0.0
    )


def rms_of_cells(film, side_nm):
    """RMS height (nm) of cells by a known spectrum, flat beyond their longest wave."""
    step = 2 * np.pi / side_nm
    numbers = np.arange(-64, 65)
    waves = step * np.hypot(numbers[:, None], numbers)
    return step * np.sqrt(film.psd(np.maximum(waves, step)).sum())


@pytest.fixture(scope="module")
def coarse():
    heights = surface_patch(TRUTH, 256, SIDE_NM, np.random.default_rng(1))
    scan = Scan(heights, (SIDE_NM, SIDE_NM), "optical")
    arrays, attributes = record(Measurement(scan, 0.0, True), SETTINGS)
    return {"optical": arrays}, {"optical": attributes | {"file": "a", "sha256": "b"}}


@pytest.mark.parametrize(
    ("wave_nm", "side_nm"), [(20.0, 1000.0), (125.0, 1000.0), (160.0, 1300.0), (9876.0, 79000.0)]
)
def test_a_cell_holds_eight_of_the_shortest_measured_waves(wave_nm, side_nm):
    assert suited_cell([seen(3 * wave_nm), seen(wave_nm)]) == side_nm


def test_an_electrode_bounds_the_cell():
    assert suited_cell([seen(20.0)], electrode_nm=500.0) == 500.0
    assert suited_cell([seen(1000.0)], electrode_nm=5000.0) == 5000.0


def test_waves_all_longer_than_the_electrode_are_refused_with_the_way_out():
    with pytest.raises(
        InputError,
        match=r"that film shows is 4e\+03 nm long.*side of 5e\+03 nm.*measure on a finer",
    ):
        suited_cell([seen(4000.0)], electrode_nm=5000.0)


def test_a_coarse_map_ends_in_a_cell_of_its_scale(coarse):
    """Cut from the truth, cells of this side have this RMS height."""
    pooled = pool(*coarse, SETTINGS, cell_nm=None)
    assert pooled.cell_nm == pytest.approx(
        8 * 2 * np.pi / max(item.high for item in pooled.spectra), rel=0.05
    )
    rms = rms_of_cells(TRUTH, pooled.cell_nm)
    low, high = (pooled.rows["rms"][end] for end in "ab")
    assert 0.9 * low < rms < 1.1 * high  # one map: no scatter between places
    assert "finer_waves" in [doubt.code for doubt in pooled.doubts]


def test_what_finer_waves_would_change_is_that_of_the_spectrum():
    (doubt,) = finer_waves_doubt(lambda q: q**-3.0, [seen(1000.0)], 8000.0)
    # slope^2 = 2 pi (end - step), with the shortest wave at 2 pi / 1000 nm and at a tenth of it
    slopes = [2 * np.pi * np.sqrt((1 / wave - 1 / 8000) * 1.0) for wave in (100.0, 1000.0)]
    assert f"would be {slopes[0]:.2g} instead of {slopes[1]:.2g}" in doubt.text
    assert not finer_waves_doubt(lambda q: q**-3.0, [seen(50.0)], 1000.0)


def test_maps_without_a_common_scale_raise_a_doubt_with_the_way_out(coarse):
    fine = Scan(surface_patch(TRUTH, 256, 500.0, np.random.default_rng(2)), (500.0, 500.0), "afm")
    arrays, attributes = record(Measurement(fine, 0.0, True), SETTINGS)
    pooled = pool(
        {**coarse[0], "afm": arrays}, {**coarse[1], "afm": attributes}, SETTINGS, cell_nm=None
    )
    assert pooled.cell_nm == ContactSettings().length_nm
    (gap,) = (doubt for doubt in pooled.doubts if doubt.code == "gap")
    assert "nothing is measured from" in gap.text
    assert gap.remedy == "add scans of the sizes between"


@pytest.mark.parametrize(
    ("pixels", "room_nm", "side_nm"),
    [
        (512, np.inf, 4000.0),  # holds 1 - 1/16 of the mean square
        (128, np.inf, 2000.0),  # the grid resolves waves of 40 nm on 2560 nm
        (512, 3000.0, 2000.0),  # the electrode
        (0, np.inf, 1000.0),
    ],
)
def test_a_cell_grows_with_the_long_waves_of_a_film(pixels, room_nm, side_nm):
    assert (
        grown_cell(1000.0, lambda side: 1.0 - (1000.0 / side) ** 2, 40.0, pixels, room_nm)
        == side_nm
    )


def test_a_cell_of_a_film_that_it_holds_does_not_grow():
    assert grown_cell(1000.0, lambda side: 0.82, 40.0, 512, np.inf) == 1000.0


def test_a_film_of_long_waves_gets_cells_that_hold_them():
    """Only where its surfaces end at the measured cut-off, so that a longer cell has the same short
    waves.
    """
    film = RoughSpectrum.from_rms(14.0, 2.5e-3, 3.4, 0.3)
    heights = surface_patch(film, 512, 5000.0, np.random.default_rng(3))
    arrays, attributes = record(
        Measurement(Scan(heights, (5000.0, 5000.0), "afm"), 0.0, True), SETTINGS
    )
    given = {"afm": arrays}, {"afm": attributes | {"file": "a", "sha256": "b"}}, SETTINGS
    short, grown = (
        pool(*given, cell_nm=None, pixels=512),
        pool(*given, cell_nm=None, cut_off=True, pixels=512),
    )
    assert short.cell_nm == 1000.0
    assert grown.cell_nm == 4000.0
    middles = [np.mean([pooled.rows["rms"][end] for end in "ab"]) for pooled in (short, grown)]
    wanted = rms_of_cells(film, 4000.0) / rms_of_cells(film, 1000.0)
    assert middles[1] / middles[0] == pytest.approx(wanted, rel=0.1)
    codes = [{doubt.code for doubt in pooled.doubts} for pooled in (short, grown)]
    assert "waves_beyond_cell" in codes[0]
    assert "waves_beyond_cell" not in codes[1]
