"""Elastic constants with ions clamped and relaxed: exact for Keating's diamond, converging for a glass."""

from pathlib import Path

import numpy as np
import pytest
from ase.build import bulk
from ase.calculators.calculator import Calculator, all_changes
from ase.neighborlist import neighbor_list

from atomistic.constants import EV_PER_A3_IN_GPA
from atomistic.elastic.networks import crystal, tersoff_calculator
from atomistic.elastic.relaxation import relax_cell, spring_hessian
from atomistic.elastic.response import elastic_response, internal_strain
from atomistic.elastic.tensor import isotropic
from atomistic.errors import InputError
from atomistic.materials import load_material

NITRIDE = load_material(Path(__file__).parents[3] / "config" / "materials" / "silicon_nitride.yaml")
EDGE_A = 5.43


class Keating(Calculator):
    """Keating's springs of diamond, Phys. Rev. 145, 637 (1966), eq. 14; alpha, beta in eV/Å²."""

    implemented_properties = ["energy", "forces", "stress"]  # noqa: RUF012

    def __init__(self, alpha, beta):
        super().__init__()
        self.alpha, self.beta = alpha, beta

    def calculate(self, atoms=None, properties=("energy",), system_changes=all_changes):
        super().calculate(atoms, properties, system_changes)
        assert atoms is not None
        bonds: dict[int, list] = {}
        for i, j, vector in zip(*neighbor_list("ijD", atoms, 2.8), strict=True):
            bonds.setdefault(i, []).append((j, vector))
        r2 = 3 / 16 * EDGE_A**2
        energy, forces, virial = 0.0, np.zeros((len(atoms), 3)), np.zeros((3, 3))
        for i, around in bonds.items():
            for n, (j, a) in enumerate(around):
                for m, (k, b) in enumerate(around[: n + 1]):
                    same = m == n
                    # each bond is met from both of its ends
                    spring = 3 / 16 * self.alpha / r2 if same else 3 / 8 * self.beta / r2
                    off = a @ b - (r2 if same else -r2 / 3)
                    energy += spring * off**2
                    on_a, on_b = 2 * spring * off * b, 2 * spring * off * a
                    forces[j] -= on_a
                    forces[k] -= on_b
                    forces[i] += on_a + on_b
                    virial += np.outer(on_a, a) + np.outer(on_b, b)
        virial = (virial + virial.T) / 2 / atoms.get_volume()
        self.results = {
            "energy": energy,
            "forces": forces,
            "stress": virial[[0, 1, 2, 1, 0, 0], [0, 1, 2, 2, 2, 1]],
        }


def diamond(alpha=3.0, beta=0.9):
    atoms = bulk("Si", "diamond", EDGE_A, cubic=True)
    atoms.calc = Keating(alpha, beta)
    return atoms


def test_the_calculator_of_this_test_is_consistent():
    atoms = diamond()
    atoms.rattle(0.05, seed=1)
    forces, stress, volume = atoms.get_forces(), atoms.get_stress(), atoms.get_volume()
    step = 1e-5
    energies = []
    for sign in (1, -1):
        moved = atoms.copy()
        moved.positions[3, 1] += sign * step
        moved.calc = Keating(3.0, 0.9)
        strained = atoms.copy()
        shear = np.eye(3)
        shear[0, 1] = shear[1, 0] = sign * step / 2
        strained.set_cell(atoms.cell.array @ shear, scale_atoms=True)
        strained.calc = Keating(3.0, 0.9)
        energies.append((moved.get_potential_energy(), strained.get_potential_energy()))
    slopes = (np.array(energies[0]) - energies[1]) / (2 * step)
    assert forces[3, 1] == pytest.approx(-slopes[0], rel=1e-6)
    assert stress[5] * volume == pytest.approx(slopes[1], rel=1e-6)


