"""Relaxation of a cell's ions: it ends at rest, soon, and says so when it cannot."""

from pathlib import Path

import numpy as np
import pytest

from atomistic.elastic.networks import crystal
from atomistic.elastic.relaxation import relax_ions, spring_hessian
from atomistic.materials import load_material
from tests.atomistic.cheap_potential import tersoff_calculator

MATERIALS = Path(__file__).parents[3] / "config" / "materials"
NITRIDE = load_material(MATERIALS / "silicon_nitride.yaml")


@pytest.fixture
def shaken():
    """β-Si3N4 with every atom moved by some 0.1 Å, under the cheap potential."""
    beta = crystal(NITRIDE, "beta")
    beta.rattle(0.05, seed=1)
    beta.calc = tersoff_calculator(NITRIDE.part("network_glass").tersoff)
    return beta


def test_springs_hold_atoms_and_feel_no_translation_but_the_floor(shaken):
    hessian = spring_hessian(shaken)
    assert np.allclose(hessian, hessian.T)
    values = np.linalg.eigvalsh(hessian)
    assert values[:3] == pytest.approx(2.0)  # three rigid translations: the floor alone
    assert values[3] > 2.1


def test_ions_come_to_rest_in_few_steps(shaken):
    assert np.linalg.norm(shaken.get_forces(), axis=1).max() > 2
    rest = relax_ions(shaken, 0.2, 15)
    assert rest.converged
    assert rest.force_left_eV_A < 0.2
    assert rest.steps <= 10
