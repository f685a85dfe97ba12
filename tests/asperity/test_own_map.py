"""A map of one's own: its roughness in numbers, and its closing and opening."""

import warnings

import numpy as np
import pytest

import asperity as asp

SIDE_NM = 1000.0
X = np.arange(128) * SIDE_NM / 128
WAVE_PER_NM = 2.0 * np.pi * 2 / SIDE_NM
WAVES = 5.0 * np.cos(WAVE_PER_NM * X)[:, None] * np.ones(128)


def test_the_roughness_of_a_sinusoid_is_that_of_its_amplitude():
    found = asp.roughness(WAVES, SIDE_NM, periodic=True)
    rms_nm = 5.0 / np.sqrt(2.0)
    assert found.rms_nm == pytest.approx(rms_nm, rel=1e-9)
    assert found.rms_slope == pytest.approx(rms_nm * WAVE_PER_NM, rel=2e-3)
    assert found.rms_curvature_per_nm == pytest.approx(0.5 * rms_nm * WAVE_PER_NM**2, rel=2e-3)
    peak = found.wave_vector_per_nm[np.argmax(found.psd_nm4)]
    assert peak == pytest.approx(WAVE_PER_NM, rel=0.3)


@pytest.mark.parametrize(
    ("heights", "side_nm"),
    [(np.full((8, 8), np.nan), 100.0), (WAVES, -1.0), (WAVES, "long"), (WAVES[0], SIDE_NM)],
)
def test_no_map_is_refused(heights, side_nm):
    with pytest.raises(asp.InputError):
        asp.roughness(heights, side_nm)


def test_a_side_in_micrometres_is_remarked():
    with pytest.warns(UserWarning, match="side_nm = 1: .* is this one in um"):
        asp.roughness(WAVES, SIDE_NM / 1000.0)
    with pytest.warns(UserWarning, match="side_nm = 10: .* RMS height"):
        asp.roughness(WAVES, 10.0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        asp.roughness(WAVES, SIDE_NM)


def test_a_cycle_is_that_of_the_library_with_the_same_numbers():
    surface = asp.random_surface(
        asp.ContactInputs(0.1, 90.0, 2.0, 8.0, 0.02, 0.8, 5.0), asp.ContactSettings(pixels=128), 3
    )
    mine = asp.cycle(
        -surface, SIDE_NM, 2000.0, 90.0, h_macro=2.0, h_prime=8.0, hamaker=0.1, gap_cutoff_nm=0.2
    )
    settings = asp.ContactSettings(mechanics="coupled", pixels=128, gap_cutoff_nm=0.2)
    inputs = asp.ContactInputs(0.1, 90.0, 2.0, 8.0, 0.02, 0.8, 5.0)
    of_library = asp.run_cycle(
        inputs, settings, 1, 2000.0, heights=surface, length_nm=SIDE_NM, contact_at="lowest"
    )
    assert mine.converged
    np.testing.assert_array_equal(mine.opening.net_nN, of_library.opening.net_nN)
    assert mine.opening.net_nN.min() < 0.0  # it pulls


def test_an_elastic_cycle_goes_back_the_way_it_came():
    """And at its load it is what `press` finds without the way there."""
    cycle = asp.cycle(WAVES, SIDE_NM, 500.0, 90.0)
    pressed = asp.press(WAVES, SIDE_NM, [500.0], 90.0)
    assert cycle.closing.separation_nm[-1] == pytest.approx(pressed.separation_nm[0], abs=1e-3)
    lost_aJ, _ = asp.dissipated_energy(cycle)
    assert lost_aJ == pytest.approx(0.0, abs=1e-6)


def test_lengths_along_x_and_y_and_a_second_map_are_taken_as_press_does():
    """The two surfaces of half the waves are the one of both."""
    alone = asp.cycle(WAVES, SIDE_NM, 500.0, 90.0)
    two = asp.cycle(WAVES / 2, (SIDE_NM, SIDE_NM), 500.0, 90.0, counterface=WAVES[::-1] / 2)
    np.testing.assert_allclose(two.closing.net_nN, alone.closing.net_nN, rtol=1e-9)
    with pytest.raises(asp.InputError, match="must be squares"):
        asp.cycle(WAVES, (SIDE_NM, 2 * SIDE_NM), 500.0, 90.0)


@pytest.mark.parametrize(
    "material", [{"h_prime": 8.0}, {"h_macro": 0.0}, {"hamaker": -1.0}, {"contact_at": "middle"}]
)
def test_no_material_is_refused(material):
    with pytest.raises(asp.InputError):
        asp.cycle(WAVES, SIDE_NM, 500.0, 90.0, **material)


def test_a_notebook_shows_lines_and_a_small_picture():
    page = asp.roughness(WAVES, SIDE_NM)._repr_html_()
    assert page.startswith("<pre>Roughness")
    assert 'src="data:image/png;base64,' in page
    assert asp.cycle(WAVES, SIDE_NM, 500.0, 90.0).plot().axes[1].get_ylabel() == "in contact (%)"
