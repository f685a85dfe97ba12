import numpy as np
import pytest

from atomistic.hardness.size_effect import (
    BERKOVICH,
    RUN_SCATTER,
    energy_bounds,
    fit_size_effect,
    free_fit,
    hardness_samples,
    relative_hardness,
    rms_slope,
    steepness,
    twins,
)

GLASS = [{"gate": {"passed": True, "reasons": []}}]


def h_macro(probability):
    """Quantiles of Table 1's range, GPa."""
    return 0.7 + 2.5 * probability


def point(hardness, length, scale=1.0, asperity="a", status="yield", spread=0.05, seed=1):
    return {
        "run": f"{asperity}_{scale}_{length}",
        "status": status,
        "asperity": asperity,
        "seed": str(seed),
        "film_nm": "",
        "energy_scale": str(scale),
        "hardness_GPa": str(hardness),
        "hardness_lo": str(hardness - spread),
        "hardness_hi": str(hardness + spread),
        "contact_length_nm": str(length),
        "wavelength_nm": "6",
        "amplitude_nm": "0.6",
        "atom_steps": "1e6",
        "lammps_cpu_s": "0.98",
    }


def series(h_macro, h_prime, lengths=(2, 4, 8, 16), scales=(1.0, 0.5)):
    return [
        point(scale * (h_macro + h_prime / np.sqrt(length)), length, scale, asperity=f"a{length}")
        for scale in scales
        for length in lengths
    ]


def test_a_hardness_below_h_macro_is_not_identifiable_and_says_so():
    points = [
        point(1.0 * scale, 3 + k, scale, asperity=f"a{k}") for scale in (1.0, 0.5) for k in range(4)
    ]
    result = fit_size_effect(points, GLASS, 0.05, h_macro)
    assert not result["gate"]["passed"]
    assert "not identifiable" in result["gate"]["reasons"][-1]


@pytest.mark.parametrize(("hardness", "expected"), [(10.6, 15.0), (5.3, 5.8)])
def test_h_prime_is_that_of_the_hand_calculation(hardness, expected):
    """10.6 and 5.3 GPa at 3 nm with H_macro 1.95 GPa: H' = 15.0 and 5.8 GPa nm^0.5."""
    points = [point(hardness, 3.0, spread=0.0, asperity=f"a{k}") for k in range(4)]
    result = fit_size_effect(
        points, GLASS, 0.0, lambda p: np.full_like(p, 1.95), systematic_errors={"none": 0.0}
    )
    assert result["H_prime_GPa_nm0.5"]["median"] == pytest.approx(expected, abs=0.05)
    assert result["inputs"]["h_film"]["values"] == pytest.approx([hardness] * 200)


def test_h_prime_follows_the_scenes_own_h_macro():
    """A harder metal leaves less to the size effect: 10 GPa at 4 nm are (10 - H_macro) 2 GPa
    nm^0.5.
    """
    points = [point(10.0, 4.0, spread=0.0, asperity=f"a{k}") for k in range(4)]
    result = fit_size_effect(
        points, GLASS, 0.0, lambda p: 6 + 2 * p, systematic_errors={"none": 0.0}
    )
    low, high = (result["inputs"]["h_prime"][end] for end in "ab")
    # the 68 % interval of H_macro is 6.32 to 7.68 GPa
    assert (low, high) == pytest.approx((2 * (10 - 7.68), 2 * (10 - 6.32)), abs=0.15)


def test_measured_energies_take_the_runs_at_full_ones_alone():
    """Their twins tell the error of the potential; what bounds the energies is a measurement."""
    found = fit_size_effect(series(2, 8), GLASS, 0.05, h_macro, indentation_GPa=(6.0, 12.0))
    alone = fit_size_effect(
        series(2, 8, scales=(1.0,)), GLASS, 0.05, h_macro, indentation_GPa=(6.0, 12.0)
    )
    assert found["inputs"] == alone["inputs"]
    assert found["points_used"] == 4


def test_scales_weigh_alike_whatever_their_number_of_runs():
    points = [point(10, 4, 1.0, spread=0.0)] * 9 + [point(5, 4, 0.5, spread=0.0)]
    _, drawn = hardness_samples(points, {"none": 0.0}, (1.0, 1.0), 4000)
    assert set(np.round(drawn, 9)) == {5.0, 10.0}
    # three standard errors of 4000 draws
    assert np.mean(drawn == 10.0) == pytest.approx(0.5, abs=0.03)
    found = fit_size_effect(points, GLASS, 0.0, h_macro, "scales", (9.0, 11.0), {"none": 0.0})
    # the measurement bounds nothing
    assert set(np.round(found["inputs"]["h_film"]["values"], 9)) == {
        5.0,
        10.0,
    }


def test_twins_are_compared_pair_by_pair():
    points = [
        point(10, 3, seed=1), point(5.2, 3, 0.5, seed=1),
        point(9, 4, seed=2), point(4.5, 4, 0.5, seed=2),
        point(9, 6, asperity="b"),
        point(3, 6, 0.5, asperity="b", status="no_yield"),
    ]  # fmt: skip
    (row,) = twins(points)
    assert (row["energy_scale"], row["pairs"]) == (0.5, 2)
    assert row["ratio"]["median"] == pytest.approx(np.sqrt(0.52 * 0.5))
    # of 2 x 2 runs
    assert np.log(row["ratio"]["high"] / row["ratio"]["median"]) == pytest.approx(RUN_SCATTER)
    assert twins(points[:1]) == []


