"""Maps that a program smoothed, filtered or interpolated are told from measured ones, and trusted
to what is left.
"""

from pathlib import Path

import numpy as np
import pytest
from scipy import ndimage

import asperity as asp
from evidence.topography.treated import HONEST, row_of
from mesoscale.errors import InputError
from mesoscale.settings import TopographySettings
from mesoscale.topography.description.treatment import (
    PASSED,
    Treatment,
    repeated_pixels,
    restored,
    rhythm,
    treatment_of,
)
from mesoscale.topography.description.trusted_range import trusted_map
from mesoscale.topography.measurements.cleaning import Scan, clean
from mesoscale.topography.measurements.loading import with_limits
from mesoscale.topography.roughness_spectrum import RoughSpectrum
from mesoscale.topography.spectrum import hann_spectrum
from mesoscale.topography.synthetic_scans import surface_patch

PIXELS, SIDE = 256, 500.0
STEP = SIDE / PIXELS
SETTINGS = TopographySettings()
STAND_IN = Path(__file__).resolve().parents[5] / "shared/cases/stand_ins/smoothed_4_pixels.gwy"


@pytest.fixture(scope="module")
def honest():
    """Heights of RMS 4 nm with noise, as an instrument measures them."""
    rng = np.random.default_rng(3)
    truth = RoughSpectrum.from_rms(4.0, 0.05, 3.4, 8.0)
    return surface_patch(truth, PIXELS, SIDE, rng) + 0.02 * rng.standard_normal((PIXELS, PIXELS))


def lowpass(heights):
    q = 2 * np.abs(np.fft.fftfreq(PIXELS))
    return np.real(np.fft.ifft2(np.fft.fft2(heights) * (np.hypot(q[:, None], q[None, :]) < 0.3)))


def enlarged(order, factor):
    def enlarge(heights):
        part = int(PIXELS / factor)
        return np.asarray(ndimage.zoom(heights[:part, :part], factor, order=order, mode="nearest"))

    return enlarge


# what is done, and from which share of the Nyquist wave vector on a quarter of C or less is left
FILTERS = {
    "gaussian 1": (lambda z: ndimage.gaussian_filter(z, 1.0), 0.4),
    "gaussian 2": (lambda z: ndimage.gaussian_filter(z, 2.0), 0.2),
    "gaussian 4": (lambda z: ndimage.gaussian_filter(z, 4.0), 0.1),
    "mean 3": (lambda z: ndimage.uniform_filter(z, 3), 0.5),
    "mean 5": (lambda z: ndimage.uniform_filter(z, 5), 0.3),
    "median 3": (lambda z: ndimage.median_filter(z, 3), 0.55),
    "median 7": (lambda z: ndimage.median_filter(z, 7), 0.25),
    "low pass": (lowpass, 0.3),
    "linear 2": (enlarged(1, 2), 0.5),
    "linear 1.5": (enlarged(1, 1.5), 0.6),
    "spline 2": (enlarged(3, 2), 0.5),
    "spline 4": (enlarged(3, 4), 0.25),
}


def found(heights, name="map"):
    scan = Scan(heights, (SIDE, SIDE), name)
    cleaned = clean(scan, SETTINGS)
    return treatment_of(scan, cleaned, hann_spectrum(cleaned))


@pytest.mark.parametrize("name", FILTERS)
def test_a_treated_map_is_trusted_to_what_is_left_of_it(honest, name):
    treat, share = FILTERS[name]
    assert found(honest) is None
    treated = found(treat(honest))
    assert treated is not None
    nyquist = np.pi / STEP
    assert treated.end < 2 * share * nyquist  # `PASSED` is less than a quarter
    if name.startswith(("gaussian", "mean", "low")):
        assert treated.end > 0.7 * share * nyquist


@pytest.mark.parametrize("kind", HONEST)
def test_no_honest_map_is_called_treated(kind):
    """Steep, grainy and stretched surfaces, blunt tips, 8 bits, 1/f noise, a slow feedback: 0.4 %
    of 240 are.
    """
    assert [row_of(kind, "", number)["found"] for number in range(4)].count("") >= 3


