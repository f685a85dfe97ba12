"""E* from the structures' own bulk and shear moduli; a structure that fails costs only itself."""

from pathlib import Path

import numpy as np
import pytest
from ase.calculators.calculator import CalculationFailed, Calculator

from atomistic.elastic import moduli
from atomistic.elastic.constants import Measured, isotropic_rows, isotropic_table, measure_constants
from atomistic.elastic.moduli import (
    Modulus,
    effective_modulus,
    grid_shares,
    plane_strain_modulus,
    with_computed_poisson,
)
from atomistic.elastic.networks import crystal, tersoff_calculator
from atomistic.elastic.tensor import poisson, young
from atomistic.materials import load_material
from atomistic.settings import ElasticSettings

MATERIALS = Path(__file__).parents[3] / "config" / "materials"
NITRIDE = load_material(MATERIALS / "silicon_nitride.yaml")
TITANIUM = load_material(MATERIALS / "titanium.yaml")
SETTINGS = ElasticSettings(poisson="computed", samples=50_000)


@pytest.fixture(autouse=True)
def _two_structures_are_enough(monkeypatch):
    monkeypatch.setattr(moduli, "MIN_STRUCTURES", 2)


def row(name, B, G, ions="relaxed", error=0.0, flags="", doubts=""):
    values = {"B_GPa": B, "G_GPa": G, "B_error_GPa": 0.0, "G_error_GPa": error}
    said = {"flags": flags, "doubts": doubts}
    return {"structure": name, "ions": ions, **said, **{key: str(value) for key, value in values.items()}}


def literature(shift=20.0):
    known = [Modulus(f"a{k}", "GGA", 230.0 + k, True) for k in range(4)]
    known += [Modulus(f"a{k}", "LDA", 230.0 + k + shift, True) for k in range(4)]
    return effective_modulus(known, TITANIUM, SETTINGS)[0]


def test_e_star_is_that_of_eq_5_with_the_structures_own_poisson_ratio():
    summary, samples = with_computed_poisson(literature(), [row("a0", 150, 90), row("a1", 150, 90)], TITANIUM, SETTINGS)
    factor = 1 + 20.0 / 231.5
    other = TITANIUM.part("polycrystal")
    expected = [
        plane_strain_modulus(150 * f, poisson(150, 90), other.young_GPa, other.poisson_ratio) for f in (1, factor)
    ]
    assert summary["mean_GPa"] == pytest.approx(np.mean(expected), rel=2e-3)  # but for the counter body's scatter
    assert samples["nu"] == pytest.approx(poisson(150, 90))
    assert summary["shares"]["structure"]["total"] == pytest.approx(0, abs=1e-12)
    assert summary["gate"]["passed"]
    assert summary["isotropic_moduli"]["relaxed"]["E_GPa"]["mean"] == pytest.approx(young(150, 90))
    assert summary["by_literature_poisson"]["mean_GPa"] == pytest.approx(literature()["mean_GPa"])


def test_shares_add_to_one_and_mean_and_scatter_are_those_of_the_samples():
    rows = [row("a0", 150, 80, error=4), row("a1", 170, 95, error=6), row("a2", 160, 70, error=2)]
    summary, samples = with_computed_poisson(literature(), rows, TITANIUM, SETTINGS)
    assert sum(share["first_order"] for share in summary["shares"].values()) == pytest.approx(1, abs=0.02)
    e_star = samples["e_star_GPa"]
    assert summary["mean_GPa"] == pytest.approx(e_star.mean(), abs=5 * e_star.std() / np.sqrt(len(e_star)))
    assert summary["std_GPa"] == pytest.approx(e_star.std(), rel=0.02)


