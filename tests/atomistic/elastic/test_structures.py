"""Amorphous structures: what is relaxed, what is rejected, and which moduli count."""

from pathlib import Path

import numpy as np
import pytest
from ase.calculators.calculator import CalculationFailed

from atomistic.elastic.networks import crystal
from atomistic.elastic.structures import relaxed_structure, structure_rows, trusted_moduli
from atomistic.materials import load_material
from tests.atomistic.cheap_potential import tersoff_calculator

MATERIALS = Path(__file__).parents[3] / "config" / "materials"
NITRIDE = load_material(MATERIALS / "silicon_nitride.yaml")
GLASS = NITRIDE.part("network_glass")
STEPS = 15


@pytest.fixture
def shaken():
    """β-Si3N4 with every atom moved by some 0.1 Å: a perfect network with disordered bonds."""
    cell = crystal(NITRIDE, "beta")
    cell.rattle(0.06, seed=1)
    return cell


def tersoff():
    calculator = tersoff_calculator(GLASS.tersoff)
    calculator.gap_eV = 4.0  # the cheap potential has no electrons
    return calculator


def test_a_sound_cell_is_relaxed_and_judged_again(shaken):
    # relaxing turns it back into a crystal, which the gate of glasses must see on the relaxed cell
    relaxed = relaxed_structure(shaken, GLASS, tersoff, STEPS)
    assert relaxed.relaxation.converged
    assert relaxed.relaxation.energy_gained_eV > 0
    assert any("crystalline" in reason for reason in relaxed.reasons)
    assert relaxed.report("a01")["gate"] == {"passed": False, "reasons": list(relaxed.reasons)}


def test_no_calculation_is_spent_on_a_cell_that_no_quench_made_right(shaken):
    def never():
        pytest.fail("a calculator was made")

    rejected = relaxed_structure(
        shaken, GLASS, never, STEPS, refused="8 atoms without their valence"
    )
    assert rejected.calculator is None
    assert rejected.atoms is shaken
    assert rejected.reasons == ("8 atoms without their valence",)


def test_a_broken_bond_is_relaxed_where_it_is_allowed_and_its_gap_decides(shaken):
    # leaves one of its three neighbours
    shaken.positions[shaken.symbols.indices()["N"][0], 0] += 1.2
    broken = relaxed_structure(shaken, GLASS, tersoff, STEPS)
    assert broken.calculator is not None
    assert broken.report("a01")["defects"] == broken.verdict.defects
    assert not any("valence" in reason for reason in broken.reasons)


def test_a_failed_calculation_and_a_closed_gap_are_reasons(shaken):
    class Fails(type(tersoff())):
        gap_eV = 0.1

        def calculate(self, *args, **kwargs):
            raise CalculationFailed("SCF not converged in 50 cycles")

    failed = relaxed_structure(shaken, GLASS, lambda: Fails(tersoff().parameters), STEPS)
    assert any("SCF not converged" in reason for reason in failed.reasons)
    # to rounding: the cell is scaled by one
    assert np.allclose(failed.atoms.positions, shaken.positions)
    assert not failed.relaxation.converged

    def metal():
        calculator = tersoff()
        calculator.gap_eV = 0.1
        return calculator

    closed = relaxed_structure(shaken, GLASS, metal, STEPS)
    assert "gap 0.10 eV: no insulator" in closed.reasons


def report(name, *reasons):
    gate = {"passed": not reasons, "reasons": list(reasons)}
    relaxation = {
        "steps": 3,
        "force_left_eV_A": 0.1,
        "converged": True,
        "energy_gained_eV": 1.0,
        "gap_eV": 2.0,
    }
    made = {
        "structure": name,
        "atoms": 28,
        "density_g_cm3": 3.0,
        "coordination_Si": 4.0,
        "coordination_N": 3.0,
    }
    made |= {"defects": 0, "provenance": {"commit": "none"}}
    return {
        **made,
        "bond_spread_A": 0.05,
        "symmetry_operations": 1,
        "relaxation": relaxation,
        "gate": gate,
    }


def test_a_modulus_counts_if_neither_its_fit_nor_its_structure_has_a_flag():
    def fit(name, B_GPa, flags=""):
        return {
            "structure": name,
            "xc": "GGA",
            "ions": "clamped",
            "B_GPa": B_GPa,
            "B_error_GPa": "0.2",
            "flags": flags,
        }

    fits = [
        fit("beta", "240.0"),
        fit("a01", "157.0"),
        fit("a02", "160.0"),
        fit("a03", "", "3 of 5 strains converged"),
    ]
    good, gapless, unfitted = trusted_moduli(
        fits, [report("a01"), report("a02", "no insulator"), report("a03")]
    )
    assert (good.structure, good.B_GPa, good.trusted, good.reason) == ("a01", 157.0, True, "")
    assert (gapless.trusted, gapless.reason) == (False, "no insulator")
    assert (unfitted.trusted, unfitted.reason) == (False, "3 of 5 strains converged")
    assert np.isnan(unfitted.B_GPa)


def test_the_list_of_structures_says_why_one_is_out_and_how_many_quenches_it_took():
    first, second = structure_rows([report("a01"), report("a02", "no insulator")], [1, 3])
    assert (first["status"], first["quenches"], first["steps"]) == ("accepted", 1, 3)
    assert (second["status"], second["quenches"]) == ("rejected: no insulator", 3)
    assert "provenance" not in first
