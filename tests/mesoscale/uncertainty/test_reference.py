"""Truth by brute force, and the errors of responses against it, on functions whose answers are known."""

import numpy as np
import pytest

from mesoscale.inputs.distributions import Distribution, InputTable, UncertainInput
from mesoscale.settings import UncertaintySettings
from mesoscale.uncertainty.collocation import nodes, to_values
from mesoscale.uncertainty.morris import trajectory_points
from mesoscale.uncertainty.propagation import NodeOutputs
from mesoscale.uncertainty.reference import GROUPS, explained_by, jackknife, reference
from mesoscale.uncertainty.studies.brute_force import bias_rows, index_rows
from mesoscale.uncertainty.studies.comparison import compare_with_direct_runs
from mesoscale.uncertainty.studies.precision import accuracy_points, precision_rows
from mesoscale.uncertainty.surrogate import Surrogate, with_scatter

SLOPES = np.array([1.0, 2.0, 3.0])
NOISE = 0.5
SETTINGS = UncertaintySettings(samples=2000, sobol_samples=256, sobol_bootstrap=4, direct_runs=100, bootstrap=50)


@pytest.fixture(scope="module")
def table():
    given = Distribution("uniform", 0.0, 1.0)
    return InputTable(tuple(UncertainInput(f"x{k}", "1", given, "literature", "") for k in range(3)), np.eye(3))


@pytest.fixture(scope="module")
def runs(table):
    """Inputs, outputs with the noise of their surfaces, and replicates; opening is twice closing."""
    rng = np.random.default_rng(4)
    x = table.sample(1000, 2)

    def outputs(points):
        closing = 10 + points @ SLOPES + rng.normal(0, NOISE, len(points))
        return np.repeat(closing[:, None], 8, axis=1) * np.array([1.0] * 4 + [2.0] * 4)

    return x, outputs(x), outputs(x[:400])


def test_the_variance_is_split_into_inputs_and_surface(runs):
    truth = reference(*runs)
    # 400 pairs know a variance to sqrt(2/400) = 7 %, 1000 runs theirs to 5 %
    assert truth.surface_variance.value[0] == pytest.approx(NOISE**2, rel=0.25)
    assert truth.input_variance.value[0] == pytest.approx(14 / 12, rel=0.2)
    assert truth.input_variance.low[0] < 14 / 12 < truth.input_variance.high[0]


def test_first_order_indices_of_scattered_runs(runs):
    truth = reference(*runs)
    exact = SLOPES**2 / 14
    assert np.abs(truth.first.value[0] - exact).max() < 3 * truth.first.error[0].max()
    assert truth.first.error[0].max() < 0.06


def test_an_input_without_effect_has_index_zero():
    rng = np.random.default_rng(1)
    shares = [explained_by(rng.random(500), rng.random(500)) for _ in range(40)]
    # the noise between bins is taken off: the mean over 40 tries is known to 0.01
    assert np.mean(shares) == pytest.approx(0.0, abs=0.02)
    assert explained_by(np.zeros(500), rng.random(500)) == 0.0
    assert np.isnan(explained_by(rng.random(500), np.ones(500)))


def test_jackknife_error_of_a_mean():
    y = np.random.default_rng(0).normal(size=4000)
    found = jackknife(lambda chosen: y[chosen].mean(), len(y))
    # the error of an error from 20 groups is 1/sqrt(38) = 16 %
    assert found.error == pytest.approx(1 / np.sqrt(4000), rel=0.5)
    assert np.isnan(jackknife(lambda chosen: y[chosen].mean(), GROUPS).error)


def test_missing_runs_are_counted_and_left_out(runs):
    x, y, again = runs
    holed = y.copy()
    holed[:50, 2] = np.nan
    truth = reference(x, holed, again)
    assert truth.missing.tolist() == [0, 0, 50, 0, 0, 0, 50, 0]
    assert truth.statistics["mean"].value[2] == pytest.approx(np.nanmean(holed[:, 2]))


