"""Error of a closing against run time: what is known of made-up closings, and a real one of some
hundred atoms.
"""

import numpy as np
import pytest

from atomistic.constants import EV_PER_A3_IN_GPA
from atomistic.hardness import accuracy
from atomistic.hardness.accuracy import Choice, SmallClosings, at_depth, lowered, variations
from atomistic.hardness.glass import make_glass
from atomistic.hardness.readout import Sample
from atomistic.lammps import Atoms
from atomistic.settings import AsperitySettings, ClosingSettings, GlassSettings

CLOSING = ClosingSettings(base_nm=1, speed_m_s=100, anneal_ps=0.4)
ASPERITY = AsperitySettings(name="tiny", tiles=2, amplitude_nm=0.3)


@pytest.fixture(scope="module")
def closings(potential, oxides, tmp_path_factory):
    work = tmp_path_factory.mktemp("study")
    settings = GlassSettings(atoms=150, melt_ps=1, quench_rate_K_ps=1000, rest_ps=0.5)
    glass = make_glass(oxides["SiO2"], potential, settings, 1, work / "glass")
    return SmallClosings(ASPERITY, glass, potential, CLOSING, work)


@pytest.fixture
def made_up(closings, monkeypatch):
    """Pressure and force grow by 2 % when the speed doubles from the scene's, and so on in
    proportion.
    """

    def outputs(choice):
        factor = 1 + 0.02 * choice.speed + 0.1 * (1 - choice.base)
        return factor * np.array([[8.0, 20.0], [9.0, 25.0]])

    monkeypatch.setattr(closings, "outputs", outputs)
    monkeypatch.setattr(closings, "cpu_s", lambda choice: 1.0 / choice.speed)
    monkeypatch.setattr(closings, "noise_percent", lambda: np.array([3.0, 2.0]))
    return closings


def deviations_of(closings, name):
    [found] = [variation for variation in variations(closings) if variation.name == name]
    return {value: compute() for value, compute in found.values}, found.shipped


def test_the_error_of_a_speed_is_against_rest(made_up):
    by_speed, shipped = deviations_of(made_up, "closing speed, m/s")
    assert list(by_speed) == [400, 200, 100]
    assert shipped == 100
    for speed, off in by_speed.items():
        assert off.values == pytest.approx(np.full((2, 2), 2.0 * speed / 100))
    # 2 q(v) - q(2v) has the noise of both runs
    assert by_speed[100].noise == pytest.approx(np.array([3.0, 2.0]) * np.sqrt(2) / np.sqrt(2))
    assert np.all(by_speed[200].noise > by_speed[100].noise)


def test_the_error_of_a_base_is_against_a_thicker_one(made_up):
    by_base, shipped = deviations_of(made_up, "base, nm")
    assert shipped == max(by_base)
    thick, usual = 1.08 - 0.05, 1.08
    assert by_base[shipped].values == pytest.approx(np.full((2, 2), 100 * (usual / thick - 1)))


def test_a_body_lowered_keeps_its_top_and_its_charge():
    rng = np.random.default_rng(0)
    types = rng.permutation(np.repeat([1, 2], [100, 200]))
    body = Atoms(
        ("Si", "O"),
        types,
        rng.uniform(0, 20, (300, 3)),
        np.full(3, 20.0),
        rng.normal(size=(300, 3)),
    )
    lower = lowered(body, 8.0, np.array([1, 2]))
    assert lower.count("O") == 2 * lower.count("Si") > 0
    assert lower.positions_A[:, 2].min() >= 0
    assert lower.positions_A[:, 2].max() == pytest.approx(body.positions_A[:, 2].max() - 8.0)
    assert lower.velocities_A_ps is not None
    assert len(lower.velocities_A_ps) == len(lower)


@pytest.mark.parametrize("count", [20, 57])
def test_pressure_at_depth_does_not_depend_on_how_often_it_was_measured(count):
    """A spring on a contact that grows in proportion: its pressure is constant."""
    heights = np.linspace(50.2, 45.9, count)
    depth = np.maximum(0, 50.0 - heights)
    samples = [
        Sample(np.array([z, 3.0 * d, 300.0]), 60.0 * d, np.empty((0, 2)))
        for z, d in zip(heights, depth, strict=True)
    ]
    pressure_GPa, force_nN = at_depth(samples, 50.0, 4.0)
    assert pressure_GPa == pytest.approx(3.0 / 60.0 * EV_PER_A3_IN_GPA)
    # a quarter of 4 Å, at its end
    assert force_nN == pytest.approx(3.0 * 3.5 * EV_PER_A3_IN_GPA / 100, rel=1e-3)


def test_a_real_closing_is_repeated_to_the_last_bit_and_presses(closings):
    first = closings.pressed(1, Choice())
    assert first.force_nN > 0
    assert first.pressure_GPa > 0
    assert first.cpu_s > 0
    again = SmallClosings(
        ASPERITY, closings.glass, closings.potential, CLOSING, closings.work / "again"
    )
    assert again.pressed(1, Choice()).force_nN == first.force_nN
    assert closings.pressed(1, Choice(reversed_velocities=True)).force_nN != first.force_nN


def test_more_steps_of_the_minimiser_change_the_attraction_little(closings):
    few, many = (
        closings.cutoff_nm(1, iterations)[0] for iterations in (accuracy.ITERATIONS[-1], 600)
    )
    assert few == pytest.approx(many, rel=0.05)
    assert 0.1 < many < 1.0
