"""Crystals, the gates of a glass, and the Tersoff parameters checked on a crystal."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from asperity.guards.errors import InputError
from atomistic.covalent import Quench, core_commands, tersoff_table
from atomistic.elastic import networks
from atomistic.elastic.networks import (
    crystal,
    examine,
    make_glass,
    quench,
    random_structure,
    same_network,
    symmetry_operations,
)
from atomistic.materials import load_material
from atomistic.settings import NitrideGlassSettings
from tests.atomistic.cheap_potential import tersoff_calculator

MATERIALS = Path(__file__).parents[3] / "config" / "materials"
NITRIDE = load_material(MATERIALS / "silicon_nitride.yaml")
GLASS = NITRIDE.part("network_glass")


def test_beta_silicon_nitride_has_its_density_and_coordination_but_is_no_glass():
    beta = crystal(NITRIDE, "beta")
    verdict = examine(beta, GLASS)
    assert len(beta) == 28
    assert verdict.density_g_cm3 == pytest.approx(3.19, abs=0.01)
    assert verdict.coordination == {"Si": 4.0, "N": 3.0}
    assert any("crystalline" in reason for reason in verdict.reasons)


def test_unknown_crystal_is_one_line():
    with pytest.raises(InputError, match="no crystal 'gamma'"):
        crystal(NITRIDE, "gamma")


def test_tersoff_parameters_hold_beta_together_at_its_known_lattice_constants():
    from ase.filters import FrechetCellFilter
    from ase.optimize import BFGS

    beta = crystal(NITRIDE, "beta")
    beta.calc = tersoff_calculator(GLASS.tersoff)
    cell_and_ions: Any = FrechetCellFilter(beta)
    BFGS(cell_and_ions, logfile=None).run(fmax=0.05, steps=60)
    a, _, c = beta.cell.lengths()
    assert a == pytest.approx(7.40, abs=0.02)  # of this potential; experiment 7.608
    assert c / 2 == pytest.approx(2.94, abs=0.02)
    assert len(tersoff_table(GLASS.tersoff).splitlines()) == 9


def test_random_start_is_reproducible_and_not_overlapping():
    a, b = (random_structure({"Si": 3, "N": 4}, 2, 3.1, 7) for _ in range(2))
    assert np.array_equal(a.positions, b.positions)
    distances = a.get_all_distances(mic=True)[np.triu_indices(len(a), 1)]
    assert distances.min() >= 1.4


def test_a_missing_bond_fails_the_gate_of_a_quenched_cell_only():
    beta = crystal(NITRIDE, "beta")
    nitrogen = beta.symbols.indices()["N"][0]
    beta.positions[nitrogen, 2] += 0.9
    assert examine(beta, GLASS).defects > 0
    assert not any("valence" in reason for reason in examine(beta, GLASS).reasons)
    assert any("valence" in reason for reason in examine(beta, GLASS, max_defects=0).reasons)


def test_cores_leave_beta_untouched():
    """They mend the glass; a crystal with no like atoms that near must not feel them (but for 0.1
    Å).
    """
    beta = crystal(NITRIDE, "beta")
    shortest = examine(beta, GLASS).shortest_A
    for pair, core in GLASS.cores.items():
        assert core.r_A < shortest[pair] + 0.1
    commands = core_commands(GLASS.cores, ("N", "Si"))
    assert [line.split()[1:4] for line in commands] == [
        ["2", "2", "harmonic/cut"],
        ["1", "1", "harmonic/cut"],
    ]


def test_a_crystal_bent_to_fit_its_box_spreads_its_bonds_like_a_glass_and_keeps_a_symmetry():
    from ase.optimize import BFGS

    beta = crystal(NITRIDE, "beta")
    bent = beta.copy()
    bent.set_cell(beta.cell.array @ np.diag([1.10, 1 / 1.10 / 0.95, 0.95]), scale_atoms=True)
    bent.rattle(0.02, seed=1)
    bent.calc = tersoff_calculator(GLASS.tersoff)
    BFGS(bent, logfile=None).run(fmax=0.05, steps=20)
    (reason,) = examine(bent, GLASS, 0).reasons
    assert reason.endswith("symmetry operations: a crystal")


def test_symmetry_is_counted_in_crystals_and_absent_from_disorder():
    beta = crystal(NITRIDE, "beta")
    assert symmetry_operations(beta, 0.1) == 24  # twelve of P6_3/m in each of two unit cells
    beta.rattle(0.4, seed=2)
    assert symmetry_operations(beta, 0.1) == 1
    beta.positions[1] = beta.positions[0]
    assert symmetry_operations(beta, 0.1) == 1


def test_a_network_is_known_again_in_another_orientation_order_and_description():
    beta = crystal(NITRIDE, "beta")
    beta.rattle(0.3, seed=2)
    again = beta[np.random.default_rng(3).permutation(len(beta))]
    # another hand, the same handed cell
    mirrored_edges = np.diag([1, -1, 1]) @ beta.cell.array @ np.diag([1, -1, 1])
    again.set_cell(np.array([[1, 1, 0], [0, 1, 0], [0, 0, 1]]) @ mirrored_edges)
    again.positions = again.positions @ np.diag([1, -1, 1]) + 0.7
    again.rotate(40, (1, 2, 3), rotate_cell=True)
    other = beta.copy()
    other.rattle(0.3, seed=4)
    assert same_network(again, {"a01": other, "a02": beta}) == "a02"
    assert same_network(again, {"a01": other}) is None
    assert same_network(again, {}) is None


def test_a_quench_goes_on_when_it_ends_in_a_network_that_is_there_already(tmp_path, monkeypatch):
    first, second = (crystal(NITRIDE, "beta") for _ in range(2))
    for seed, cell in enumerate((first, second)):
        cell.rattle(0.08, seed=seed)
    results = iter([first.copy(), second.copy()])
    monkeypatch.setattr(networks, "quench", lambda *_: next(results))
    made, rows = make_glass(NITRIDE, NitrideGlassSettings(), 1, tmp_path, accepted={"a01": first})
    assert [row["status"] for row in rows] == ["rejected: the network of a01 again", "accepted"]
    assert np.array_equal(made.positions, second.positions)


def test_a_quenched_cell_rests_in_a_shape_of_its_own(tmp_path, monkeypatch):
    monkeypatch.setattr(networks, "QUENCH", Quench(melt_ps=0.5, rate_K_ps=2000))
    settings = NitrideGlassSettings(formula_units=2)
    first, again = (quench(NITRIDE, settings, 3, tmp_path) for _ in range(2))
    assert np.array_equal(first.positions, again.positions)
    assert first.symbols.formula.count() == {"Si": 6, "N": 8}
    assert np.abs(first.cell.angles() - 90).max() > 1


def test_box_has_the_wanted_density_and_edges():
    box = random_structure({"Si": 3, "N": 4}, 2, 3.1, 7, (0.8, 1.0, 1.25))
    assert examine(box, GLASS).density_g_cm3 == pytest.approx(3.1)
    a, b, c = box.cell.lengths()
    assert (a / b, c / b) == pytest.approx((0.8, 1.25))


def test_anchors_have_their_atoms_and_volume_per_formula():
    counts = {}
    for name, unit, volume in (
        ("silicon", 2, 40.05),
        ("silicon_dioxide", 3, 23.31),
        ("silicon_nitride", 14, 145.9),
    ):
        material = load_material(MATERIALS / f"{name}.yaml")
        (anchor,) = material.crystals
        atoms = crystal(material, anchor)
        counts[anchor] = len(atoms)
        assert atoms.get_volume() * unit / len(atoms) == pytest.approx(volume, rel=1e-3)
    assert counts == {"silicon": 54, "stishovite": 24, "beta": 28}
