from dataclasses import replace

import numpy as np
import pytest

from atomistic.hardness.made_up_closings import (
    APPROACH_NM,
    CELL_AREA_NM2,
    TRAVEL_NM,
    curve,
    plateau,
    witness,
)
from atomistic.hardness.plateau import (
    RULES,
    find_hardness,
    interval_of_mean,
    may_stop,
    plastic_onset,
    point,
    settled,
)


def find(curve_rows, witness_rows):
    return find_hardness(curve_rows, witness_rows, CELL_AREA_NM2, APPROACH_NM)


def test_plateau_beyond_a_witnessed_onset():
    found = find(curve(plateau), witness())
    assert found.status == "yield"
    assert found.hardness_GPa == pytest.approx(10.0)
    assert found.hardness_lo <= 10.0 <= found.hardness_hi
    assert found.length_max_nm**2 <= RULES.max_area_fraction * CELL_AREA_NM2
    assert found.contact_length_nm > found.onset_length_nm
    assert found.same_shape_GPa == pytest.approx(10.0)
    assert 0.5 * 6 <= found.same_shape_length_nm <= 0.6 * 6  # of the cell's side


def test_a_contact_that_shrinks_for_a_moment_is_judged_on():
    length = np.maximum(0, 3.2 * (TRAVEL_NM - 0.25))
    first = int(np.argmax(length >= RULES.min_length_nm))
    length[first + 1] = RULES.min_length_nm - 0.01
    rows = curve(plateau, length)
    assert (
        find(rows, witness()).plateau_points == find(curve(plateau), witness()).plateau_points - 1
    )
    too_wide = (RULES.max_area_fraction * CELL_AREA_NM2) ** 0.5 + 0.1
    length[-12] = too_wide  # what comes after it is not used, however wide
    assert (
        find(curve(plateau, length), witness()).plateau_points
        < find(rows, witness()).plateau_points
    )


def test_background_of_bond_exchanges_is_measured_before_contact():
    """The halved energies flicker more: 20 exchanges per snapshot are then no witness, 40 are."""
    onset = plastic_onset(witness(background=20, after=5), 0.35)
    assert (onset.displacement_nm, onset.background) == (None, 20)
    onset = plastic_onset(witness(background=20, after=20), 0.35)
    assert onset.displacement_nm == pytest.approx(0.8)
    assert onset.exchanges == 40
    assert 0 < onset.p_value < 0.02


def test_p_value_of_the_onset_is_that_of_two_poisson_counts():
    """Equal rates: the p value is uniform or larger, so below 0.05 at most one time in twenty."""
    rng = np.random.default_rng(0)
    small, trials = 0, 0
    for _ in range(3000):
        counts = rng.poisson(8, 4)
        rows = [
            {
                "displacement_nm": 0.1 * (k + 1),
                "new_exchanges": new,
                "lowering_nm": 0.0 if k < 3 else 0.1,
            }
            for k, new in enumerate([0, *counts[:2], counts[2]])
        ]
        onset = plastic_onset(rows, 0.35)
        trials += 1
        small += onset.p_value < 0.05
    assert small / trials < 0.05


def test_a_point_names_what_was_pressed_and_what_it_cost():
    facts = {
        "run": "r", "energy_scale": 1.0, "amplitude_nm": 0.4, "film_nm": None, "asperity": "small",
        "wavelength_nm": 6.0, "seed": 1, "atoms": 100, "steps": 1000,
        "lammps_cpu_s": 9.0,
    }  # fmt: skip
    row = point(curve(plateau), witness(), facts, "pmmcs")
    assert (row["asperity"], row["potential"]) == ("small", "pmmcs")
    assert row["status"] == "yield"
    assert row["atom_steps"] == 100_000


@pytest.mark.parametrize(("correlation", "low", "high"), [(0.0, 0.63, 0.8), (0.6, 0.58, 0.75)])
def test_interval_holds_the_mean_of_correlated_noise_two_times_in_three(correlation, low, high):
    """Nominal 68 %; bounds: two standard errors of 600 trials about what 14 averages can tell."""
    rng = np.random.default_rng(4)
    held = 0
    for _ in range(600):
        values = np.empty(14)
        values[0] = rng.normal()
        for k in range(1, 14):
            values[k] = correlation * values[k - 1] + np.sqrt(1 - correlation**2) * rng.normal()
        lo, hi = interval_of_mean(10 + values)
        held += lo <= 10 <= hi
    assert low < held / 600 < high


def test_a_run_stops_on_a_narrow_interval_or_where_it_leaves_the_window():
    rows, seen = curve(plateau), witness(onset=0.8)
    cell = 9.0 / RULES.stop_area_fraction  # the contact of 3.0 nm takes up as much as is asked for

    def stops(count, cell_area=cell, stop="settled", **rules):
        return may_stop(rows[:count], seen, cell_area, stop, APPROACH_NM, replace(RULES, **rules))

    beyond = int(np.argmax(np.array([row["displacement_nm"] for row in rows]) >= 0.8))
    assert not stops(beyond + 5)  # the contact is still small
    assert stops(len(rows))
    assert not stops(len(rows), stop_points=len(rows))
    assert not stops(len(rows), stop="window")
    for stop in ("settled", "window"):
        # the last averages lie beyond half of the cell
        assert stops(len(rows), cell_area=10.0, stop=stop)
    rising = curve(lambda length: 4 * length)
    assert not may_stop(rising, seen, cell, "settled", APPROACH_NM)


def test_a_run_that_ends_before_its_rule_is_met_says_so():
    cell = 9.5 / RULES.stop_area_fraction  # the contact ends at 9 nm2
    found = find_hardness(curve(plateau), witness(), cell, APPROACH_NM)
    assert found.status.startswith(
        "rejected: stopped before its rule, on 0.24 of the cell instead of 0.25; "
    )


def test_a_wide_interval_is_no_reason_to_refuse_a_run_that_went_to_its_end():
    rng = np.random.default_rng(5)
    rough = find(curve(lambda length: plateau(length) * (1 + 0.3 * rng.normal())), witness())
    assert rough.status == "yield"
    assert rough.hardness_hi - rough.hardness_lo > 2 * RULES.stop_interval * rough.hardness_GPa


def test_a_plateau_begins_where_the_stress_has_settled():
    noise = 0.3 * np.random.default_rng(6).normal(size=30)
    level = np.full(30, 10.0)
    assert settled(level + noise) == 0
    rising = np.where(np.arange(30) < 8, 5 + 5 * np.arange(30) / 8, 10.0)
    assert 5 <= settled(rising + noise) <= 10
    assert settled(np.linspace(5, 20, 30)) == 0  # never settles: the exponent refuses it
