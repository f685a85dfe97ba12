"""Truth by brute force, and the errors of responses against it, on functions whose answers are known."""

import numpy as np
import pytest

from evidence.uncertainty.truth import GROUPS, explained_by, jackknife, truth_of
from evidence.uncertainty.work_precision import precision_rows
from mesoscale.inputs.distributions import Distribution, InputTable, UncertainInput
from mesoscale.uncertainty.collocation import nodes, to_values
from mesoscale.uncertainty.propagation import NodeOutputs
from mesoscale.uncertainty.surrogate import Surrogate, with_scatter

SLOPES = np.array([1.0, 2.0, 3.0])
NOISE = 0.5


@pytest.fixture(scope="module")
def table():
    given = Distribution("uniform", 0.0, 1.0)
    return InputTable(tuple(UncertainInput(f"x{k}", "1", given, "literature", "") for k in range(3)), np.eye(3))


@pytest.fixture(scope="module")
def runs(table):
    """Inputs, outputs with the noise of their surfaces, and replicates; opening is twice closing."""
    rng = np.random.default_rng(4)
    x = table.sample(1600, 2)

    def outputs(points):
        closing = 10 + points @ SLOPES + rng.normal(0, NOISE, len(points))
        return np.repeat(closing[:, None], 8, axis=1) * np.array([1.0] * 4 + [2.0] * 4)

    return x, outputs(x), outputs(x[:400])


def test_the_variance_is_split_into_inputs_and_surface(runs):
    truth = truth_of(*runs)
    # 400 pairs know a variance to sqrt(2/400) = 7 %, 1000 runs theirs to 5 %
    assert truth.surface_variance.value[0] == pytest.approx(NOISE**2, rel=0.25)
    assert truth.input_variance.value[0] == pytest.approx(14 / 12, rel=0.2)
    assert abs(truth.input_variance.value[0] - 14 / 12) < 2 * truth.input_variance.error[0]


def test_first_order_indices_of_scattered_runs(runs):
    truth = truth_of(*runs)
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
    truth = truth_of(x, holed, again)
    assert truth.statistics["mean"].value[2] == pytest.approx(np.nanmean(holed[:, 2]))


def test_scatter_gives_single_cells_the_variance_of_the_runs(runs):
    x, y, _ = runs
    ranges = np.array([[0.0, 1.0]] * 3)
    degrees = np.vstack([np.zeros((1, 3), int), np.eye(3, dtype=int)])
    response = Surrogate(ranges, degrees, np.array([13.0, 0.5, 1.0, 1.5]))
    cells = with_scatter(np.repeat(response(x)[:, None], 8, axis=1), [response] * 4 + [None] * 4, (x, y), 1)
    assert cells[:, 0].var() == pytest.approx(y[:, 0].var(), rel=0.1)
    # drawn together: outputs with equal residuals stay equal
    assert cells[:, 1] == pytest.approx(cells[:, 0])
    assert np.isnan(cells[:, 4:]).all()
    assert np.isnan(with_scatter(cells[:, :], [response] * 8, (x[:5], y[:5]), 1)).all()


def given_nodes(table, seeds=4):
    values = 10 + to_values(nodes(3), table.ranges()) @ SLOPES
    shifts = np.linspace(-0.1, 0.1, seeds)[:, None]
    return NodeOutputs(list(range(seeds)), np.stack([values + shifts] * 4 + [2 * (values + shifts)] * 4, axis=-1))


def test_errors_fall_with_the_calls(table, runs):
    x, y, again = runs
    rows = list(precision_rows(given_nodes(table), (x[:1600], y[:1600]), truth_of(x, y, again), table))
    found = {(row["method"], row["engine_calls"], row["statistic"]): row["error"] for row in rows}
    assert found["plain sampling", 800, "mean"] < found["plain sampling", 200, "mean"]
    # a plane is what this engine is: the paper's method knows its inputs' share of the deviation
    assert found["level-1 linear", 28, "dev"] < 0.1
    assert {row["outputs"] for row in rows} == {8}
