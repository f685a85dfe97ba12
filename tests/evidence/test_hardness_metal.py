"""Titanium's potential beside another code, and its crystal."""

import numpy as np
import pytest

from atomistic.hardness.metal import PLACES, crystal
from evidence.hardness.metal import lattice_energy, square_crystal, titanium


@pytest.fixture(scope="module")
def metal():
    return titanium()


def test_another_code_reads_the_file_and_finds_the_energy_of_the_sum(metal, tmp_path):
    """ASE's embedded-atom calculator; both sum over all neighbours."""
    eam = pytest.importorskip("ase.calculators.eam")
    from ase import Atoms

    (tmp_path / "ti.eam.alloy").write_text(metal.tables()["metal.eam"])
    cell = np.array([2.93, 5.10, 4.80])  # away from rest
    atoms = Atoms("Ti4", scaled_positions=PLACES, cell=cell, pbc=True).repeat((3, 2, 2))
    atoms.calc = eam.EAM(potential=str(tmp_path / "ti.eam.alloy"))
    energy = lattice_energy(metal.eam, np.diag(cell), PLACES)
    assert atoms.get_potential_energy() / len(atoms) == pytest.approx(energy, abs=1e-6)


def test_a_square_crystal_is_hardly_strained(metal):
    free, square = (
        crystal(metal, (19, 11, 4)),
        square_crystal(metal, 56.0, 4 * metal.eam.lattice_A[1]),
    )
    assert len(square) == len(free)
    assert square.cell_A[0] == square.cell_A[1]
    np.testing.assert_allclose(square.cell_A, 1.0043 * free.cell_A, rtol=5e-3)
    with pytest.raises(ValueError, match=r"28\.0 A: no crystal of a square section"):
        square_crystal(metal, 28.0, 20.0)