def test_the_size_of_the_cell_scales_bulk_and_shear_modulus_together(monkeypatch):
    rows = [row("a0", 150, 90), row("a1", 150, 90)]
    stds, shares = [], []
    for error in (0.0, 0.02):
        monkeypatch.setattr(moduli, "SIZE_ERROR", error)
        summary, samples = with_computed_poisson(literature(), rows, TITANIUM, SETTINGS)
        assert samples["nu"] == pytest.approx(poisson(150, 90))
        stds.append(summary["std_GPa"])
        shares.append(summary["shares"]["size"]["total"])
    # d ln E* / d ln E of one body is its share of the compliance
    other = TITANIUM.part("polycrystal")
    e_star = summary["mean_GPa"]
    share = 1 - e_star * (1 - other.poisson_ratio**2) / other.young_GPa
    assert np.sqrt(stds[1] ** 2 - stds[0] ** 2) == pytest.approx(0.02 * share * e_star, rel=0.05)
    assert shares[0] == pytest.approx(0, abs=1e-12)
    assert shares[1] == pytest.approx(1 - (stds[0] / stds[1]) ** 2, rel=0.01)


def test_flagged_and_clamped_rows_do_not_enter_and_too_few_fail_the_gate():
    rows = [row("a0", 150, 80), row("a1", 999, 1, flags="unstable"), row("a0", 300, 200, ions="clamped")]
    summary, samples = with_computed_poisson(literature(), rows, TITANIUM, SETTINGS)
    assert summary["structures_used"] == ["a0"]
    assert set(np.round(samples["nu"], 6)) == {round(poisson(150, 80), 6)}
    assert "1 amorphous structures with trusted elastic constants, 2 are needed" in summary["gate"]["reasons"]
    nothing, empty = with_computed_poisson(literature(), rows[1:2], TITANIUM, SETTINGS)
    assert np.isnan(nothing["mean_GPa"])
    assert all(len(values) == 0 for values in empty.values())


def test_shares_of_a_product_are_exact():
    axes = {name: (np.array([-1.0, 1.0]) * size, np.full(2, 0.5)) for name, size in (("a", 1), ("b", 2), ("c", 3))}
    shared = grid_shares(axes, lambda a, b, c: a * b + c)
    assert (shared["mean_GPa"], shared["std_GPa"] ** 2) == pytest.approx((0, 4 + 9))
    assert shared["shares"]["a"] == pytest.approx({"first_order": 0, "total": 4 / 13})
    assert shared["shares"]["c"] == pytest.approx({"first_order": 9 / 13, "total": 9 / 13})


@pytest.fixture(scope="module")
def measured():
    atoms = crystal(NITRIDE, "beta", (1, 1, 1))
    calculator = tersoff_calculator(NITRIDE.part("network_glass").tersoff)
    return measure_constants(atoms, calculator, force_eV_A=0.01, max_steps=60)


def test_constants_of_a_crystal_under_the_cheap_potential(measured):
    clamped, relaxed = isotropic_rows(measured.report("beta"))
    assert (clamped["flags"], relaxed["flags"]) == ("", "")
    assert relaxed["B_GPa"] == pytest.approx(227, rel=0.03)  # known of this potential, from E(V)
    assert relaxed["G_GPa"] < clamped["G_GPa"]
    assert relaxed["B_GPa"] <= clamped["B_GPa"]


def test_whatever_fails_is_named_and_costs_its_structure_only(measured):
    class Fails(Calculator):
        implemented_properties = ["energy", "forces", "stress"]  # noqa: RUF012

        def calculate(self, *args, **kwargs):
            raise CalculationFailed("SCF not converged in 50 cycles")

    class Blind(type(tersoff_calculator(NITRIDE.part("network_glass").tersoff))):
        implemented_properties = ["energy", "forces"]  # noqa: RUF012

    atoms = crystal(NITRIDE, "beta", (1, 1, 1))
    for calculator, said in (
        (Fails(), "SCF not converged"),
        (Blind(tersoff_calculator(NITRIDE.part("network_glass").tersoff).parameters), "stress"),
    ):
        failed = measure_constants(atoms, calculator)
        rows = isotropic_rows(failed.report("a01"))
        assert all(said in line["flags"] and line["B_GPa"] is None for line in rows)
    hurried = measure_constants(
        atoms,
        tersoff_calculator(NITRIDE.part("network_glass").tersoff),
        force_eV_A=1e-6,
        max_steps=1,
    )
    assert "not at rest after 1 steps" in hurried.failure
    assert measured.response is not None
    unstable = {**measured.report("a01"), "C_relaxed_GPa": (-np.eye(6)).tolist()}
    clamped, relaxed = isotropic_rows(unstable)
    assert clamped["flags"] == ""
    assert "unstable" in relaxed["flags"]


