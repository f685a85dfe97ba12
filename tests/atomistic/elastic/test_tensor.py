"""Matrices of elastic constants: strains, fit, averages; against closed forms."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from atomistic.elastic.tensor import (
    deformation,
    fit_stiffness,
    green_lagrange,
    isotropic,
    strain_states,
)
from atomistic.errors import InputError


def cubic(C11, C12, C44):
    C = np.diag([C11, C11, C11, C44, C44, C44]).astype(float)
    C[:3, :3] += C12 * (1 - np.eye(3))
    return C


def turned(C, seed):
    """C of the same crystal, turned at random: by Voigt's matrix of a rotation of stresses."""
    R = Rotation.random(random_state=seed).as_matrix()
    pairs = ((0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1))
    full = np.zeros((3, 3, 3, 3))
    for i, (a, b) in enumerate(pairs):
        for j, (c, d) in enumerate(pairs):
            for x, y in ((a, b), (b, a)):
                full[x, y, c, d] = full[x, y, d, c] = C[i, j]
    full = np.einsum("ai,bj,ck,dl,ijkl->abcd", R, R, R, R, full)
    return np.array([[full[a, b, c, d] for c, d in pairs] for a, b in pairs])


def test_a_strain_is_small_next_to_one_and_doubles_its_shears():
    assert np.allclose(deformation(np.zeros(6)), np.eye(3))
    small = 1e-6 * np.arange(1, 7)
    assert np.allclose(green_lagrange(small), small, rtol=1e-5)


def test_averages_of_silicon_are_those_of_the_closed_form_whichever_way_it_is_turned():
    C11, C12, C44 = 165.7, 63.9, 79.6
    for C in (cubic(C11, C12, C44), turned(cubic(C11, C12, C44), 3)):
        mean = isotropic(C)
        voigt = (C11 - C12 + 3 * C44) / 5
        reuss = 5 * (C11 - C12) * C44 / (4 * C44 + 3 * (C11 - C12))
        assert pytest.approx((C11 + 2 * C12) / 3) == mean.B
        assert mean.B_error == pytest.approx(0, abs=1e-9)
        assert (mean.G, mean.G_error) == pytest.approx(((voigt + reuss) / 2, (voigt - reuss) / 2))
        assert 3 * mean.B * (1 - 2 * mean.nu) == pytest.approx(mean.E)
        assert 2 * mean.G * (1 + mean.nu) == pytest.approx(mean.E)


def test_an_isotropic_body_has_no_distance_between_its_bounds():
    mean = isotropic(cubic(100.0, 40.0, 30.0))
    assert (mean.B, mean.G, mean.B_error, mean.G_error) == pytest.approx((60, 30, 0, 0))


def test_a_structure_that_gains_energy_by_straining_is_refused_and_the_strain_named():
    with pytest.raises(InputError, match=r"eigenvalue -5 GPa along strain .*unstable"):
        isotropic(cubic(100.0, 40.0, -5.0))


def test_all_constants_come_back_from_stresses_of_a_hyperelastic_body():
    """The body's Piola–Kirchhoff stress is linear in the Green–Lagrange strain: then the fit must be exact."""
    rng = np.random.default_rng(1)
    A = rng.normal(size=(6, 6))
    C = A @ A.T + 50 * np.eye(6)
    prestress = rng.normal(size=6)
    states = strain_states(0.01)
    stresses = []
    for state in states:
        xx, yy, zz, yz, xz, xy = prestress + C @ green_lagrange(state)
        F = deformation(state)
        cauchy = F @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ F.T / np.linalg.det(F)
        stresses.append(cauchy[[0, 1, 2, 1, 0, 0], [0, 1, 2, 2, 2, 1]])
    fit = fit_stiffness(states, np.array(stresses))
    assert np.allclose(fit.C, C, rtol=1e-9)
    assert np.allclose(fit.stress, prestress, rtol=1e-6, atol=1e-9)
    assert fit.error.max() < 1e-9


def test_too_few_strains_and_too_large_ones_are_refused():
    states = strain_states(0.005)
    with pytest.raises(InputError, match="6 of 7 unknowns"):
        fit_stiffness(states[:-2], np.zeros((10, 6)))
    for size in (0.0, -0.01, 0.05):
        with pytest.raises(InputError, match=r"at most 0\.03"):
            strain_states(size)