def test_what_a_gaussian_took_is_put_back_where_the_map_is_trusted(honest):
    """C within a third of that before, the mean square height within a tenth."""
    sigma = 2.0
    before, after = (
        clean(Scan(z, (SIDE, SIDE), "map"), SETTINGS)
        for z in (honest, ndimage.gaussian_filter(honest, sigma))
    )
    treated = found(ndimage.gaussian_filter(honest, sigma))
    assert treated is not None
    assert treated.fall_q == pytest.approx(1 / (sigma * STEP), rel=0.1)
    spectrum, rms_nm = restored(hann_spectrum(after), treated, after.rms_nm)
    true = hann_spectrum(before)
    seen = (true.q > 0.5 * treated.end) & (true.q < treated.end)
    assert np.mean(np.log(spectrum.psd[seen] / true.psd[seen])) == pytest.approx(0.0, abs=0.3)
    assert after.rms_nm < rms_nm < 1.05 * before.rms_nm


def test_a_filter_passes_less_and_less():
    treated = Treatment("smoothed", 1.0, 1 / np.sqrt(np.log(1 / PASSED)))
    assert treated.passed(np.array([0.0, 1.0, 1e6])) == pytest.approx([1.0, PASSED, 0.0])


def test_medians_show_by_their_size_and_digits_do_not(honest):
    for size in (3, 5, 9):
        assert repeated_pixels(ndimage.median_filter(honest, size)) == pytest.approx(size, abs=1)
    assert repeated_pixels(np.round(honest / 0.1) * 0.1) == 0
    assert repeated_pixels(np.minimum(honest, np.quantile(honest, 0.9))) == 0  # a plateau


def test_a_map_of_repeated_pixels_is_refused_for_what_it_is(honest):
    scan = Scan(enlarged(0, 4)(honest), (SIDE, SIDE), "large")
    with pytest.raises(InputError, match="repeat the line before: the map was enlarged"):
        clean(scan, SETTINGS)
    along_lines = Scan(np.repeat(honest[::4], 4, axis=0) + 0.0 * honest, (SIDE, SIDE), "lines")
    assert rhythm(clean(along_lines, SETTINGS).heights_nm) == pytest.approx(4.0, rel=0.05)


def test_a_grating_has_no_rhythm_of_interpolation(honest):
    x = np.arange(PIXELS)
    for period in (4, 6, 8, 16):
        assert rhythm(honest + 20.0 * (x % period < period / 2)[:, None]) == 0
    edges = np.random.default_rng(1).integers(-1, 2, (1, PIXELS))  # of a pixel, rough ones
    for period in (20, 32, 48):
        assert rhythm(honest + 20.0 * ((x[:, None] + edges) % period < period / 3)) == 0
    assert rhythm(enlarged(1, 4)(honest)) == pytest.approx(4.0, rel=0.05)


def test_a_film_of_a_smoothed_map_has_the_doubt_and_its_range(honest):
    scans = [
        Scan(z, (SIDE, SIDE), name)
        for z, name in ((honest, "as_is"), (ndimage.gaussian_filter(honest, 2.0), "smooth"))
    ]
    plain, smooth = (asp.Film([scan], tip_nm=0.0) for scan in scans)
    assert "treated" not in [doubt["code"] for doubt in plain.description["doubts"]]
    (doubt,) = (doubt for doubt in smooth.description["doubts"] if doubt["code"] == "treated")
    (scan,) = smooth.description["scans"]
    assert scan["limit"] == "filter"
    assert f"trusted to {scan['trusted_high']:.2g} /nm" in doubt["text"]
    passes = np.sqrt(np.log(1 / PASSED)) / (2.0 * STEP)  # of a Gaussian of two pixels
    assert scan["trusted_high"] == pytest.approx(passes, rel=0.1)
    assert scan["trusted_high"] < plain.description["scans"][0]["trusted_high"]


def test_a_stated_filter_that_passes_less_counts(honest):
    scan = Scan(ndimage.gaussian_filter(honest, 2.0), (SIDE, SIDE), "smooth")
    measured = with_limits(scan, SETTINGS)
    long = measured.__class__(scan, 0.0, True, shortest_wave_nm=60.0)
    assert trusted_map(clean(scan, SETTINGS), long).high == pytest.approx(2 * np.pi / 60.0)


@pytest.mark.skipif(not STAND_IN.is_file(), reason="made cases are not shipped")
def test_the_smoothed_stand_in_is_trusted_to_a_fifth():
    film = asp.Film([STAND_IN])
    (scan,) = film.description["scans"]
    assert scan["limit"] == "filter"
    assert 0.14 < scan["trusted_high"] < 0.25
