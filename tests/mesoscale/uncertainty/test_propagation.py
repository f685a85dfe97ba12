"""Propagation, sensitivity and validation on functions whose answers are known."""

import csv
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from mesoscale.inputs.distributions import (
    Distribution,
    InputTable,
    UncertainInput,
    correlation_matrix,
)
from mesoscale.law.parameters import OUTPUTS, PARAMETERS
from mesoscale.settings import UncertaintySettings
from mesoscale.uncertainty.collocation import nodes, to_values
from mesoscale.uncertainty.paper_tables import table2, table3
from mesoscale.uncertainty.propagation import (
    NodeOutputs,
    linear_outputs,
    nodes_of_rows,
    output_rows,
    propagate,
    surrogate_json,
)
from mesoscale.uncertainty.sensitivity import pick_freeze, sensitivity_rows, sobol_indices
from mesoscale.uncertainty.validation import validation_rows
from tests.mesoscale.uncertainty.surrogate_reader import from_json

PAPER = Path(__file__).parents[3] / "config" / "paper"
NONE_AGAIN = np.empty((0, 8))
"""No run is repeated on a second surface."""
MOST_GPA = 0.007
SETTINGS = UncertaintySettings()
NO_RUNS = np.empty((0, 3)), np.empty((0, 8))


def uniform_table(inputs=3, correlation=None):
    rows = tuple(
        UncertainInput(f"x{k}", "1", Distribution("uniform", 0.0, 1.0), "literature", "")
        for k in range(inputs)
    )
    return InputTable(rows, np.eye(inputs) if correlation is None else correlation)


def linear_nodes(table, slopes, seeds=6, scatter=0.0):
    """Node outputs y_k = 10 + x . slopes (closing), opening twice that; a seed shifts all nodes
    alike.
    """
    x = to_values(nodes(len(table.rows)), table.ranges())
    base = 10 + x @ np.asarray(slopes, float)
    shifts = scatter * np.linspace(-1, 1, seeds)
    closing = base + shifts[:, None]
    return NodeOutputs(list(range(seeds)), np.stack([closing] * 4 + [2 * closing] * 4, axis=-1))


def linear_runs(table, slopes, count=400):
    """Direct runs of the same function without scatter."""
    x = table.sample(count, 9)
    closing = 10 + x @ np.asarray(slopes, float)
    return x, np.stack([closing] * 4 + [2 * closing] * 4, axis=1)


def paper_rows(name):
    with (PAPER / name).open(newline="") as stream:
        return list(csv.DictReader(stream))


def test_mean_and_deviation_of_a_linear_function():
    table = uniform_table()
    result = propagate(linear_nodes(table, [1, 2, 3]), table, SETTINGS, NO_RUNS)
    exact = np.sqrt(14 / 12)
    # Monte Carlo with 10,000 samples: 1 % of the deviation
    assert result.by_seed[0, 0, 0] == pytest.approx(13, abs=4 * exact / np.sqrt(10_000))
    assert result.by_seed[0, 1, 0] == pytest.approx(exact, rel=0.06)
    assert result.seed_share == pytest.approx(np.zeros(8), abs=1e-9)


def test_seed_share_of_a_seed_that_shifts_everything():
    table = uniform_table()
    nodes_given = linear_nodes(table, [1, 2, 3], seeds=40, scatter=2.0)
    result = propagate(nodes_given, table, SETTINGS, NO_RUNS)
    within = np.var(2 * np.linspace(-1, 1, 40), ddof=1)
    assert result.seed_share[0] == pytest.approx(within / (within + 14 / 12), rel=0.06)


def test_missing_nodes_are_counted_and_not_filled():
    table = uniform_table()
    given = linear_nodes(table, [1, 2, 3], seeds=4)
    given.values[1, 2, 3] = np.nan
    result = propagate(given, table, SETTINGS, NO_RUNS)
    row = {r["output"]: r for r in output_rows(given, result, NO_RUNS, {}, {})}["rho_r_nm"]
    assert (row["missing"], row["seeds_used"], row["seeds"]) == (1, 3, 4)
    assert row["mean"] == pytest.approx(13, abs=0.1)
    given.values[:, 0, 3] = np.nan
    result = propagate(given, table, SETTINGS, NO_RUNS)
    row = {r["output"]: r for r in output_rows(given, result, NO_RUNS, {}, {})}["rho_r_nm"]
    assert row["seeds_used"] == 0
    assert np.isnan(row["mean"])


def test_one_input_and_twelve_inputs():
    for inputs in (1, 12):
        table, no_runs = uniform_table(inputs), (np.empty((0, inputs)), np.empty((0, 8)))
        given = linear_nodes(table, np.ones(inputs))
        row = output_rows(given, propagate(given, table, SETTINGS, no_runs), no_runs, {}, {})[0]
        assert row["dev"] == pytest.approx(np.sqrt(inputs / 12), rel=0.06)


