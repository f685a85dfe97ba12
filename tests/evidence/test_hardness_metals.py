"""Titanium's potential beside another code, and the bodies made of it."""

from itertools import product
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import KDTree

from atomistic.errors import InputError
from atomistic.materials import load_material
from evidence.hardness import laws
from evidence.hardness.choices import silica_and
from evidence.hardness.metal import titanium
from evidence.hardness.metals import PLACES, TOO_NEAR, crystal, lattice_energy, polycrystal, square_crystal
from evidence.hardness.stack import Stack, calibrated_depth, check_thickness
from evidence.record import ROOT


@pytest.fixture(scope="module")
def metal():
    return titanium()


def test_another_code_reads_the_file_and_finds_the_energy_of_the_sum(metal, tmp_path):
    """ASE's embedded-atom calculator; both sum over all neighbours."""
    eam = pytest.importorskip("ase.calculators.eam")
    from ase import Atoms

    (tmp_path / "ti.eam.alloy").write_text(metal.setfl())
    cell = np.array([2.93, 5.10, 4.80])  # away from rest
    atoms = Atoms("Ti4", scaled_positions=PLACES, cell=cell, pbc=True).repeat((3, 2, 2))
    atoms.calc = eam.EAM(potential=str(tmp_path / "ti.eam.alloy"))
    energy = lattice_energy(metal.eam, np.diag(cell), PLACES)
    assert atoms.get_potential_energy() / len(atoms) == pytest.approx(energy, abs=1e-6)


def test_half_the_energies_are_half_of_every_energy(metal):
    """Lines of embedding and of pairs are halved, those of the density are not."""
    full, half = (np.array(metal.setfl(scale).split("\n", 6)[6].split(), float) for scale in (1.0, 0.5))
    third = len(full) // 3
    np.testing.assert_allclose(half[:third], full[:third] / 2)
    np.testing.assert_allclose(half[third : 2 * third], full[third : 2 * third])
    np.testing.assert_allclose(half[2 * third :], full[2 * third :] / 2)


def test_a_square_crystal_is_hardly_strained(metal):
    free, square = crystal(metal, (19, 11, 4)), square_crystal(metal, 56.0, 4 * metal.eam.lattice_A[1])
    assert len(square) == len(free)
    assert square.cell_A[0] == square.cell_A[1]
    np.testing.assert_allclose(square.cell_A, free.cell_A, rtol=5e-3)
    with pytest.raises(ValueError, match=r"28\.0 A: no crystal of a square section"):
        square_crystal(metal, 28.0, 20.0)


def test_grains_fill_the_cell_and_keep_apart(metal):
    body = polycrystal(metal, 40.0, 35.0, 1)
    assert body.positions_A.min() >= 0
    near = KDTree(body.positions_A, boxsize=body.cell_A).query_pairs(TOO_NEAR * metal.eam.r_A)
    assert not near
    dense = 4 / np.prod([metal.eam.lattice_A[0] ** 2 * np.sqrt(3), metal.eam.lattice_A[1]])
    assert 0.88 < len(body) / 40.0**3 / dense < 1.0  # grain boundaries are dense only after the anneal
    neighbours = KDTree(body.positions_A, boxsize=body.cell_A).query_ball_point(body.positions_A, 3.5)
    assert np.median([len(found) - 1 for found in neighbours]) == 12  # of hexagonal packing


def test_the_bond_of_metal_and_oxide_has_its_depth_and_the_force_of_its_energy(metal):
    stack = Stack(silica_and("pmmcs")[1], metal, 0.28)
    r = np.linspace(1.5, 6.0, 2001)
    energy, force = stack.bond(r)
    assert energy.min() == pytest.approx(-0.28, rel=1e-4)
    np.testing.assert_allclose(force[1:-1], -np.gradient(energy, r)[1:-1], atol=2e-4)
    commands = stack.files(("Ti", "Si", "O"), 1.0)["pairs"].splitlines()
    assert [line for line in commands if line.startswith("pair_coeff")] == [
        "pair_coeff * * eam/alloy metal.eam Ti NULL NULL",
        "pair_coeff 1 2 table cross contact 6.5",
        "pair_coeff 2 2 table table Si_Si 6.5",
        "pair_coeff 2 3 table table Si_O 6.5",
        "pair_coeff 1 3 table cross bond 6.5",
        "pair_coeff 3 3 table table O_O 6.5",
    ]