def test_scatter_gives_single_cells_the_variance_of_the_runs(runs):
    x, y, _ = runs
    ranges = np.array([[0.0, 1.0]] * 3)
    degrees = np.vstack([np.zeros((1, 3), int), np.eye(3, dtype=int)])
    response = Surrogate(ranges, degrees, np.array([13.0, 0.5, 1.0, 1.5]))
    cells = with_scatter(np.repeat(response(x)[:, None], 8, axis=1), [response] * 4 + [None] * 4, (x, y), False, 1)
    assert cells[:, 0].var() == pytest.approx(y[:, 0].var(), rel=0.1)
    # drawn together: outputs with equal residuals stay equal
    assert cells[:, 1] == pytest.approx(cells[:, 0])
    assert np.isnan(cells[:, 4:]).all()
    assert np.isnan(with_scatter(cells[:, :], [response] * 8, (x[:5], y[:5]), False, 1)).all()


def given_nodes(table, seeds=4):
    values = 10 + to_values(nodes(3, 1), table.ranges(0.999)) @ SLOPES
    shifts = np.linspace(-0.1, 0.1, seeds)[:, None]
    return NodeOutputs(list(range(seeds)), np.stack([values + shifts] * 4 + [2 * (values + shifts)] * 4, axis=-1))


def test_a_linear_engine_has_no_bias_at_level_1(table, runs):
    truth = reference(*runs)
    rows = bias_rows(given_nodes(table), runs[:2], truth, table, SETTINGS)
    assert len(rows) == 8
    first = rows[0]
    # a 90 % interval may miss; twice its half width hardly does
    half = first["mean_level1_bias_high"] - first["mean_level1_bias"]
    assert abs(first["mean_level1_bias"]) < 2 * half
    # level 1 knows the inputs' part of the deviation alone
    assert first["dev_level1"] == pytest.approx(first["input_dev"], rel=0.15)
    assert first["surface_share"] == pytest.approx(NOISE**2 / (NOISE**2 + 14 / 12), rel=0.3)


def test_indices_of_the_default_response_agree_with_brute_force(table, runs):
    rows = index_rows(given_nodes(table), runs[:2], reference(*runs), table, SETTINGS)
    for row, exact in zip(rows[:3], SLOPES**2 / 14, strict=True):
        assert row["total_direct"] == pytest.approx(exact, abs=0.05)
        assert row["first_response_low"] <= row["first_response"] + 0.05


def test_errors_fall_with_the_calls(table, runs):
    settings = SETTINGS.model_copy(update={"samples": 500})
    few = (runs[0][:200], runs[1][:200])
    truth = reference(*runs)
    rows = precision_rows(given_nodes(table), few, truth, table, settings, 0.1)
    sampled = {
        row["engine_calls"]: row["error"]
        for row in rows
        if (row["method"], row["output"], row["statistic"]) == ("regression, degree 1", "d_c_nm", "dev")
    }
    assert sampled[100] < sampled[25]
    assert {row["engine_cpu_s"] for row in rows if row["engine_calls"] == 100} == {10.0}
    summary = list(accuracy_points(rows, truth))
    assert len(summary) < len(rows)


def test_all_tables_of_the_study_agree_on_a_linear_engine(table, runs):
    settings = SETTINGS.model_copy(update={"samples": 500, "morris_trajectories": 4})
    few = (runs[0][:200], runs[1][:200])
    ranges = table.ranges(settings.central_share)
    points = trajectory_points(3, 4, settings.sample_seed).reshape(-1, 3)
    along = 10 + (ranges[:, 0] + points * np.diff(ranges).T) @ SLOPES
    timings = [{"engine_cpu_s": "1.5", "cycles": "10"}, {"engine_cpu_s": "0.5", "cycles": "10"}]
    printed = {"d_c": {table.names[0]: 0.7}}
    tables = compare_with_direct_runs(
        given_nodes(table),
        few,
        runs[2][:200],
        np.repeat(along[:, None], 8, axis=1),
        timings,
        table,
        settings,
        printed,
        lambda fraction, text: None,
    )
    assert list(tables) == ["bias", "indices", "morris", "precision", "accuracy"]
    # the effect of a linear input is its slope times its range, on the star and along the trajectories
    for row, slope, width in zip(tables["morris"][:3], SLOPES, np.diff(ranges)[:, 0], strict=True):
        assert row["one_star_mu_star"] == pytest.approx(slope * width)
        assert row["morris_mu_star"] == pytest.approx(slope * width)
    assert tables["morris"][0]["paper_mu_star"] == 0.7
    assert {row["engine_cpu_s"] for row in tables["precision"] if row["engine_calls"] == 100} == {10.0}