def test_all_equal_outputs_have_no_spread_and_no_indices():
    table = uniform_table()
    given, direct = linear_nodes(table, [0, 0, 0]), linear_runs(table, [0, 0, 0])
    row = output_rows(given, propagate(given, table, SETTINGS, direct), direct, {}, {})[0]
    assert row["dev"] == pytest.approx(0, abs=1e-12)
    indices = sensitivity_rows(given, table, SETTINGS, np.zeros(8), {}, {}, direct)
    assert all(r["mu_star"] == pytest.approx(0, abs=1e-12) for r in indices)
    assert all(np.isnan(r["sobol_first"]) for r in indices)


def test_sobol_indices_of_a_linear_function():
    table = uniform_table()
    direct = linear_runs(table, [1, 2, 3])
    rows = sensitivity_rows(
        linear_nodes(table, [1, 2, 3]), table, SETTINGS, np.zeros(8), {}, {}, direct
    )
    for row in rows[:3]:
        exact = {"x0": 1 / 14, "x1": 4 / 14, "x2": 9 / 14}[row["input"]]
        assert row["sobol_first"] == pytest.approx(exact, abs=0.02)
        assert row["sobol_total"] == pytest.approx(exact, abs=0.02)
        assert row["sobol_total_low"] <= row["sobol_total"] <= row["sobol_total_high"]
    # docs/uncertainty.md
    assert sum(row["sobol_first"] for row in rows[:3]) == pytest.approx(1.0, abs=0.02)


def test_sobol_estimators_on_ishigami():
    """Ishigami's function (a 7, b 0.1): first 0.3139, 0.4424, 0; total 0.5576, 0.4424, 0.2437."""
    table = uniform_table(3)
    x = (2 * pick_freeze(table, 16384, 1) - 1) * np.pi
    y = np.sin(x[..., 0]) + 7 * np.sin(x[..., 1]) ** 2 + 0.1 * x[..., 2] ** 4 * np.sin(x[..., 0])
    first, total = sobol_indices(y[0], y[1], y[2:])
    assert first == pytest.approx([0.3139, 0.4424, 0.0], abs=0.02)
    assert total == pytest.approx([0.5576, 0.4424, 0.2437], abs=0.02)


def test_correlation_widens_the_sum_and_narrows_the_difference():
    correlation = correlation_matrix(["x0", "x1"], {("x0", "x1"): 0.8})
    free, bound = uniform_table(2), uniform_table(2, correlation)
    for slopes, wider in (([1, 1], True), ([1, -1], False)):
        none = np.empty((0, 2)), np.empty((0, 8))
        deviations = [
            propagate(linear_nodes(t, slopes), t, SETTINGS, none).by_seed[0, 1, 0]
            for t in (free, bound)
        ]
        assert (deviations[1] > 1.2 * deviations[0]) == wider
        assert (deviations[1] < 0.6 * deviations[0]) == (not wider)


def test_zero_width_inputs():
    table = uniform_table(2)
    fixed = UncertainInput("x1", "1", Distribution("fixed", 0.5), "literature", "")
    table = InputTable((table.rows[0], fixed), np.eye(2))
    given, direct = linear_nodes(table, [1, 1]), linear_runs(table, [1, 1])
    result = propagate(given, table, SETTINGS, direct)
    assert result.by_seed[0, 1, 0] == pytest.approx(1 / np.sqrt(12), rel=0.06)
    rows = sensitivity_rows(given, table, SETTINGS, np.zeros(8), {}, {}, direct)
    assert rows[1]["mu_star"] == pytest.approx(0, abs=1e-12)


def test_surrogate_json_reproduces_the_propagated_values():
    table = uniform_table()
    given = linear_nodes(table, [1, 2, 3])
    result = propagate(given, table, SETTINGS, linear_runs(table, [1, 2, 3]))
    content = surrogate_json(result, table, {"rho_a_nm": 2.0, "alpha_nm": 2.0})
    assert [o["name"] for o in content["outputs"]][:2] == ["closing_d_c_nm", "closing_C_a_GPa_nm"]
    for k, output in enumerate(content["outputs"]):
        assert from_json(content)[output["name"]](result.samples[:5]) == pytest.approx(
            result.outputs[:5, k]
        )


def test_validation_of_a_perfect_response():
    table = uniform_table()
    given, (x, direct) = linear_nodes(table, [1, 2, 3]), linear_runs(table, [1, 2, 3])
    result = propagate(given, table, SETTINGS, (x, direct))
    row = validation_rows((x, direct), table, result, SETTINGS, NONE_AGAIN, MOST_GPA)[0]
    assert row["q2"] == pytest.approx(1)
    assert row["bias"] == pytest.approx(0, abs=1e-9)
    output = output_rows(given, result, (x, direct), {}, {})[0]
    assert output["cell_q50"] == np.median(direct[:, 0])
    # 400 and 10,000 samples of the same response
    assert output["cell_dev"] == pytest.approx(output["response_dev"], rel=4 / np.sqrt(2 * 400))