@pytest.mark.parametrize("beta", [0.9, 2.0])
def test_keating_diamond_has_the_constants_of_keating(beta):
    """C11, C12 and the relaxed and clamped C44 in closed form (Keating's eqs 9, 10), from unconstrained strains."""
    alpha = 3.0
    atoms = diamond(alpha, beta)
    constants = elastic_response(atoms, (atoms.calc, atoms.calc), 10 * np.eye(24), 2e-3, 0.01, 3, 0.01)
    a = EDGE_A / EV_PER_A3_IN_GPA
    C11, C12 = (alpha + 3 * beta) / a, (alpha - beta) / a
    C44 = 4 * alpha * beta / (alpha + beta) / a
    clamped = (alpha + beta) / a
    expected = np.diag([C11, C11, C11, C44, C44, C44])
    expected[:3, :3] += C12 * (1 - np.eye(3))
    assert np.allclose(constants.relaxed, expected, atol=0.02)
    assert np.allclose(np.diag(constants.clamped.C)[3:], clamped, atol=0.02)
    assert constants.clamped.error.max() < 1e-6  # no symmetry was assumed
    assert constants.calculations == 1 + 12 + 2 * 3  # one displacement for each shear; the rest does not move the ions


class Offset(Keating):
    """Keating's springs on a mesh that pushes and presses by itself."""

    def __init__(self, sign):
        super().__init__(3.0, 0.9)
        self.sign = sign

    def calculate(self, atoms=None, properties=("energy",), system_changes=all_changes):
        super().calculate(atoms, properties, system_changes)
        self.results["forces"] += self.sign * 0.3 * np.cos(np.arange(24)).reshape(8, 3)
        self.results["stress"] += self.sign * 0.02 * np.arange(1, 7)


def test_two_meshes_that_err_to_opposite_sides_give_the_constants_of_neither_erring():
    atoms = diamond()
    either, both = (
        elastic_response(atoms, sides, 10 * np.eye(24), 2e-3, 0.01, 3, 0.01)
        for sides in ((atoms.calc, atoms.calc), (Offset(1), Offset(-1)))
    )
    # a pressure moves the second Piola–Kirchhoff stress of either sign alike
    assert np.allclose(both.clamped.C, either.clamped.C, atol=0.02)
    assert np.allclose(both.relaxed, either.relaxed, atol=0.02)
    assert both.calculations == either.calculations + 1


def test_isotropic_moduli_do_not_depend_on_how_a_crystal_is_turned():
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    turn *= np.linalg.det(turn)
    straight, turned = diamond(), diamond()
    turned.set_cell(turned.cell.array @ turn, scale_atoms=True)
    means = [
        isotropic(elastic_response(atoms, (atoms.calc, atoms.calc), 10 * np.eye(24), 2e-3, 0.01, 8, 0.01).relaxed)
        for atoms in (straight, turned)
    ]
    assert pytest.approx(means[0].G, rel=1e-3) == means[1].G
    assert pytest.approx(means[0].B, rel=1e-3) == means[1].B


def test_keating_constants_do_not_depend_on_the_size_of_the_strain():
    """Keating's energy is quadratic in the Green–Lagrange strain, so finite strains must leave no error at all."""
    atoms = diamond()
    constants = [
        elastic_response(atoms, (atoms.calc, atoms.calc), 10 * np.eye(24), size, 0.01, 3, 0.01)
        for size in (0.02, 0.001)
    ]
    assert np.allclose(constants[0].clamped.C, constants[1].clamped.C, rtol=1e-6, atol=1e-6)


@pytest.fixture(scope="module")
def nitride():
    """β-Si3N4 under the cheap potential, cell and ions relaxed."""
    atoms = crystal(NITRIDE, "beta")
    atoms.calc = tersoff_calculator(NITRIDE.part("network_glass").tersoff)
    rest = relax_cell(atoms, 1e-3, 200)
    assert rest.converged
    return atoms, rest.hessian_eV_A2


def test_a_relaxed_cell_has_no_stress_left(nitride):
    assert abs(nitride[0].get_stress() * EV_PER_A3_IN_GPA).max() < 0.05


