"""Equations of state: exact curves come back, curves that cannot be trusted are flagged or refused."""

import numpy as np
import pytest

from asperity.guards.errors import InputError
from atomistic.constants import EV_PER_A3_IN_GPA
from atomistic.elastic.equation_of_state import fit_equation_of_state, vinet

VOLUMES = np.linspace(270, 330, 7)


def birch_murnaghan(volume, V0, E0, B, B_prime):
    """E(V) in eV; B in eV/Å³."""
    x = (V0 / np.asarray(volume)) ** (2 / 3)
    return E0 + 9 / 16 * V0 * B * ((x - 1) ** 3 * B_prime + (x - 1) ** 2 * (6 - 4 * x))


def test_birch_murnaghan_curve_comes_back_exactly():
    fit = fit_equation_of_state(VOLUMES, birch_murnaghan(VOLUMES, 300, -5000, 235 / EV_PER_A3_IN_GPA, 4.2))
    assert not fit.flags
    assert (fit.V0_A3, fit.B_GPa, fit.B_prime) == pytest.approx((300, 235, 4.2), rel=1e-8)


def test_vinet_curve_gives_the_same_modulus_within_the_difference_of_the_forms():
    fit = fit_equation_of_state(VOLUMES, vinet(VOLUMES, 300, -5000, 235 / EV_PER_A3_IN_GPA, 4.2))
    assert fit.B_vinet_GPa == pytest.approx(235, rel=1e-6)
    assert fit.B_GPa == pytest.approx(235, rel=0.005)


def test_error_of_the_modulus_is_its_scatter_when_energies_scatter():
    rng = np.random.default_rng(1)
    energies = birch_murnaghan(VOLUMES, 300, -5000, 235 / EV_PER_A3_IN_GPA, 4.2)
    fits = [fit_equation_of_state(VOLUMES, energies + 0.003 * rng.standard_normal(len(VOLUMES))) for _ in range(300)]
    scatter = np.std([fit.B_GPa for fit in fits])
    assert scatter == pytest.approx(np.sqrt(np.mean([fit.B_error_GPa**2 for fit in fits])), rel=0.1)


def test_a_modulus_that_energies_do_not_tell_is_flagged():
    noise = np.array([1.0, -2.0, 1.5, 0.5, -1.5, 2.0, -1.0])
    energies = birch_murnaghan(VOLUMES, 300, -5000, 235 / EV_PER_A3_IN_GPA, 4.2)
    sure, unsure = (fit_equation_of_state(VOLUMES, energies + size * noise) for size in (0.01, 0.2))
    assert not any("scatter about" in flag for flag in sure.flags)
    assert any("scatter about" in flag for flag in unsure.flags)
    assert unsure.B_error_GPa > 0.1 * unsure.B_GPa


def test_minimum_outside_the_scan_is_flagged():
    fit = fit_equation_of_state(VOLUMES, birch_murnaghan(VOLUMES, 350, -5000, 1.4, 4.2))
    assert any("outside the scanned" in flag for flag in fit.flags)


def test_curve_without_minimum_gives_no_modulus():
    fit = fit_equation_of_state(VOLUMES, -0.001 * VOLUMES)
    assert fit.flags
    assert np.isnan(fit.B_GPa)


def test_too_few_volumes_are_refused_in_one_line():
    with pytest.raises(InputError, match="at least 5 are needed"):
        fit_equation_of_state(VOLUMES[:4], VOLUMES[:4])