def test_a_network_counts_once_even_if_two_cells_come_to_rest_in_it(measured):
    lines = isotropic_rows(measured.report("a02"), copied="a01")
    assert all(line["flags"] == "at rest it is a01 again" and line["B_GPa"] > 0 for line in lines)
    failed = Measured(measured.atoms, None, None, "SCF not converged in 50 cycles").report("a01")
    cells = [failed, measured.report("a02"), measured.report("a03")]
    flags = [row["flags"] for row in isotropic_table((report, measured.atoms) for report in cells)]
    assert flags[2:] == ["", "", *["at rest it is a02 again"] * 2]  # the one that failed counts nowhere


def test_a_cell_that_is_no_insulating_glass_at_rest_is_doubted():
    atoms = crystal(NITRIDE, "beta", (1, 1, 1))
    network = NITRIDE.part("network_glass")
    metal = tersoff_calculator(network.tersoff)
    metal.gap_eV = 0.1
    judged = measure_constants(atoms, metal, force_eV_A=0.01, max_steps=60, criteria=network)
    assert judged.failure == ""
    lines = isotropic_rows(judged.report("a01"))
    assert all("crystalline" in line["doubts"] and "gap 0.10 eV: no insulator" in line["doubts"] for line in lines)
    assert all(line["flags"] == "" for line in lines)


def test_what_e_star_is_without_doubtful_cells_stands_beside_it():
    rows = [row("a0", 150, 80), row("a1", 170, 95, doubts="crystalline"), row("a2", 160, 70)]
    summary, _ = with_computed_poisson(literature(), rows, TITANIUM, SETTINGS)
    sound, _ = with_computed_poisson(literature(), [rows[0], rows[2]], TITANIUM, SETTINGS)
    assert "without_doubtful" not in sound
    assert summary["structures_used"] == ["a0", "a1", "a2"]
    assert summary["without_doubtful"] == {"structures": 2, **{key: sound[key] for key in ("mean_GPa", "std_GPa")}}
    assert "a1 (crystalline)" in summary["notes"][-1]
    assert f"{sound['mean_GPa']:.1f}" in summary["notes"][-1]
    nothing, _ = with_computed_poisson(literature(), [rows[1], rows[1]], TITANIUM, SETTINGS)
    assert nothing["without_doubtful"] == {"structures": 0, "mean_GPa": None, "std_GPa": None}


def test_a_constant_that_rests_on_an_estimate_is_flagged(measured):
    report = measured.report("a01")
    C44 = report["C_relaxed_GPa"][3][3]
    for share, flagged in ((0.19, False), (0.21, True)):
        left = [0.0, 0.0, 0.0, share * C44, 0.0, 0.0]
        clamped, relaxed = isotropic_rows({**report, "still_softer_GPa": left})
        assert clamped["flags"] == ""
        assert (f"C44 of {C44:.0f} GPa rests on an estimate" in relaxed["flags"]) is flagged


def test_a_rejected_glass_keeps_its_reasons():
    atoms = crystal(NITRIDE, "beta", (1, 1, 1))
    rows = isotropic_rows(Measured(atoms, None, None, "3 atoms without their valence").report("a01"))
    assert [line["flags"] for line in rows] == ["3 atoms without their valence"] * 2
