"""Crystals, the gates of a glass, and the Tersoff parameters checked on a crystal."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from atomistic.elastic.networks import (
    SoftCores,
    core_commands,
    crystal,
    examine,
    random_structure,
    tersoff_calculator,
    tersoff_table,
    with_relaxed_shape,
)
from atomistic.errors import InputError
from atomistic.materials import load_material

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


def test_collapsed_and_exploded_cells_fail_the_gate():
    beta = crystal(NITRIDE, "beta")
    for scale in (0.7, 1.4):
        cell = beta.copy()
        cell.set_cell(beta.cell.array * scale, scale_atoms=True)
        assert any("density" in reason for reason in examine(cell, GLASS).reasons)


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
    """They mend the glass; a crystal with no like atoms that near must not feel them (but for 0.1 Å)."""
    beta = crystal(NITRIDE, "beta")
    shortest = examine(beta, GLASS).shortest_A
    for pair, core in GLASS.cores.items():
        assert core.r_A < shortest[pair] + 0.1
    assert core_commands(GLASS.cores, ("Si", "N")).count("harmonic/cut") == 3
    assert "1 2 harmonic/cut 0.0" in core_commands(GLASS.cores, ("Si", "N"))


def test_forces_and_stress_of_the_cores_are_the_slopes_of_their_energy():
    from ase.calculators.fd import calculate_numerical_forces, calculate_numerical_stress

    atoms = crystal(NITRIDE, "beta", (1, 1, 1))
    atoms.set_cell(0.95 * atoms.cell.array, scale_atoms=True)
    atoms.rattle(0.1, seed=3)
    atoms.calc = SoftCores(GLASS.cores)
    assert np.abs(atoms.get_forces()).max() > 1
    assert atoms.get_forces() == pytest.approx(calculate_numerical_forces(atoms, 1e-5), abs=1e-7)
    assert atoms.get_stress() == pytest.approx(calculate_numerical_stress(atoms, 1e-6), abs=1e-8)


def test_a_crystal_bent_to_fit_its_box_passes_for_a_glass_until_its_shape_relaxes():
    from ase.optimize import BFGS

    beta = crystal(NITRIDE, "beta")
    bent = beta.copy()
    bent.set_cell(beta.cell.array @ np.diag([1.10, 1 / 1.10 / 0.95, 0.95]), scale_atoms=True)
    bent.rattle(0.02, seed=1)
    bent.calc = tersoff_calculator(GLASS.tersoff)
    BFGS(bent, logfile=None).run(fmax=0.05, steps=100)
    assert examine(bent, GLASS, 0).passed
    relaxed = with_relaxed_shape(bent, GLASS)
    assert relaxed.get_volume() == pytest.approx(beta.get_volume())
    assert any("crystalline" in reason for reason in examine(relaxed, GLASS, 0).reasons)


def test_box_has_the_wanted_density_and_edges():
    box = random_structure({"Si": 3, "N": 4}, 2, 3.1, 7, (0.8, 1.0, 1.25))
    assert examine(box, GLASS).density_g_cm3 == pytest.approx(3.1)
    a, b, c = box.cell.lengths()
    assert (a / b, c / b) == pytest.approx((0.8, 1.25))


def test_anchors_have_their_atoms_and_volume_per_formula():
    counts = {}
    for name, unit, volume in (("silicon", 2, 40.05), ("silicon_dioxide", 3, 23.31), ("silicon_nitride", 14, 145.9)):
        material = load_material(MATERIALS / f"{name}.yaml")
        (anchor,) = material.crystals
        atoms = crystal(material, anchor)
        counts[anchor] = len(atoms)
        assert atoms.get_volume() * unit / len(atoms) == pytest.approx(volume, rel=1e-3)
    assert counts == {"silicon": 54, "stishovite": 24, "beta": 28}