def test_hexagonal_symmetry_is_found_not_assumed(nitride):
    atoms, hessian = nitride
    C = elastic_response(atoms, (atoms.calc, atoms.calc), hessian, 2e-3, 0.01, 6, 0.05).relaxed
    assert C[0, 0] == pytest.approx(C[1, 1], rel=2e-3)
    assert C[5, 5] == pytest.approx((C[0, 0] - C[0, 1]) / 2, rel=5e-3)
    assert C[3, 3] == pytest.approx(C[4, 4], rel=2e-3)
    assert abs(C[:3, 3:]).max() < 0.5


def test_gain_of_the_ions_closes_in_on_the_exact_one_and_most_of_what_is_left_is_estimated():
    rng = np.random.default_rng(2)
    size = 30
    modes = np.linalg.qr(rng.normal(size=(size, size)))[0]
    K = modes @ np.diag(rng.uniform(2, 60, size)) @ modes.T
    rigid = np.tile(np.eye(3), (size // 3, 1)) / np.sqrt(size / 3)
    free = np.eye(size) - rigid @ rigid.T
    K = free @ K @ free
    slope = free @ rng.normal(size=(size, 6))
    exact = slope.T @ np.linalg.pinv(K) @ slope
    gains = [internal_strain(slope, lambda w: K @ w, 25 * np.eye(size), n, 1e-9) for n in (1, 2, 3, 9)]
    errors = [np.linalg.eigvalsh(exact - (gain.softening_eV - gain.left_eV)) for gain in gains]
    assert all(error[0] > -1e-9 for error in errors)  # what is measured is a lower bound
    assert errors[0][-1] > errors[1][-1] > errors[2][-1]
    errors = [abs(np.diag(exact - gain.softening_eV)) for gain in gains]
    assert all(np.all(error <= np.diag(gain.left_eV) + 1e-9) for error, gain in zip(errors, gains, strict=True))
    assert errors[0].max() > errors[1].max() > errors[2].max()
    assert np.allclose(gains[-1].softening_eV, exact, rtol=1e-6)


def test_a_saddle_is_refused():
    K = np.diag([5.0, 5, 5, 5, 5, -5])
    slope = np.zeros((6, 6))
    slope[:, 0] = [1, 2, 3, -1, -2, -3]
    with pytest.raises(InputError, match="saddle"):
        internal_strain(slope, lambda w: K @ w - 4 * w, 10 * np.eye(6), 3, 1e-6)


def test_bonds_stretched_beyond_their_inflection_are_a_saddle():
    cell = crystal(NITRIDE, "beta", (1, 1, 1))
    stretched = cell.copy()
    stretched.set_cell(cell.cell.array * 1.2, scale_atoms=True)
    calculator = tersoff_calculator(NITRIDE.part("network_glass").tersoff)
    with pytest.raises(InputError, match="saddle"):
        elastic_response(stretched, (calculator, calculator), spring_hessian(cell), 2e-3, 0.01, 3, 0.01)


def test_a_calculator_without_stress_is_refused_before_anything_is_computed():
    class Blind(Calculator):
        implemented_properties = ["energy", "forces"]  # noqa: RUF012

    with pytest.raises(InputError, match="Blind gives no stress"):
        elastic_response(diamond(), (Blind(), Blind()), np.eye(24), 0.005, 0.01, 3, 1.0)


def test_springs_of_bonds_are_a_hessian_good_enough_for_three_rounds(nitride):
    atoms, _ = nitride
    rough = elastic_response(atoms, (atoms.calc, atoms.calc), spring_hessian(atoms), 2e-3, 0.01, 3, 0.5)
    fine = elastic_response(atoms, (atoms.calc, atoms.calc), spring_hessian(atoms), 2e-3, 0.01, 9, 0.01)
    assert pytest.approx(isotropic(fine.relaxed).G, rel=0.02) == isotropic(rough.relaxed).G
    assert rough.calculations < fine.calculations
