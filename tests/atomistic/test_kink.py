"""The detector of a change of slope: false alarms and misses at the noise of the closing runs.

Residuals of the runs about their best hinge: 0.2 to 0.4 GPa, neighbour correlation 0.1 to 0.6, 15 to 20
averages in the window.
"""

import numpy as np
import pytest

from atomistic.kink import find_kink

LENGTH = np.linspace(1.75, 3.6, 18)


def noise(rng, sigma, correlation):
    shocks = rng.normal(0, sigma * np.sqrt(1 - correlation**2), len(LENGTH))
    values = np.empty(len(LENGTH))
    values[0] = rng.normal(0, sigma)
    for k in range(1, len(values)):
        values[k] = correlation * values[k - 1] + shocks[k]
    return values


@pytest.mark.parametrize(("sigma", "correlation"), [(0.3, 0.0), (0.3, 0.4)])
def test_false_alarms_on_straight_curves(sigma, correlation):
    """At most 5 %; 200 curves, so the bound is that plus two standard errors."""
    rng = np.random.default_rng(3)
    found = [find_kink(LENGTH, 4 * LENGTH - 2 + noise(rng, sigma, correlation), 4, seed=k) for k in range(200)]
    assert np.mean([kink is not None for kink in found]) <= 0.05 + 2 * np.sqrt(0.05 * 0.95 / 200)


def test_gentle_bend_of_an_elastic_curve_is_no_kink():
    """Stress ~ length^0.7 bends but never flattens: its slope never drops to half."""
    rng = np.random.default_rng(4)
    found = [find_kink(LENGTH, 4 * LENGTH**0.7 + noise(rng, 0.3, 0.4), 4, seed=k) for k in range(100)]
    assert np.mean([kink is not None for kink in found]) <= 0.05 + 2 * np.sqrt(0.05 * 0.95 / 100)


@pytest.mark.parametrize(("sigma", "correlation"), [(0.2, 0.2), (0.35, 0.4)])
def test_finds_real_kinks(sigma, correlation):
    """At least 80 % found and within 15 % of the true stress."""
    rng = np.random.default_rng(5)
    true_stress, good, trials = 10.5, 0, 60
    for k in range(trials):
        clean = true_stress + np.where(LENGTH < 2.6, 7.5, 0.5) * (LENGTH - 2.6)
        kink = find_kink(LENGTH, clean + noise(rng, sigma, correlation), 4, seed=k)
        good += kink is not None and abs(kink.y / true_stress - 1) < 0.15
    assert good >= 0.8 * trials


def test_too_few_points_or_a_falling_curve_give_nothing():
    assert find_kink(LENGTH[:7], LENGTH[:7], 4) is None
    assert find_kink(LENGTH, 20 - 4 * LENGTH, 4) is None


def test_location_and_slopes_without_noise():
    clean = 10 + np.where(LENGTH < 2.6, 6.0, 0.2) * (LENGTH - 2.6)
    kink = find_kink(LENGTH, clean + 1e-3 * np.sin(40 * LENGTH), 4)
    assert kink is not None
    assert kink.x == pytest.approx(2.6, abs=0.05)
    assert kink.y == pytest.approx(10, rel=0.02)
    assert kink.slope_before == pytest.approx(6, rel=0.05)
