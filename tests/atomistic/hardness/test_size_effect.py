import numpy as np
import pytest

from atomistic.hardness.size_effect import fit_size_effect, literature_samples, scale_ratios
from atomistic.settings import FitSettings, HardnessSettings

GLASS = [{"gate": {"passed": True, "reasons": []}}]


def point(hardness, length, scale=1.0, asperity="a", status="yield", spread=0.05):
    return {
        "run": f"{asperity}_{scale}_{length}",
        "status": status,
        "asperity": asperity,
        "energy_scale": str(scale),
        "hardness_GPa": str(hardness),
        "hardness_lo": str(hardness - spread),
        "hardness_hi": str(hardness + spread),
        "contact_length_nm": str(length),
        "atom_steps": "1e6",
        "lammps_cpu_s": "0.98",
        "python_cpu_s": "0.02",
    }


def series(h_macro, h_prime, lengths=(2, 4, 8, 16), scales=(1.0, 0.5)):
    return [
        point(scale * (h_macro + h_prime / np.sqrt(length)), length, scale, asperity=f"a{length}")
        for scale in scales
        for length in lengths
    ]


def test_free_fit_finds_both_parameters_of_a_wide_series():
    settings = HardnessSettings.model_validate({"fit": {"h_macro": "free"}, "energy_scales": [1.0]})
    result = fit_size_effect(series(2.0, 8.4, scales=(1.0,)) * 2, GLASS, settings)
    free = result["free_fit"]["scale_1"]
    assert free["H_macro_GPa"]["median"] == pytest.approx(2.0, abs=0.2)
    assert free["H_prime_GPa_nm0.5"]["median"] == pytest.approx(8.4, abs=0.4)
    assert free["identifiable"]
    assert result["gate"]["passed"]
    assert result["inputs"]["h_prime"]["correlation"]["h_macro"] < -0.5
    assert result["cost"]["python_cpu_share"] == pytest.approx(0.02)


def test_a_narrow_series_is_not_identifiable_and_says_so():
    settings = HardnessSettings.model_validate({"fit": {"h_macro": "free"}})
    rng = np.random.default_rng(0)
    points = [
        point(10 * scale + rng.normal(0, 0.5), 3 + 0.1 * k, scale, asperity=f"a{k}", spread=0.5)
        for scale in (1.0, 0.5)
        for k in range(4)
    ]
    result = fit_size_effect(points, GLASS, settings)
    assert not result["gate"]["passed"]
    assert "not identifiable" in result["gate"]["reasons"][-1]


def test_literature_h_macro_gives_the_hand_calculation():
    """10.6 and 5.3 GPa at 3 nm with H_macro 1.95 GPa: H' = 15.0 and 5.8 GPa nm^0.5."""
    for hardness, expected in ((10.6, 15.0), (5.3, 5.8)):
        fit = FitSettings(h_macro_GPa=(1.9499, 1.9501))
        h_macro, h_prime = literature_samples([point(hardness, 3.0, spread=0.0)], fit)
        assert np.ptp(h_macro) < 1e-3
        assert np.mean(h_prime) == pytest.approx(expected, abs=0.05)


def test_both_energy_scales_weigh_the_same():
    points = [point(10, 4, 1.0)] * 9 + [point(5, 4, 0.5)]
    _, h_prime = literature_samples(points, FitSettings(h_macro_GPa=(0.7, 0.7001), bootstrap=4000))
    assert np.mean(h_prime > 12) == pytest.approx(0.5, abs=0.03)


def test_gate_counts_defended_points_and_names_the_reason():
    refused = [point(0, 0, status="no_yield", asperity=f"n{k}") for k in range(8)]
    result = fit_size_effect(series(2, 8)[:3] + refused, GLASS, HardnessSettings())
    assert not result["gate"]["passed"]
    assert "3 of 11 runs" in result["gate"]["reasons"][0]
    assert any("energy scale 0.5" in reason for reason in result["gate"]["reasons"])
    assert len(result["points_rejected"]) == 8
    nothing = fit_size_effect(refused, GLASS, HardnessSettings())
    assert nothing["inputs"] == {}
    assert not nothing["gate"]["passed"]


def test_a_failed_glass_fails_the_gate():
    bad = [{"gate": {"passed": False, "reasons": ["SiO2 glass: density 3 outside"]}}]
    assert not fit_size_effect(series(2, 8), bad, HardnessSettings())["gate"]["passed"]


def test_ratio_of_the_energy_scales():
    [row] = scale_ratios([point(10, 3, 1.0), point(5, 3, 0.5)])
    assert row["median"] == pytest.approx(0.5, abs=0.01)
    assert row["low"] < 0.5 < row["high"]