def test_intervals_of_twins_hold_the_truth_as_often_as_stated():
    """Runs that scatter by 11 % about halved energies of half the hardness: 68 % of intervals hold
    0.5.
    """
    rng = np.random.default_rng(5)
    held = 0
    for _ in range(400):
        pairs = [
            point(scale * 10 * np.exp(RUN_SCATTER * rng.normal()), 4, scale, seed=seed)
            for seed in (1, 2)
            for scale in (1.0, 0.5)
        ]
        ratio = twins(pairs)[0]["ratio"]
        held += ratio["low"] <= 0.5 <= ratio["high"]
    assert held / 400 == pytest.approx(0.68, abs=0.07)  # three standard errors of 400


def test_a_free_fit_of_a_wide_range_finds_both_parameters():
    found = free_fit(series(2, 8, lengths=(2, 3, 4, 8, 16, 64), scales=(1.0,)))
    assert found["identified"]
    assert found["H_macro_GPa"]["mean"] == pytest.approx(2)
    assert found["H_prime_GPa_nm0.5"]["mean"] == pytest.approx(8)


def test_six_runs_of_a_narrow_range_do_not_tell_both_parameters():
    """Three sizes of two glasses, level within their scatter, as scene `reduced` has them."""
    runs = [
        point(h, length)
        for h, length in ((9.0, 2.4), (9.4, 2.6), (9.8, 3.6), (8.9, 3.8), (9.3, 4.9), (9.6, 5.0))
    ]
    found = free_fit(runs)
    assert not found["identified"]
    assert found["verdict"] == "6 runs do not tell H_prime from zero"
    assert free_fit(runs[:2]) is None


def test_energies_bound_the_measured_hardness_at_the_slope_of_the_tip():
    slopes = steepness(series(2, 8))
    low, high = energy_bounds(10.0, slopes, [0.5, 1.0], (6.0, 12.0))
    # at the tip's slope the runs are softer than at their own
    for energies, measured in ((low, 6.0), (high, 12.0)):
        assert 10.0 * energies * relative_hardness(BERKOVICH) == pytest.approx(measured, rel=2e-3)
    # the potential as published is never left out
    assert energy_bounds(10.0, slopes, [1.0], (9.9, 12.0))[0] == 1.0
    assert energy_bounds(10.0, slopes, [0.5, 1.0], None) == (0.5, 1.0)


def test_gate_counts_defended_points_and_names_the_reason():
    refused = [
        point(0, 0, scale, status="no_yield", asperity=f"n{k}")
        for k in range(4)
        for scale in (1.0, 0.5)
    ]
    result = fit_size_effect(series(2, 8)[:3] + refused, GLASS, 0.05, h_macro, "scales")
    assert not result["gate"]["passed"]
    assert "3 of 11 runs" in result["gate"]["reasons"][0]
    assert any("energy scale 0.5" in reason for reason in result["gate"]["reasons"])
    assert len(result["points_rejected"]) == 8
    nothing = fit_size_effect(refused, GLASS, 0.05, h_macro, "scales")
    assert nothing["inputs"] == {}
    assert not nothing["gate"]["passed"]


def test_a_failed_glass_fails_the_gate():
    bad = [{"gate": {"passed": False, "reasons": ["SiO2 glass: density 3 outside"]}}]
    assert not fit_size_effect(series(2, 8), bad, 0.05, h_macro)["gate"]["passed"]


def test_the_slope_of_an_asperity_is_that_of_its_surface():
    x = 2 * np.pi * np.arange(600) / 600
    heights = 0.6 * np.minimum(*np.meshgrid(np.sin(x), np.sin(x)))
    along, across = ((heights - np.roll(heights, 1, axis)) / (6 / 600) for axis in (0, 1))
    assert rms_slope(point(10, 3)) == pytest.approx(
        np.sqrt(np.mean(along**2 + across**2)), rel=0.01
    )


def test_hardness_at_a_slope_is_straight_between_the_runs_and_unknown_beyond():
    assert [relative_hardness(slope) for slope in (0.222, 0.444, 0.889)] == [0.55, 1.0, 1.31]
    assert relative_hardness(np.sqrt(0.222 * 0.444)) == pytest.approx(0.775)
    assert np.isnan(relative_hardness(0.2))
    assert np.isnan(relative_hardness(1.0))


def test_factors_are_those_beside_the_runs_own_slope():
    as_steep = {**point(10, 3), "amplitude_nm": "1.2"}  # 0.889
    assert steepness([as_steep])["factor"] == pytest.approx([0.55 / 1.31, 1 / 1.31, 1.0], rel=1e-3)
    inputs = fit_size_effect(series(2, 8), GLASS, 0.05, h_macro, "scales")["inputs"]
    assert inputs["h_film"]["steepness"]["factor"] == pytest.approx([0.55, 1.0, 1.31], rel=2e-3)
    assert inputs["h_prime"]["steepness"]["factor"][0] < 0.55  # H_macro stays


def test_asperities_of_slopes_that_were_never_pressed_are_refused():
    result = fit_size_effect(
        [{**row, "amplitude_nm": "1.4"} for row in series(2, 8)], GLASS, 0.05, h_macro, "scales"
    )
    assert result["inputs"] == {}
    assert result["gate"]["reasons"] == [
        "asperities flatter or steeper than RMS slopes of 0.22 to 0.89"
    ]
