import numpy as np
import pytest

from atomistic.hardness.asperity import cut_asperity, formula_of, neutralise, profile, remove_strays
from atomistic.lammps import Atoms


@pytest.fixture
def glass():
    """A structureless cubic cell of silica density and composition."""
    rng = np.random.default_rng(0)
    units = 100
    types = rng.permutation(np.repeat([1, 2], [units, 2 * units]))
    length = (3 * units / 0.066) ** (1 / 3)
    return Atoms(("Si", "O"), types, rng.uniform(0, length, (3 * units, 3)), np.full(3, length))


def test_profile_of_eq_6():
    x = np.linspace(0, 5.8, 117)
    height = profile(x[:, None], x[None, :], 5.8, 0.4)
    assert height.max() == pytest.approx(0.4, abs=1e-3)
    assert height.min() == pytest.approx(-0.4, abs=1e-3)
    peak = np.unravel_index(np.argmax(height), height.shape)
    assert x[peak[0]] == pytest.approx(5.8 / 4, abs=0.06)
    assert np.allclose(height, height.T)


def test_the_mean_height_is_that_of_the_profile():
    x = np.linspace(0, 8, 321)[:-1]
    assert profile(x[:, None], x[None, :], 8.0, 1.2).mean() == pytest.approx(
        1.2 * (-4 / np.pi**2), rel=1e-4
    )


def test_cut_is_neutral_unstrained_and_below_the_profile(glass):
    cut = cut_asperity(glass, tiles=2, amplitude_A=4.0, base_A=20.0, seed=5)
    wavelength = 2 * glass.cell_A[0]
    assert cut.cell_A[0] == wavelength
    assert cut.count("O") == 2 * cut.count("Si")
    x, y, z = cut.positions_A.T
    assert np.all(z < 20 + profile(x, y, wavelength, 4.0))
    zero_level = 20 * wavelength**2 + 4.0 * wavelength**2 * np.mean(
        profile(*np.meshgrid(np.linspace(0, 1, 200), np.linspace(0, 1, 200)), 1.0, 1.0)
    )
    assert len(cut) == pytest.approx(0.066 * zero_level, rel=0.03)


def test_cuts_differ_with_the_seed_and_only_with_it(glass):
    first, again, other = (cut_asperity(glass, 2, 4.0, 20.0, seed) for seed in (5, 5, 6))
    np.testing.assert_array_equal(first.positions_A, again.positions_A)
    assert first.positions_A.shape != other.positions_A.shape or not np.allclose(
        first.positions_A, other.positions_A
    )


def test_strays_go_with_their_charge(glass):
    cut = cut_asperity(glass, 2, 4.0, 20.0, 5)
    positions = cut.positions_A.copy()
    oxygen = np.flatnonzero(cut.types == 2)[:3]
    positions[oxygen, 2] = 36.0
    kept = remove_strays(Atoms(cut.elements, cut.types, positions, cut.cell_A), formula_of(glass))
    assert kept.positions_A[:, 2].max() < 30
    assert kept.count("O") == 2 * kept.count("Si")
    assert len(kept) == len(cut) - 6


def test_surplus_is_taken_from_the_bottom():
    types = np.array([1, 1, 2, 2, 2])
    positions = np.column_stack([np.zeros(5), np.zeros(5), [0.0, 5.0, 1.0, 2.0, 3.0]])
    kept = neutralise(Atoms(("Si", "O"), types, positions, np.ones(3)), np.array([1, 2]))
    assert sorted(kept.positions_A[:, 2]) == [2.0, 3.0, 5.0]
