"""Relaxation of a cell's ions: it ends at rest, soon, and says so when it cannot."""

from pathlib import Path

import numpy as np
import pytest
from ase.neighborlist import neighbor_list

from atomistic.elastic.networks import crystal, tersoff_calculator
from atomistic.elastic.relaxation import (
    ALONG_EV_A2,
    BOND_A,
    EDGE_A,
    EDGE_EV_A2,
    cell_scale_A,
    relax_ions,
    spring_hessian,
)
from atomistic.materials import load_material

MATERIALS = Path(__file__).parents[3] / "config" / "materials"
NITRIDE = load_material(MATERIALS / "silicon_nitride.yaml")


@pytest.fixture
def shaken():
    """β-Si3N4 with every atom moved by some 0.1 Å, under the cheap potential."""
    beta = crystal(NITRIDE, "beta")
    beta.rattle(0.05, seed=1)
    beta.calc = tersoff_calculator(NITRIDE.part("network_glass").tersoff)
    return beta


def test_springs_hold_atoms_and_cell_and_feel_no_translation_or_turn_but_the_floor(shaken):
    hessian = spring_hessian(shaken)
    assert np.allclose(hessian, hessian.T)
    values, modes = np.linalg.eigh(hessian)
    assert values[:6] == pytest.approx(2.0)  # three rigid translations, three turns of the cell: the floor alone
    assert values[6] > 3
    cell = modes[-9:, :6].reshape(3, 3, 6)
    assert cell + cell.transpose(1, 0, 2) == pytest.approx(0, abs=1e-6)


def test_a_swelling_cell_stretches_every_spring_by_its_length(shaken):
    swelling = np.vstack([np.zeros((len(shaken), 3)), cell_scale_A(shaken) * np.eye(3)]).ravel()
    bonds = neighbor_list("d", shaken, {("Si", "N"): BOND_A})
    edges = neighbor_list("d", shaken, {("N", "N"): EDGE_A})
    expected = 0.5 * (ALONG_EV_A2 * np.sum(bonds**2) + EDGE_EV_A2 * np.sum(edges**2))  # both lists name a pair twice
    assert swelling @ spring_hessian(shaken) @ swelling == pytest.approx(expected + 2.0 * swelling @ swelling)


def test_ions_come_to_rest_in_few_steps(shaken):
    assert np.linalg.norm(shaken.get_forces(), axis=1).max() > 2
    rest = relax_ions(shaken, 0.2, 15)
    assert rest.converged
    assert rest.force_left_eV_A < 0.2
    assert rest.steps <= 10
