"""Relaxation of a cell's ions: it ends at rest, soon, and says so when it cannot."""

from pathlib import Path

import numpy as np
import pytest
from ase.calculators.calculator import CalculationFailed

from atomistic.elastic.networks import crystal, tersoff_calculator
from atomistic.elastic.relaxation import bond_hessian, relax_glass, relax_ions
from atomistic.materials import load_material
from atomistic.settings import RelaxationSettings

MATERIALS = Path(__file__).parents[3] / "config" / "materials"
NITRIDE = load_material(MATERIALS / "silicon_nitride.yaml")


@pytest.fixture
def shaken():
    """β-Si3N4 with every atom moved by some 0.1 Å, under the cheap potential."""
    beta = crystal(NITRIDE, "beta")
    beta.rattle(0.05, seed=1)
    beta.calc = tersoff_calculator(NITRIDE.part("network_glass").tersoff)
    return beta


def test_springs_hold_every_atom_and_feel_no_translation_but_the_floor(shaken):
    hessian = bond_hessian(shaken)
    assert np.allclose(hessian, hessian.T)
    assert np.linalg.eigvalsh(hessian).min() == pytest.approx(2.0)  # three rigid translations: the floor alone


def test_ions_come_to_rest_in_few_steps(shaken):
    assert np.linalg.norm(shaken.get_forces(), axis=1).max() > 2
    rest = relax_ions(shaken, 0.2, 15)
    assert rest.converged
    assert rest.force_left_eV_A < 0.2
    assert rest.steps <= 10


def test_forces_left_tell_how_far_below_the_minimum_is(shaken):
    rest = relax_ions(shaken, 0.3, 15)
    above = shaken.get_potential_energy()
    again = relax_ions(shaken, 1e-4, 100, rest.hessian_eV_A2)
    assert above - shaken.get_potential_energy() == pytest.approx(rest.depth_eV, rel=0.3)
    assert again.converged


def test_a_failed_calculation_leaves_the_glass_as_it_was_and_says_why(shaken):
    class Fails(type(shaken.calc)):
        def calculate(self, *args, **kwargs):
            raise CalculationFailed("SCF not converged in 50 cycles")

    atoms, done, hessian = relax_glass(shaken, Fails(shaken.calc.parameters), RelaxationSettings())
    assert np.allclose(atoms.positions, shaken.positions)  # to rounding: the cell is scaled by one
    assert not done.converged
    assert np.array_equal(hessian, bond_hessian(shaken))
    assert "SCF not converged" in done.failure
