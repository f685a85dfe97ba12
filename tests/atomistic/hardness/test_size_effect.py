import numpy as np
import pytest

from atomistic.hardness.size_effect import (
    BERKOVICH,
    energy_range,
    fit_size_effect,
    literature_samples,
    relative_hardness,
    rms_slope,
    steepness,
)

GLASS = [{"gate": {"passed": True, "reasons": []}}]
BOTH = (1.0, 0.5)  # energy scales


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
    points = [point(1.0 * scale, 3 + k, scale, asperity=f"a{k}") for scale in (1.0, 0.5) for k in range(4)]
    result = fit_size_effect(points, GLASS, BOTH, 0.05)
    assert not result["gate"]["passed"]
    assert "not identifiable" in result["gate"]["reasons"][-1]


def test_literature_h_macro_gives_the_hand_calculation():
    """10.6 and 5.3 GPa at 3 nm with H_macro 1.95 GPa: H' = 15.0 and 5.8 GPa nm^0.5."""
    for hardness, expected in ((10.6, 15.0), (5.3, 5.8)):
        h_macro, h_prime, h_film = literature_samples([point(hardness, 3.0, spread=0.0)], (1.9499, 1.9501), {}, (1, 1))
        assert np.ptp(h_macro) < 1e-3
        assert np.mean(h_prime) == pytest.approx(expected, abs=0.05)
        np.testing.assert_allclose(h_film, hardness)


def test_runs_of_scaled_energies_count_as_those_of_full_ones():
    """Twins at half of the energies have half of the hardness; the range of energies spreads both alike."""
    points = [point(10, 4, 1.0, spread=0.0)] * 9 + [point(5, 4, 0.5, spread=0.0)]
    _, _, h_film = literature_samples(points, (0.7, 0.7001), {}, (0.8, 1.2), 4000)
    assert (h_film.min(), h_film.max()) == pytest.approx((8, 12), rel=1e-3)
    assert np.mean(h_film < 9) == pytest.approx(0.25, abs=0.02)


def test_energies_bound_the_measured_hardness_at_the_slope_of_the_tip():
    slopes = steepness(series(2, 8))
    low, high = energy_range(10.0, slopes, (6.0, 12.0))
    # at the tip's slope the runs are softer than at their own
    for energies, measured in ((low, 6.0), (high, 12.0)):
        assert 10.0 * energies * relative_hardness(BERKOVICH) == pytest.approx(measured, rel=2e-3)
    assert energy_range(10.0, slopes, (9.9, 12.0))[0] == 1.0  # the potential as published is never left out
    assert energy_range(10.0, slopes, None, (0.5, 1.0)) == (0.5, 1.0)


def test_gate_counts_defended_points_and_names_the_reason():
    refused = [point(0, 0, status="no_yield", asperity=f"n{k}") for k in range(8)]
    result = fit_size_effect(series(2, 8)[:3] + refused, GLASS, BOTH, 0.05)
    assert not result["gate"]["passed"]
    assert "3 of 11 runs" in result["gate"]["reasons"][0]
    assert any("energy scale 0.5" in reason for reason in result["gate"]["reasons"])
    assert len(result["points_rejected"]) == 8
    nothing = fit_size_effect(refused, GLASS, BOTH, 0.05)
    assert nothing["inputs"] == {}
    assert not nothing["gate"]["passed"]


def test_a_failed_glass_fails_the_gate():
    bad = [{"gate": {"passed": False, "reasons": ["SiO2 glass: density 3 outside"]}}]
    assert not fit_size_effect(series(2, 8), bad, BOTH, 0.05)["gate"]["passed"]


def test_the_slope_of_an_asperity_is_that_of_its_surface():
    x = 2 * np.pi * np.arange(600) / 600
    heights = 0.6 * np.minimum(*np.meshgrid(np.sin(x), np.sin(x)))
    along, across = ((heights - np.roll(heights, 1, axis)) / (6 / 600) for axis in (0, 1))
    assert rms_slope(point(10, 3)) == pytest.approx(np.sqrt(np.mean(along**2 + across**2)), rel=0.01)


def test_hardness_at_a_slope_is_straight_between_the_runs_and_unknown_beyond():
    assert [relative_hardness(slope) for slope in (0.222, 0.444, 0.889)] == [0.55, 1.0, 1.31]
    assert relative_hardness(np.sqrt(0.222 * 0.444)) == pytest.approx(0.775)
    assert np.isnan(relative_hardness(0.2))
    assert np.isnan(relative_hardness(1.0))


def test_factors_are_those_beside_the_runs_own_slope():
    as_steep = {**point(10, 3), "amplitude_nm": "1.2"}  # 0.889
    assert steepness([as_steep])["factor"] == pytest.approx([0.55 / 1.31, 1 / 1.31, 1.0], rel=1e-3)
    inputs = fit_size_effect(series(2, 8), GLASS, BOTH, 0.05)["inputs"]
    assert inputs["h_film"]["steepness"]["factor"] == pytest.approx([0.55, 1.0, 1.31], rel=2e-3)
    assert inputs["h_prime"]["steepness"]["factor"][0] < 0.55  # H_macro stays


def test_asperities_of_slopes_that_were_never_pressed_are_refused():
    result = fit_size_effect([{**row, "amplitude_nm": "1.4"} for row in series(2, 8)], GLASS, BOTH, 0.05)
    assert result["inputs"] == {}
    assert result["gate"]["reasons"] == ["asperities flatter or steeper than RMS slopes of 0.22 to 0.89"]