def test_an_eam_of_a_compound_is_refused(tmp_path):
    text = (ROOT / "config" / "materials" / "titanium.yaml").read_text()
    (tmp_path / "titanium.yaml").write_text(text.replace("formula: {Ti: 1}", "formula: {Ti: 1, O: 2}"))
    with pytest.raises(InputError, match="eam: needs a formula of one element, got TiO2"):
        load_material(tmp_path / "titanium.yaml")
    (tmp_path / "titanium.yaml").write_text(text.replace("  eta: 0.558572\n", ""))
    with pytest.raises(InputError, match=r"eam\.eta: Field required"):
        load_material(Path(tmp_path / "titanium.yaml"))


def stack_rows(seeds=("1", "2"), noise=0.0):
    """Glass 10 and metal 4 GPa, and films between them by k 0.3 and m 1.5, area calibrated at 0.5 A."""
    rng = np.random.default_rng(1)
    where = {"wavelength_nm": "5.6", "bond_eV": "0.28", "metal": "polycrystal"}
    rows = [
        {"case": "flat", "seed": "1", "thickness_nm": "1.2", **where, "quantity": name, "value": value}
        for name, value in (("area_error_mean_depth_0.5_A", "0.02"), ("area_error_mean_depth_1_A", "0.08"))
    ]
    for case, thickness in (("glass", 0.0), ("metal", 0.0), ("film", 0.6), ("film", 1.0), ("film", 2.0)):
        for seed, length in product(seeds, (2.25, 2.75, 3.25, 3.75)):
            share = 1 / (1 + 0.3 * (length / thickness) ** 1.5) if case == "film" else float(case == "glass")
            row = {"case": case, "seed": seed, "thickness_nm": str(thickness), **where}
            stress = (4 + 6 * share) * np.exp(noise * rng.normal())
            rows.append({**row, "quantity": f"stress_{length:g}_nm_GPa", "value": str(stress)})
    return rows


def test_a_made_up_law_is_found_and_foretells_what_is_left_out():
    points = laws.points_of(stack_rows())
    assert points.length_nm.max() == 3.25  # beyond, the contact takes up more than its share of the cell
    np.testing.assert_allclose(laws.fit("film", points), [10, 4, 0.3, 1.5], rtol=1e-5)
    assert laws.left_out("film", points, "point") < 1e-5
    assert laws.left_out("film", points, "thickness") < 1e-5
    assert laws.left_out("constant", points, "thickness") > laws.left_out("constant", points, "point") > 0.05


def test_k_of_other_runs_is_compared_with_that_of_the_same_seeds():
    rows = stack_rows()
    strong = [{**row, "bond_eV": "0.45"} for row in rows if row["thickness_nm"] == "1.0" and row["seed"] == "2"]
    assert laws.changed_k(rows + strong, {"bond_eV": "0.45"}) == pytest.approx(1, rel=1e-4)


def test_a_law_without_runs_in_its_range_is_refused():
    with pytest.raises(InputError, match=r"films on crystal \(0\.28 eV\): 0 points of films between 2 and 3\.5 nm"):
        laws.points_of(stack_rows(), {"metal": "crystal"})


def test_a_film_thinner_than_a_layer_or_thicker_than_the_widest_contact_is_refused():
    check_thickness(0.6, 5.6)
    for thickness in (0.1, 4.0):
        with pytest.raises(InputError, match=r"5\.6 nm, whose widest contact is 3\.5 nm: accepted are 0\.3"):
            check_thickness(thickness, 5.6)


def test_an_ion_without_cross_terms_is_refused(metal):
    with pytest.raises(InputError, match="Ti and N: no cross terms, so that no film of it lies on the metal"):
        Stack(silica_and("pmmcs")[1], metal, 0.28).files(("Ti", "Si", "N"), 1.0)


def test_no_body_takes_the_area_calibrated_on_another(monkeypatch):
    monkeypatch.setattr("evidence.hardness.stack.load", lambda study: stack_rows() if study == "hardness.stack" else [])
    with pytest.raises(InputError, match=r"metal: the contact area is not calibrated on it; run `python -m evidence"):
        calibrated_depth("metal")
    with pytest.raises(InputError, match=r"nitride: the contact area is not calibrated on it$"):
        calibrated_depth("nitride")
