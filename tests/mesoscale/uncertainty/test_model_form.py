"""Both mechanics of the contact on the same surfaces: what is compared."""

import numpy as np
import pytest

from mesoscale.contact import Branch
from mesoscale.inputs.table import input_table
from mesoscale.settings import ContactSettings, LawSettings
from mesoscale.uncertainty.designs import random_runs
from mesoscale.uncertainty.model_form import (
    QUANTITIES,
    opening_stiffness,
    pair_rows,
    pull_off,
    shift_rows,
)


def opening(force, attraction=0.0) -> Branch:
    force = np.asarray(force, float)
    separation = np.linspace(20.0, 22.0, force.size)
    rest = np.zeros(force.size)
    return Branch(separation, force, np.full(force.size, -attraction), rest, rest, rest)


def test_stiffness_of_a_straight_unloading_is_its_slope():
    assert opening_stiffness(opening([100.0, 75.0, 50.0, 25.0, 0.0])) == pytest.approx(50.0)
    assert opening_stiffness(opening([100.0, 20.0, 0.0])) == pytest.approx(80.0)  # half lies within the first step
    assert np.isnan(opening_stiffness(opening([0.0, 0.0])))


def test_pull_off_is_what_attraction_holds_beyond_repulsion():
    assert pull_off(opening([100.0, 10.0, 0.0], attraction=30.0)) == 30.0
    assert pull_off(opening([100.0, 50.0], attraction=30.0)) == 0.0


def made_up(correlation: float, count: int = 400, cost: float = 20.0) -> list[dict[str, str]]:
    """Pairs of normal numbers, coupled 1 higher than on their own."""
    rng = np.random.default_rng(1)
    own, other = rng.normal(size=(2, count))
    both = {"asperity": 5.0 + own, "coupled": 6.0 + correlation * own + np.sqrt(1 - correlation**2) * other}
    return [
        {f"{name}_{row.name}": str(values[k]) for name, values in both.items() for row in QUANTITIES}
        | {"asperity_cpu_s": "1.0", "coupled_cpu_s": str(cost)}
        for k in range(count)
    ]


def test_shift_lies_in_its_interval():
    row = next(shift_rows(made_up(0.9)))
    assert row["shift_low"] < 1.0 < row["shift_high"]
    assert row["correlation"] == pytest.approx(0.9, abs=0.02)
    assert row["cost_ratio"] == 20.0


def test_a_quantity_that_both_give_alike_has_no_shift():
    rows = made_up(0.5)
    for row in rows:
        row["coupled_d_c_nm"] = row["asperity_d_c_nm"]
    assert next(shift_rows(rows))["shift"] == 0.0


def test_pairs_share_inputs_and_surface():
    runs = random_runs(input_table(), 0, 2)
    rows = list(pair_rows(runs, ContactSettings(pixels=64), LawSettings()))
    for row in rows:
        assert row["asperity_d_c_nm"] == row["coupled_d_c_nm"]  # where the same surface first touches
        assert row["coupled_opening_stiffness_nN_nm"] != row["asperity_opening_stiffness_nN_nm"]