def test_validation_without_runs_reports_none():
    table = uniform_table()
    given = linear_nodes(table, [1, 2, 3])
    result = propagate(given, table, SETTINGS, NO_RUNS)
    rows = validation_rows(
        (np.empty((0, 3)), np.empty((0, 8))), table, result, SETTINGS, NONE_AGAIN, MOST_GPA
    )
    assert [row["runs"] for row in rows] == [0] * 8
    assert set(rows[0]) == {"output", "unit", "runs", "missing"}


def test_nodes_are_read_by_seed_and_branch():
    rows = [
        {
            "seed": str(seed),
            "node": str(node),
            "branch": branch,
            **dict.fromkeys(PARAMETERS, str(10 * seed + node)),
        }
        for seed in (4, 5)
        for node in (0, 1, 2)
        for branch in ("closing", "opening")
    ]
    rows[-1]["C_r_GPa"] = ""
    given = nodes_of_rows(rows)
    assert given.seeds == [4, 5]
    assert given.values[1, 1].tolist() == [51.0] * 8
    assert np.isnan(given.values[1, 2, 6])
    assert np.isnan(given.paper_outputs[1, 2, 6])


def test_the_papers_tables_agree_with_each_other_only_with_labels_exchanged():
    """dev = sqrt(sum mu*^2 / 12) within 3 %, the rounding of the tables."""
    two, three = table2(paper_rows("table2.csv")), table3(paper_rows("table3.csv"))
    for output in ("d_c", "C_a", "C_r", "rho_r", "delta_d_c", "delta_rho_r"):
        from_effects = np.sqrt(sum(value**2 for value in three[output].values()) / 12)
        assert from_effects == pytest.approx(two[output][1], rel=0.03), output
    printed = table3(paper_rows("table3.csv"), as_printed=True)
    assert np.sqrt(sum(v**2 for v in printed["C_a"].values()) / 12) > 2 * two["C_a"][1]


def test_outputs_are_the_papers_columns():
    assert len(OUTPUTS) == 8
    rows = output_rows(
        linear_nodes(uniform_table(), [1, 2, 3]),
        propagate(linear_nodes(uniform_table(), [1, 2, 3]), uniform_table(), SETTINGS, NO_RUNS),
        NO_RUNS,
        table2(paper_rows("table2.csv")),
        table2(paper_rows("table2.csv"), exchanged=True),
    )
    by_name = {row["output"]: row for row in rows}
    assert by_name["C_a_GPa_nm"]["paper_mean"] == pytest.approx(15.1e-5)
    assert by_name["delta_C_r_GPa"]["paper_mean"] == pytest.approx(2.76e-4)
    assert by_name["delta_C_r_GPa"]["paper_mean_exchanged"] == pytest.approx(5.5e-5)


def test_positive_outputs_stay_positive_where_the_linear_response_does_not():
    """y = exp(4 x0): the paper's linear response is negative over part of the range."""
    table = uniform_table()
    x = to_values(nodes(3), table.ranges())
    values = np.repeat(np.exp(4 * x[:, :1]), 8, axis=1)
    samples = table.sample(200, 5)
    direct = (samples, np.repeat(np.exp(4 * samples[:, :1]), 8, axis=1))
    assert (linear_outputs(values, table.ranges(), samples)[:, 1] < 0).any()
    result = propagate(NodeOutputs([0, 1], np.stack([values, values])), table, SETTINGS, direct)
    assert (result.outputs[:, 1] > 0).all()
    assert result.outputs[:, 1] == pytest.approx(np.exp(4 * result.samples[:, 0]), rel=1e-6)
    # exact in the logarithm; the mean of the linear response is that of Simpson's rule (here 14 %
    # too high)
    exact = (np.exp(4) - 1) / 4
    assert result.outputs[:, 1].mean() == pytest.approx(exact, rel=0.1)


def test_regression_recovers_the_mean_over_noise_and_reports_intervals():
    table = uniform_table()
    rng = np.random.default_rng(2)
    x = table.sample(300, 6)
    truth = 5 + x @ [1.0, 2.0, 3.0]
    noisy = truth[:, None] + rng.normal(0, 0.3, (300, 8))
    given = linear_nodes(table, [1, 2, 3])
    result = propagate(given, table, SETTINGS, (x, noisy))
    expected = 5 + result.samples @ [1.0, 2.0, 3.0]
    # standard error of a coefficient: 0.3/sqrt(300) = 0.017, a handful of terms
    assert result.outputs[:, 0] == pytest.approx(expected, abs=0.25)
    row = validation_rows((x, noisy), table, result, SETTINGS, NONE_AGAIN, MOST_GPA)[0]
    best = 1 - 0.3**2 / noisy[:, 0].var()
    assert best - 0.05 < row["q2"] < best + 0.03
    first = sensitivity_rows(given, table, SETTINGS, np.zeros(8), {}, {}, (x, noisy))[2]
    assert first["sobol_first_low"] < 9 / 14 < first["sobol_first_high"] + 0.02


