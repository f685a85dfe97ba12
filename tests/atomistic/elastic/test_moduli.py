"""E(V) scans that survive failures, and E* with its parts."""

from pathlib import Path

import numpy as np
import pytest
from ase.build import bulk
from ase.calculators.calculator import CalculationFailed
from ase.calculators.emt import EMT

from atomistic.elastic.energy_scans import STRAINS, fit_scan, scan_rows, scan_volumes
from atomistic.elastic.moduli import (
    SAMPLES,
    Modulus,
    effective_modulus,
    mean_and_deviation,
    plane_strain_modulus,
    share_of_glass,
)
from atomistic.materials import load_material
from atomistic.settings import DftSettings, ElasticSettings

TITANIUM, NITRIDE = (
    load_material(Path(__file__).parents[3] / "config" / "materials" / f"{name}.yaml")
    for name in ("titanium", "silicon_nitride")
)


class FailsWhenStretched(EMT):
    def calculate(self, atoms=None, *args, **kwargs):
        assert atoms is not None
        if atoms.get_volume() > 12.5:
            raise CalculationFailed("SCF not converged")
        super().calculate(atoms, *args, **kwargs)


def test_modulus_of_two_bodies():
    # 1/E* = (1 - 0.04)/282.6 + (1 - 0.1024)/116
    assert plane_strain_modulus(157, 0.2, 116, 0.32) == pytest.approx(
        1 / (0.96 / 282.6 + 0.8976 / 116)
    )


def test_the_share_of_the_glass_is_the_slope_of_e_star_by_its_bulk_modulus():
    e_star, more = (float(plane_strain_modulus(B, 0.2, 116, 0.32)) for B in (157, 157 * 1.0001))
    summary = {"mean_GPa": e_star, "counter_body": {"E_GPa": 116, "nu": 0.32}}
    assert share_of_glass(summary) == pytest.approx((more / e_star - 1) / 1e-4, rel=1e-3)


def test_e_star_falls_steadily_to_zero_as_the_body_becomes_incompressible():
    e_star = plane_strain_modulus(
        150.0, np.array([0.3, 0.4, 0.45, 0.49, 0.499, 0.499999]), 116.0, 0.32
    )
    assert np.all(e_star > 0)
    assert np.all(np.diff(e_star) < 0)
    assert e_star[-1] == pytest.approx(3 * 150.0 * (1 - 2 * 0.499999) / (1 - 0.499999**2), rel=1e-4)


def test_failed_strain_is_named_and_the_rest_survives():
    points = scan_volumes(bulk("Cu"), FailsWhenStretched(), STRAINS)
    assert [p.converged for p in points] == [True, True, True, True, False]
    row = {"structure": "a01", "xc": "GGA", "ions": "clamped", "atoms": "1"}
    fit = fit_scan([{**row, **{k: str(v) for k, v in vars(p).items()}} for p in points])
    assert fit["B_GPa"] is None
    assert "4 of 5 strains converged" in fit["flags"]
    assert "strain +0.030" in fit["flags"]


def test_mean_and_deviation_agree_with_samples():
    B, error, shift = np.array([150.0, 170.0]), np.array([4.0, 8.0]), 15.0
    mean, deviation = mean_and_deviation(B, error, shift, (0.15, 0.25), (116.0, 3.0), 0.32)
    rng = np.random.default_rng(1)
    n = 200_000
    drawn = rng.integers(0, 2, n)
    samples = plane_strain_modulus(
        B[drawn] + error[drawn] * rng.standard_normal(n) + shift * rng.integers(0, 2, n),
        rng.uniform(0.15, 0.25, n),
        rng.normal(116, 3, n),
        0.32,
    )
    assert mean == pytest.approx(samples.mean(), abs=5 * samples.std() / np.sqrt(n))
    assert deviation == pytest.approx(samples.std(), rel=0.02)
    assert mean_and_deviation(B, 0 * error, shift, (0.15, 0.25), (116.0, 3.0), 0.32)[1] < deviation


def test_ions_that_follow_soften_the_glass_as_its_elastic_constants_say():
    """Six glasses: 232 GPa clamped, and E* of 90.5 +- 2.5 GPa by elastic constants (study
    `elastic.glasses`).
    """
    moduli = [Modulus(f"a{k}", "GGA", B, True) for k, B in enumerate((227.0, 230.0, 233.0, 236.0))]
    moduli += [Modulus(f"a{k}", "LDA", m.B_GPa + 19.8, True) for k, m in enumerate(moduli[:2])]
    summary, samples = effective_modulus(
        moduli, NITRIDE, TITANIUM, ElasticSettings(poisson_ratio=(0.246, 0.271))
    )
    assert summary["mean_GPa"] == pytest.approx(90.5, abs=1.0)
    assert summary["std_GPa"] == pytest.approx(2.5, abs=0.5)
    assert summary["clamped_GPa"] == pytest.approx(96.2, abs=1.0)
    assert samples["e_star_GPa"].mean() == pytest.approx(summary["mean_GPa"], abs=0.1)
    assert samples["e_star_GPa"].std() == pytest.approx(summary["std_GPa"], rel=0.03)


def test_kinds_of_films_stand_beside_the_glass():
    """(1 - 0.0676)/150 + (1 - 0.1024)/116 gives 71.6 GPa."""
    films = effective_modulus([], NITRIDE, TITANIUM, ElasticSettings())[0]["films_GPa"]
    assert films["pecvd"][1] == pytest.approx(71.6, abs=0.1)
    assert films["pecvd"][1] < films["lpcvd"][0]
    assert films["sputtered"][0] < films["sputtered"][1]


def test_too_few_trusted_structures_fail_the_gate_with_the_reason():
    moduli = [
        Modulus("a01", "GGA", 157, True),
        Modulus("a02", "GGA", float("nan"), False, "4 of 5 strains converged"),
    ]
    summary, samples = effective_modulus(moduli, NITRIDE, TITANIUM, ElasticSettings())
    assert not summary["gate"]["passed"]
    assert any("1 amorphous structures" in reason for reason in summary["gate"]["reasons"])
    assert summary["kept_out"][0]["structure"] == "a02"
    assert len(samples["e_star_GPa"]) == SAMPLES


def test_nothing_trusted_gives_no_input():
    summary, _ = effective_modulus([], NITRIDE, TITANIUM, ElasticSettings())
    assert summary["inputs"] == {}
    assert not summary["gate"]["passed"]


def test_poisson_ratio_of_a_liquid_is_refused():
    with pytest.raises(ValueError, match=r"0\.5"):
        ElasticSettings(poisson_ratio=(0.3, 0.5))


def test_rejected_glass_costs_nothing_and_carries_its_reason():
    rows = scan_rows(
        "a08", bulk("Cu"), "GGA", DftSettings(), rejected="6 atoms without their valence"
    )
    fit = fit_scan([{key: str(value) for key, value in row.items()} for row in rows])
    assert fit["B_GPa"] is None
    assert fit["flags"].count("6 atoms without their valence") == 1
