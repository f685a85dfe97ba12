"""The accuracy table of the law's uncertainty, on made-up runs of known scatter."""

import numpy as np
import pytest

from mesoscale.inputs.distributions import Distribution, InputTable, UncertainInput
from mesoscale.law.parameters import FITTED, LAW_OUTPUTS
from mesoscale.settings import ContactSettings, UncertaintySettings
from mesoscale.studies import uncertainty_accuracy
from mesoscale.studies.driver import Cost
from mesoscale.studies.uncertainty_accuracy import accuracy_points
from mesoscale.uncertainty.collocation import nodes, to_values
from mesoscale.uncertainty.propagation import NodeOutputs

TABLE = InputTable(
    tuple(
        UncertainInput(name, "1", Distribution("uniform", 0.0, 1.0), "literature", "")
        for name in ("a", "b")
    ),
    np.eye(2),
)
SCATTER = 0.5
RUNS, SEEDS = 800, 8


def law_of(x, scatter):
    """Every parameter is 10 + a + 2 b and the scatter of its cell."""
    return np.repeat((10 + x @ np.array([1.0, 2.0]) + scatter)[..., None], len(FITTED), axis=-1)


@pytest.fixture(scope="module")
def rows():
    rng = np.random.default_rng(2)
    x = TABLE.sample(RUNS, 3)
    direct = x, law_of(x, SCATTER * rng.normal(size=RUNS))
    again = law_of(x[:100], SCATTER * rng.normal(size=100))
    at_nodes = to_values(nodes(2), TABLE.ranges())
    by_seed = np.array([law_of(at_nodes, SCATTER * rng.normal()) for _ in range(SEEDS)])
    settings = UncertaintySettings(direct_runs=RUNS, opening_contact="free")
    of_nodes = NodeOutputs(list(range(SEEDS)), by_seed)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(uncertainty_accuracy, "cost_of_cycle", lambda *_: Cost(0.1, 0.1, 100.0))
        return list(
            accuracy_points(
                direct, again, of_nodes, TABLE, ContactSettings(mechanics="asperity"), settings
            )
        )


DEVIATION = np.sqrt(5 / 12 + SCATTER**2)


def test_the_error_of_the_mean_falls_with_the_root_of_the_runs(rows):
    """Of scatter 0.5 in 800 runs 0.0177 remain, 2.2 % of the deviation of cells."""
    errors = {
        row["value"]: row["error"]
        for row in rows
        if row["knob"] == "direct runs" and row["case"] == "mean d_c"
    }
    exact = {count: 100 * SCATTER / np.sqrt(count) / DEVIATION for count in errors}
    # the root mean square of 4 splits scatters by a third
    assert all(errors[count] == pytest.approx(exact[count], rel=1.0) for count in errors)
    assert errors[800] < errors[50]


def test_surfaces_at_the_nodes_have_the_standard_error_of_their_scatter(rows):
    (error,) = [
        row["error"]
        for row in rows
        if row["knob"] == "surfaces at the nodes" and row["shipped"] and row["case"] == "mean C_r"
    ]
    # 8 values tell their scatter to a quarter
    assert error == pytest.approx(100 * SCATTER / np.sqrt(SEEDS) / DEVIATION, rel=0.6)


def test_a_linear_law_needs_no_higher_degree(rows):
    """What the scatter between surfaces does not explain is small, and the same for every
    degree.
    """
    told = {
        row["value"]: (row["error"], row["own_error"])
        for row in rows
        if row["knob"] == "degree of the responses" and row["case"] == "C_r on closing"
    }
    assert set(told) == {1, 2, 3}
    scatter = 100 * SCATTER / DEVIATION
    for error, own_error in told.values():
        # 100 pairs tell the scatter to a tenth of its square
        assert error < 0.5 * scatter
        assert own_error < 0.5 * scatter


def test_costs_are_those_of_the_cycles(rows):
    costs = {row["value"]: row["cpu_s"] for row in rows if row["knob"] == "direct runs"}
    assert costs[800] >= 800 * 0.1
    assert {row["knob"] for row in rows} == {
        "direct runs",
        "degree of the responses",
        "surfaces at the nodes",
    }
    assert {row["case"] for row in rows if row["knob"] == "surfaces at the nodes"} == {
        f"mean {row.short}" for row in LAW_OUTPUTS
    }
