import numpy as np
import pytest

from atomistic.hardness.size_effect import (
    fit_size_effect,
    literature_samples,
    same_shape_exponents,
    scale_ratios,
    variance_budget,
)
from atomistic.settings import FitSettings

GLASS = [{"gate": {"passed": True, "reasons": []}}]
BOTH = (1.0, 0.5)  # energy scales


def point(hardness, length, scale=1.0, asperity="a", status="yield", spread=0.05):
    return {
        "run": f"{asperity}_{scale}_{length}",
        "status": status,
        "geometry": "asperity-flat",
        "asperity": asperity,
        "energy_scale": str(scale),
        "hardness_GPa": str(hardness),
        "hardness_lo": str(hardness - spread),
        "hardness_hi": str(hardness + spread),
        "contact_length_nm": str(length),
        "wavelength_nm": "6",
        "amplitude_nm": "0.6",
        "same_shape_GPa": str(hardness),
        "same_shape_length_nm": str(1.1 * length),
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
    exact = {"rate": 0, "base": 0, "potential": 0, "shape": 0}
    points = series(2.0, 8.4, scales=(1.0,)) * 2
    result = fit_size_effect(points, GLASS, FitSettings(h_macro="free"), (1.0,), 0.0, exact)
    free = result["free_fit"]["scale_1"]
    assert free["H_macro_GPa"]["median"] == pytest.approx(2.0, abs=0.2)
    assert free["H_prime_GPa_nm0.5"]["median"] == pytest.approx(8.4, abs=0.4)
    assert free["identifiable"]
    assert result["gate"]["passed"]
    assert result["inputs"]["h_prime"]["correlation"]["h_macro"] < -0.5
    assert result["cost"]["python_cpu_share"] == pytest.approx(0.02)


def test_a_narrow_series_is_not_identifiable_and_says_so():
    rng = np.random.default_rng(0)
    points = [
        point(10 * scale + rng.normal(0, 0.5), 3 + 0.1 * k, scale, asperity=f"a{k}", spread=0.5)
        for scale in (1.0, 0.5)
        for k in range(4)
    ]
    result = fit_size_effect(points, GLASS, FitSettings(h_macro="free"), BOTH, 0.05)
    assert not result["gate"]["passed"]
    assert "not identifiable" in result["gate"]["reasons"][-1]


def test_literature_h_macro_gives_the_hand_calculation():
    """10.6 and 5.3 GPa at 3 nm with H_macro 1.95 GPa: H' = 15.0 and 5.8 GPa nm^0.5."""
    for hardness, expected in ((10.6, 15.0), (5.3, 5.8)):
        h_macro, h_prime, h_film = literature_samples([point(hardness, 3.0, spread=0.0)], (1.9499, 1.9501), {})
        assert np.ptp(h_macro) < 1e-3
        assert np.mean(h_prime) == pytest.approx(expected, abs=0.05)
        np.testing.assert_allclose(h_film, hardness)


def test_both_energy_scales_weigh_the_same():
    points = [point(10, 4, 1.0)] * 9 + [point(5, 4, 0.5)]
    _, h_prime, _ = literature_samples(points, (0.7, 0.7001), {}, 4000)
    assert np.mean(h_prime > 12) == pytest.approx(0.5, abs=0.03)


def test_gate_counts_defended_points_and_names_the_reason():
    refused = [point(0, 0, status="no_yield", asperity=f"n{k}") for k in range(8)]
    result = fit_size_effect(series(2, 8)[:3] + refused, GLASS, FitSettings(), BOTH, 0.05)
    assert not result["gate"]["passed"]
    assert "3 of 11 runs" in result["gate"]["reasons"][0]
    assert any("energy scale 0.5" in reason for reason in result["gate"]["reasons"])
    assert len(result["points_rejected"]) == 8
    nothing = fit_size_effect(refused, GLASS, FitSettings(), BOTH, 0.05)
    assert nothing["inputs"] == {}
    assert not nothing["gate"]["passed"]


def test_a_failed_glass_fails_the_gate():
    bad = [{"gate": {"passed": False, "reasons": ["SiO2 glass: density 3 outside"]}}]
    assert not fit_size_effect(series(2, 8), bad, FitSettings(), BOTH, 0.05)["gate"]["passed"]


def test_ratio_of_the_energy_scales():
    [row] = scale_ratios([point(10, 3, 1.0), point(5, 3, 0.5)])
    assert row["median"] == pytest.approx(0.5, abs=0.01)
    assert row["low"] < 0.5 < row["high"]


def test_budget_names_the_one_source_that_varies():
    """Points made with one source of variance: the budget finds it, with the size that made it."""
    macro = (1.9999, 2.0001)
    alike = [point(10, 4, asperity=name, spread=0.0) for name in ("a", "b") for _ in range(2)]
    quiet = variance_budget(alike, macro, {"area": 0.0})
    assert quiet["std"] == pytest.approx(0, abs=1e-3)
    shared = variance_budget(alike, macro, {"area": 0.05})
    assert shared["systematic"]["sources"]["area"] == pytest.approx(0.05 * 10 * 2)
    assert shared["systematic"]["share"] == pytest.approx(1)
    within = variance_budget([point(10, 4, spread=0.5)] * 3, macro, {})
    assert within["statistical"]["sources"]["run"] == pytest.approx(0.5 * 2)
    seeds = variance_budget([point(9, 4, spread=0.0), point(11, 4, spread=0.0)], macro, {})
    assert seeds["statistical"]["sources"]["seed"] == pytest.approx(2)
    scales = variance_budget([point(10, 4, 1.0, spread=0.0), point(6, 4, 0.5, spread=0.0)], macro, {})
    assert scales["systematic"]["sources"]["energies"] == pytest.approx(4)
    sizes = [point(10, 4, asperity="a", spread=0.0), point(10, 9, asperity="b", spread=0.0)]
    assert variance_budget(sizes, macro, {})["systematic"]["sources"]["size"] == pytest.approx(4)


def test_budget_is_the_variance_of_what_is_handed_on():
    """Its sum against the variance of the samples, whose factors are drawn apart from the runs."""
    rng = np.random.default_rng(3)
    points = [
        point(scale * 10 * (1 + 0.05 * rng.normal()), length, scale, asperity=f"a{length}", spread=0.3)
        for scale in (1.0, 0.5)
        for length in (2.5, 3.5, 4.5)
        for _ in range(2)
    ]
    macro, systematic = FitSettings().h_macro_GPa, {"area": 0.03, "rate": 0.06}
    _, h_prime, _ = literature_samples(points, macro, systematic, 50_000)
    budget = variance_budget(points, macro, systematic)
    assert budget["std"] == pytest.approx(np.std(h_prime), rel=0.02)
    assert budget["statistical"]["share"] + budget["systematic"]["share"] == pytest.approx(1)


def test_the_exponent_at_one_shape_counts_all_runs_and_needs_one_shape():
    lengths = (2.0, 2.1, 4.0, 4.2, 8.0, 8.2)
    points = [
        point(20 * length**-0.4, length, asperity=f"a{length:.0f}", status="rejected: stress still rises")
        for length in lengths
    ]
    few = [point(5, length, scale=0.5, asperity=f"a{length}") for length in (2, 4, 8)]
    found = same_shape_exponents(points + few)
    assert list(found) == ["scale_1"]
    assert found["scale_1"]["mean"] == pytest.approx(0.4)
    assert found["scale_1"]["runs"] == 6
    assert found["scale_1"]["length_max_nm"] == pytest.approx(1.1 * 8.2)
    assert same_shape_exponents([*points, {**points[0], "amplitude_nm": "0.9"}]) == {}  # steeper
    assert same_shape_exponents([*points, {**points[0], "geometry": "asperity-asperity"}]) == {}


def test_the_interval_of_the_exponent_at_one_shape_holds_the_truth():
    """Runs that scatter by 8 % about L^0.1: the 68 % interval holds n = -0.1 in about 68 % of such series."""
    rng, lengths = np.random.default_rng(4), (2.4, 2.4, 2.4, 3.6, 3.6, 3.6, 4.7, 4.7, 4.7)
    held = 0
    for _ in range(300):
        points = [
            point(9 * length**0.1 * np.exp(0.08 * rng.normal()), length, asperity=f"a{length}") for length in lengths
        ]
        found = same_shape_exponents(points)["scale_1"]
        held += found["low"] < -0.1 < found["high"]
    assert held / 300 == pytest.approx(0.68, abs=0.08)
