"""JKR and DMT: their pull-off, their energies, and what they tend to without adhesion."""

import numpy as np
import pytest
from scipy import integrate, optimize

from mesoscale import theory

RADIUS, E_STAR, WORK = 50.0, 20.0, 0.1


def test_the_largest_pull_of_jkr_is_three_halves_pi_w_r():
    def force(contact_radius):
        return theory.jkr_force(contact_radius, RADIUS, E_STAR, WORK)

    least = optimize.minimize_scalar(force, bounds=(0.1, 10.0), method="bounded")
    assert -least.fun == pytest.approx(theory.jkr_pull_off(RADIUS, WORK), rel=1e-7)


def test_force_of_jkr_does_the_work_that_area_and_strain_hold():
    """dE = F d(delta) along the branch, E elastic less w pi a^2, both by the superposition of
    Hertz and a punch: the release rate of energy is w at every contact radius.
    """

    def force(a):
        return theory.jkr_force(a, RADIUS, E_STAR, WORK)

    def approach(a):
        return theory.jkr_indentation(a, RADIUS, E_STAR, WORK)

    def done(a):
        step = 1e-5 * a
        return force(a) * (approach(a + step) - approach(a - step)) / (2 * step)

    def stored(a):
        """Elastic energy: compressed to Hertz's force at this radius, let up by a punch's."""
        hertzian = 4 * E_STAR * a**3 / (3 * RADIUS)
        compressed = 8 * E_STAR * a**5 / (15 * RADIUS**2)
        let_up = (hertzian**2 - force(a) ** 2) / (4 * E_STAR * a)
        return compressed - let_up

    first, last = 3.0, 8.0
    work, _ = integrate.quad(done, first, last)
    gained = stored(last) - stored(first) - WORK * np.pi * (last**2 - first**2)
    assert work == pytest.approx(gained, rel=1e-6)


def test_without_adhesion_both_are_hertz():
    delta = theory.jkr_indentation(5.0, RADIUS, E_STAR, 0.0)
    hertzian = theory.hertz_force(delta, RADIUS, E_STAR)
    assert theory.jkr_force(5.0, RADIUS, E_STAR, 0.0) == pytest.approx(hertzian)
    assert theory.dmt_force(delta, RADIUS, E_STAR, 0.0) == pytest.approx(hertzian)


def test_dmt_without_contact_pulls_with_two_pi_w_r():
    assert theory.dmt_force(0.0, RADIUS, E_STAR, WORK) == -2 * np.pi * WORK * RADIUS


def test_the_parameter_of_tabor_by_hand():
    # R w^2 / (E*^2 z0^3) = 50 * 0.01 / (400 * 0.008) = 0.15625
    assert theory.tabor_parameter(50.0, 20.0, 0.1, 0.2) == pytest.approx(0.15625 ** (1 / 3))
