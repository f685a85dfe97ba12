"""The paper's level-1 response and mu* by hand."""

from dataclasses import replace

import numpy as np
import pytest

from mesoscale.settings import UncertaintySettings
from mesoscale.uncertainty.chunks import chunk_bounds, collocation_run_count
from mesoscale.uncertainty.collocation import (
    elementary_effects,
    level1_response,
    nodes,
    to_values,
)
from mesoscale.uncertainty.surrogate import legendre, to_json
from tests.mesoscale.uncertainty.surrogate_reader import from_json

RANGES = np.array(
    [[0.18, 0.25], [78.5, 103.5], [0.7, 3.2], [1.95, 14.8], [0.015, 0.035], [0.5, 1.0], [2, 15]]
)


def uniform_moments(response):
    """Mean and variance over independent inputs that are uniform over their ranges."""
    variances = response.coefficients**2 / np.prod(2 * response.degrees + 1, axis=1)
    constant = response.degrees.sum(axis=1) == 0
    return response.coefficients[constant].sum(), variances[~constant].sum()


@pytest.mark.parametrize("inputs", [1, 7, 12])
def test_nodes_differ(inputs):
    grid = nodes(inputs)
    assert grid.shape == (2 * inputs + 1, inputs)
    assert len(np.unique(grid, axis=0)) == len(grid)
    assert collocation_run_count(inputs, UncertaintySettings(seeds=3)) == 3 * len(grid)


def test_nodes_are_centre_and_ends():
    values = to_values(nodes(7), RANGES)
    assert values[0] == pytest.approx(RANGES.mean(axis=1))
    assert values[13, 6] == 2
    assert values[14, 6] == 15


def test_level_1_of_a_linear_function_is_exact():
    slopes = np.arange(1.0, 8.0)
    y = nodes(7) @ slopes + 3
    response = level1_response(y, RANGES)
    assert response.coefficients == pytest.approx([3, *slopes])
    assert uniform_moments(response) == pytest.approx((3, (slopes**2).sum() / 3))
    # dev = sqrt(sum mu*^2 / 12), the check that the paper's tables pass
    effects = elementary_effects(y)
    assert effects == pytest.approx(2 * slopes)
    assert np.sqrt((effects**2).sum() / 12) == pytest.approx(np.sqrt(uniform_moments(response)[1]))


def test_level_1_mean_of_a_square():
    """y = u_0^2 has mean 1/3; the quadrature is exact, although the response is constant."""
    y = nodes(7)[:, 0] ** 2
    response = level1_response(y, RANGES)
    assert response.coefficients[0] == pytest.approx(1 / 3)
    assert response.coefficients[1:] == pytest.approx(np.zeros(7))
    assert elementary_effects(y)[0] == pytest.approx(2)


def test_level_1_misses_interactions_and_biases_the_mean_of_convex_functions():
    u = np.random.default_rng(0).uniform(-1, 1, (200000, 7))

    def f(v):
        return np.exp(v.sum(axis=1))

    response = level1_response(f(nodes(7)), RANGES)
    assert response.coefficients[0] < f(u).mean() * 0.9


def test_missing_node_gives_no_response_value():
    y = np.ones(15)
    y[4] = np.nan
    assert np.isnan(level1_response(y, RANGES)(RANGES.mean(axis=1)[None])).all()


def test_legendre():
    u = np.linspace(-1, 1, 11)
    assert legendre(u, 3)[2:] == pytest.approx(
        np.stack([(3 * u**2 - 1) / 2, (5 * u**3 - 3 * u) / 2])
    )


def test_response_survives_json():
    response = replace(level1_response(nodes(7).sum(axis=1), RANGES), transform="log")
    inputs = [{"low": low, "high": high} for low, high in RANGES.tolist()]
    again = from_json({"inputs": inputs, "outputs": [{"name": "y", **to_json(response)}]})["y"]
    points = to_values(np.random.default_rng(1).uniform(-1, 1, (20, 7)), RANGES)
    assert np.array_equal(again(points), response(points))


def test_inputs_of_zero_width_do_not_divide_by_zero():
    ranges = RANGES.copy()
    ranges[2] = 1.0
    response = level1_response(nodes(7) @ np.array([1, 1, 0, 1, 1, 1, 1]), ranges)
    assert np.isfinite(response(ranges.mean(axis=1)[None])).all()


def test_chunks_cover_all_runs_and_grow_at_their_end():
    few, more = chunk_bounds(120, 50), chunk_bounds(300, 50)
    assert [b - a for a, b in few.values()] == [50, 50, 20]
    assert list(more.values())[:2] == list(few.values())[:2]
    assert chunk_bounds(0, 50) == {}
