"""Line profiles: read with their units, levelled, and refused in one line where they say
nothing.
"""

import numpy as np
import pytest

from mesoscale.errors import InputError
from mesoscale.settings import InstrumentSettings, TopographySettings
from mesoscale.topography.measurements.loading import load_measurements
from mesoscale.topography.measurements.profiles import Profile, clean_profile, profile_of

X = np.arange(500) * 2.0
Z = np.random.default_rng(0).standard_normal(500).cumsum()


def written(path, head="", factor=1.0, x=X, z=Z):
    np.savetxt(
        path, np.stack([x * factor, z * factor], axis=1), header=head, comments="", delimiter="\t"
    )
    return path


@pytest.mark.parametrize(
    ("head", "factor"), [("x (nm)\tz (nm)", 1.0), ("x/um\tz/um", 1e-3), ("x [mm]\tz [mm]", 1e-6)]
)
def test_units_in_the_heads_of_columns_are_read(tmp_path, head, factor):
    (result,) = load_measurements(written(tmp_path / "line.txt", head, factor))
    assert isinstance(result.data, Profile)
    assert result.data.length_nm == pytest.approx(1000.0, rel=1e-6)
    assert result.data.heights_nm == pytest.approx(Z, abs=1e-6)


def test_a_profile_without_unit_is_refused_unless_the_scene_states_one(tmp_path):
    path = written(tmp_path / "line.txt", factor=1e-3)
    with pytest.raises(
        InputError, match=r"profile without length unit; state it in topography\.instruments"
    ) as caught:
        load_measurements(path)
    assert "\n" not in str(caught.value)
    settings = TopographySettings(
        instruments=(InstrumentSettings(files="line*", unit="um", tip_radius_nm=2000),)
    )
    (result,) = load_measurements(path, settings=settings)
    assert result.data.rms_nm == pytest.approx(Z.std(), rel=1e-5)
    assert (result.tip_radius_nm, result.radius_stated) == (2000, True)


def test_the_default_tip_is_not_taken_for_a_stylus_without_a_word(tmp_path):
    (result,) = load_measurements(written(tmp_path / "line.txt", "x (nm)\tz (nm)"))
    assert not result.radius_stated


def test_uneven_points_are_read_at_even_steps():
    x = np.sort(np.random.default_rng(1).uniform(0, 100, 400))
    profile = profile_of(x, np.sin(x / 10), "uneven")
    assert profile.resampled
    position = x[0] + profile.step_nm * np.arange(400)
    assert profile.heights_nm == pytest.approx(np.sin(position / 10), abs=0.01)


@pytest.mark.parametrize(
    ("x", "z", "words"),
    [
        (X[:20], Z[:20], "a line of 20 points"),
        (np.where(X > 500, X + 400, X), Z, "a hole of"),
        (np.zeros(500), Z, "points"),
    ],
)
def test_lines_that_are_no_profile_are_refused(x, z, words):
    with pytest.raises(InputError, match=words):
        profile_of(x, z, "line")


def test_levelling_takes_a_line_or_a_parabola():
    x = np.linspace(-1, 1, 500)
    wave = np.sin(40 * x)
    tilted = Profile(wave + 30 * x, 1000.0, "tilted")
    bowed = Profile(wave + 30 * x + 20 * x**2, 1000.0, "bowed", bow=True)
    for profile in (tilted, bowed):
        assert clean_profile(profile, TopographySettings()).rms_nm == pytest.approx(
            wave.std(), rel=0.03
        )
    with pytest.raises(InputError, match="all heights are equal"):
        clean_profile(Profile(np.zeros(500), 1000.0, "flat"), TopographySettings())
