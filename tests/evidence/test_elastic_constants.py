"""Constants of crystals beside published ones."""

from pathlib import Path

import numpy as np
import pytest

from atomistic.elastic.constants import Measured
from atomistic.elastic.dft import commensurate_mesh
from atomistic.elastic.networks import crystal
from atomistic.elastic.response import Response
from atomistic.elastic.tensor import isotropic, with_symmetry_error
from atomistic.materials import load_material
from evidence.elastic.constants import beside_published, full_matrix

MATERIALS = Path(__file__).parents[2] / "config" / "materials"
BETA = load_material(MATERIALS / "silicon_nitride.yaml").crystals["beta"]
SILICON = load_material(MATERIALS / "silicon.yaml").crystals["silicon"]


def measured(C):
    atoms = crystal(load_material(MATERIALS / "silicon.yaml"), "silicon")
    clamped = with_symmetry_error(1.1 * C, np.zeros(6))
    return Measured(atoms, None, Response(clamped, C, C[0], 1, 1.0), "")


def test_published_moduli_are_those_their_authors_state():
    """B 259 GPa of β-Si3N4 (Vogelgesang et al. 2000); C66 is (C11 - C12)/2."""
    C = full_matrix(BETA.constants["experiment"].values_GPa, "hexagonal")
    assert pytest.approx(259, abs=0.5) == isotropic(C).B
    assert C[5, 5] == pytest.approx(BETA.constants["experiment"].values_GPa["C66"], abs=1)
    cubic = full_matrix(SILICON.constants["experiment"].values_GPa, "cubic")
    assert pytest.approx(97.9, abs=0.2) == isotropic(cubic).B


def test_deviations_and_breaches_of_symmetry_are_measured():
    C = full_matrix(SILICON.constants["GGA"].values_GPa, "cubic") * 1.05
    C[4, 4] += 2
    rows = {(row["published"], row["quantity"]): row for row in beside_published("silicon", measured(C), SILICON)}
    assert rows["GGA", "C11"]["relaxed"] == pytest.approx(1.05 * 153.1)
    assert rows["GGA", "C11"]["clamped"] == pytest.approx(1.1 * 1.05 * 153.1)
    assert rows["GGA", "C11"]["breach"] == pytest.approx(0)
    assert rows["GGA", "C44"]["breach"] == pytest.approx(2)
    assert rows["GGA", "C44"]["relaxed"] == pytest.approx(1.05 * 74.3 + 2 / 3)
    assert rows["GGA", "B"]["relaxed"] == pytest.approx(1.05 * rows["GGA", "B"]["published_value"])
    assert rows["experiment", "C12"]["published_value"] == 63.9


def test_a_crystal_that_failed_has_no_rows():
    failed = measured(np.eye(6))._replace(response=None, failure="SCF not converged")
    assert list(beside_published("beta", failed, BETA)) == []


def test_nitrogen_of_beta_lies_where_its_mesh_ripples_least():
    """Of an odd number of points to each c none lies at its quarter, where the N are."""
    nitride = load_material(MATERIALS / "silicon_nitride.yaml")
    cell = nitride.crystals["beta"].constants_cell
    assert cell
    atoms = crystal(nitride, "beta", cell.supercell)
    assert len(atoms) == 42
    assert commensurate_mesh(atoms.cell.array * 1.03, cell.cutoff_Ha)[2] == 3 * 25