def test_a_small_change_of_a_large_output_has_the_indices_of_the_change():
    """Closing falls over two decades with x0 and scatters by 30 %; the change on opening depends on
    x1 and x2 alone.
    """
    table = uniform_table()
    x = table.sample(800, 7)
    scatter = np.random.default_rng(3).lognormal(0, 0.3, 800)
    closing = 10 * np.exp(-5 * x[:, 0]) * scatter
    opening = closing + 1 + x @ [0.0, 1.0, 2.0]
    direct = (x, np.stack([closing] * 4 + [opening] * 4, axis=1))
    rows = sensitivity_rows(
        linear_nodes(table, [1, 2, 3]), table, SETTINGS, np.zeros(8), {}, {}, direct
    )
    found = [row["sobol_first"] for row in rows if row["output"] == "delta_C_a_GPa_nm"]
    assert found == pytest.approx([0.0, 0.2, 0.8], abs=0.02)


def test_an_input_without_effect_has_an_index_near_zero_with_an_interval():
    table = uniform_table()
    x = table.sample(400, 8)
    noisy = (x @ [1.0, 2.0, 0.0])[:, None] + np.random.default_rng(4).normal(5, 0.5, (400, 8))
    rows = sensitivity_rows(
        linear_nodes(table, [1, 2, 0]), table, SETTINGS, np.zeros(8), {}, {}, (x, noisy)
    )
    for row in rows[:12]:  # the four closing parameters; here nothing changes on opening
        assert row["sobol_total_high"] > row["sobol_total_low"]
        if row["input"] == "x2":
            # the slope's variance by chance is 12 * 0.25 / 400, squares to 0.0015 of the others' 1
            # + 4; tail of chi^2
            assert 0 < row["sobol_total"] < 0.03


def test_too_few_runs_give_no_regression_response():
    table = uniform_table()
    x = table.sample(5, 1)
    result = propagate(linear_nodes(table, [1, 2, 3]), table, SETTINGS, (x, np.ones((5, 8))))
    assert result.responses == [None] * 8
    assert np.isnan(result.outputs).all()


def falling_contacts(inputs: int, runs: int = 300):
    """Runs whose last contact is a little below the first where the inputs are small, and far below
    where large.
    """
    rng = np.random.default_rng(5)
    x = rng.random((runs, inputs))
    scatter = np.exp(0.3 * rng.standard_normal((runs, 2)))
    closing = 5.0 + 30.0 * x[:, 0] * scatter[:, 0]
    drop = 6.0 * x[:, 0] ** 3 * x[:, 1] ** 2 * scatter[:, 1]
    return x, np.stack([closing] * 4 + [closing - drop, *[closing] * 3], axis=1)


def test_opening_never_starts_above_closing():
    """At all 128 corners and inside; responses of their own cross there."""
    table = uniform_table(7)
    x, y = falling_contacts(7)
    given = linear_nodes(table, np.ones(7))
    corners = np.array(list(product((0.0, 1.0), repeat=7)))
    inside = np.random.default_rng(6).random((4000, 7))

    def change(settings, at):
        result = propagate(given, table, settings, (x, y))
        closing, opening = result.responses[0], result.responses[4]
        assert closing
        assert opening
        return opening(at) - closing(at), result

    free = UncertaintySettings(opening_contact="free")
    assert (change(free, corners)[0] > 0).sum() > 10
    ordered = free.model_copy(update={"opening_contact": "below_closing"})
    changes, result = change(ordered, np.concatenate([corners, inside]))
    assert (changes < 0).all()
    content = surrogate_json(result, table, {})
    again = from_json(content)["opening_d_c_nm"]
    assert again(corners) == pytest.approx(result.responses[4](corners), rel=1e-12)
    assert "below" in content["outputs"][4]
    assert "less this" in content["about"]


def test_a_contact_that_keeps_its_shape_opens_where_it_closed():
    """Elastic: the drop is 0 in every run; the response is at most a hundredth of a nanometre
    below.
    """
    table = uniform_table(3)
    x, y = falling_contacts(3, 100)
    y[:, 4] = y[:, 0]
    result = propagate(linear_nodes(table, [1, 2, 3]), table, SETTINGS, (x, y))
    assert result.responses[0](x) - result.responses[4](x) == pytest.approx(np.full(100, 0.01))
