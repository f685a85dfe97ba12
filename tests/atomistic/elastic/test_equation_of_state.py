"""Equations of state: exact curves come back. Those that cannot be trusted are hard cases
(test_stability.py).
"""

import numpy as np
import pytest

from atomistic.constants import EV_PER_A3_IN_GPA
from atomistic.elastic.equation_of_state import fit_equation_of_state, vinet

VOLUMES = np.linspace(270, 330, 7)


def birch_murnaghan(volume, V0, E0, B, B_prime):
    """E(V) in eV; B in eV/Å³."""
    x = (V0 / np.asarray(volume)) ** (2 / 3)
    return E0 + 9 / 16 * V0 * B * ((x - 1) ** 3 * B_prime + (x - 1) ** 2 * (6 - 4 * x))


def test_birch_murnaghan_curve_comes_back_exactly():
    fit = fit_equation_of_state(
        VOLUMES, birch_murnaghan(VOLUMES, 300, -5000, 235 / EV_PER_A3_IN_GPA, 4.2)
    )
    assert not fit.flags
    assert (fit.V0_A3, fit.B_GPa, fit.B_prime) == pytest.approx((300, 235, 4.2), rel=1e-8)


def test_vinet_curve_gives_the_same_modulus_within_the_difference_of_the_forms():
    fit = fit_equation_of_state(VOLUMES, vinet(VOLUMES, 300, -5000, 235 / EV_PER_A3_IN_GPA, 4.2))
    assert fit.B_vinet_GPa == pytest.approx(235, rel=1e-6)
    assert fit.B_GPa == pytest.approx(235, rel=0.005)


def test_error_of_the_modulus_is_its_scatter_when_energies_scatter():
    rng = np.random.default_rng(1)
    energies = birch_murnaghan(VOLUMES, 300, -5000, 235 / EV_PER_A3_IN_GPA, 4.2)
    fits = [
        fit_equation_of_state(VOLUMES, energies + 0.003 * rng.standard_normal(len(VOLUMES)))
        for _ in range(300)
    ]
    scatter = np.std([fit.B_GPa for fit in fits])
    assert scatter == pytest.approx(np.sqrt(np.mean([fit.B_error_GPa**2 for fit in fits])), rel=0.1)
