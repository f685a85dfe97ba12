"""The paper's level-1 response and mu* by hand, and sparse-grid interpolation of polynomials."""

import numpy as np
import pytest

from mesoscale.uncertainty.chunks import chunk_bounds, node_count
from mesoscale.uncertainty.collocation import (
    elementary_effects,
    interpolating_response,
    level1_response,
    nodes,
    to_values,
)
from mesoscale.uncertainty.surrogate import from_json, legendre, to_json

RANGES = np.array([[0.18, 0.25], [78.5, 103.5], [0.7, 3.2], [1.95, 14.8], [0.015, 0.035], [0.5, 1.0], [2, 15]])


def uniform_moments(response):
    """Mean and variance over independent inputs that are uniform over their ranges."""
    variances = response.coefficients**2 / np.prod(2 * response.degrees + 1, axis=1)
    constant = response.degrees.sum(axis=1) == 0
    return response.coefficients[constant].sum(), variances[~constant].sum()


@pytest.mark.parametrize(("inputs", "level", "count"), [(7, 1, 15), (6, 1, 13), (7, 2, 113), (1, 2, 5), (12, 2, 313)])
def test_number_of_distinct_nodes(inputs, level, count):
    grid = nodes(inputs, level)
    assert len(grid) == node_count(inputs, level) == count
    assert len(np.unique(np.round(grid, 12), axis=0)) == count


def test_level_1_is_part_of_level_2():
    assert np.array_equal(nodes(7, 2)[:15], nodes(7, 1))


def test_nodes_are_centre_and_ends():
    values = to_values(nodes(7, 1), RANGES)
    assert values[0] == pytest.approx(RANGES.mean(axis=1))
    assert values[13, 6] == 2
    assert values[14, 6] == 15


def test_level_1_of_a_linear_function_is_exact():
    slopes = np.arange(1.0, 8.0)
    y = nodes(7, 1) @ slopes + 3
    response = level1_response(y, RANGES)
    assert response.coefficients == pytest.approx([3, *slopes])
    assert uniform_moments(response) == pytest.approx((3, (slopes**2).sum() / 3))
    # dev = sqrt(sum mu*^2 / 12), the check that the paper's tables pass
    effects = elementary_effects(y, 7)
    assert effects == pytest.approx(2 * slopes)
    assert np.sqrt((effects**2).sum() / 12) == pytest.approx(np.sqrt(uniform_moments(response)[1]))


def test_level_1_mean_of_a_square():
    """y = u_0^2 has mean 1/3; the quadrature is exact, although the response is constant."""
    y = nodes(7, 1)[:, 0] ** 2
    response = level1_response(y, RANGES)
    assert response.coefficients[0] == pytest.approx(1 / 3)
    assert response.coefficients[1:] == pytest.approx(np.zeros(7))
    assert elementary_effects(y, 7)[0] == pytest.approx(2)


def test_level_1_misses_interactions_and_biases_the_mean_of_convex_functions():
    u = np.random.default_rng(0).uniform(-1, 1, (200000, 7))

    def f(v):
        return np.exp(v.sum(axis=1))

    response = level1_response(f(nodes(7, 1)), RANGES)
    assert response.coefficients[0] < f(u).mean() * 0.9


@pytest.mark.parametrize("level", [1, 2])
def test_interpolation_passes_through_the_nodes(level):
    grid = nodes(7, level)
    y = np.cos(grid @ np.arange(7)) + 2
    for transform in ("identity", "log"):
        response = interpolating_response(y, RANGES, level, transform)
        assert response(to_values(grid, RANGES)) == pytest.approx(y)


def test_level_2_reproduces_quadratics_with_interactions():
    rng = np.random.default_rng(3)
    matrix = rng.normal(size=(7, 7))

    def f(u):
        return np.einsum("ij,jk,ik->i", u, matrix, u) + u.sum(axis=1)

    u = rng.uniform(-1, 1, (50, 7))
    response = interpolating_response(f(nodes(7, 2)), RANGES, 2)
    assert response(to_values(u, RANGES)) == pytest.approx(f(u))


def test_interpolants_of_level_1_have_the_papers_mean():
    y = np.exp(nodes(7, 1) @ np.linspace(0.1, 0.7, 7))
    mean, _ = uniform_moments(interpolating_response(y, RANGES, 1))
    assert mean == pytest.approx(level1_response(y, RANGES).coefficients[0])


def test_missing_node_gives_no_response_value():
    y = np.ones(15)
    y[4] = np.nan
    assert np.isnan(level1_response(y, RANGES)(RANGES.mean(axis=1)[None])).all()


def test_legendre():
    u = np.linspace(-1, 1, 11)
    assert legendre(u, 3)[2:] == pytest.approx(np.stack([(3 * u**2 - 1) / 2, (5 * u**3 - 3 * u) / 2]))


def test_response_survives_json():
    response = interpolating_response(np.exp(nodes(7, 1).sum(axis=1)), RANGES, 1, "log")
    inputs = [{"low": low, "high": high} for low, high in RANGES.tolist()]
    again = from_json({"inputs": inputs, "outputs": [{"name": "y", **to_json(response)}]})["y"]
    points = to_values(np.random.default_rng(1).uniform(-1, 1, (20, 7)), RANGES)
    assert np.array_equal(again(points), response(points))


def test_inputs_of_zero_width_do_not_divide_by_zero():
    ranges = RANGES.copy()
    ranges[2] = 1.0
    response = level1_response(nodes(7, 1) @ np.array([1, 1, 0, 1, 1, 1, 1]), ranges)
    assert np.isfinite(response(ranges.mean(axis=1)[None])).all()


def test_chunks_cover_all_runs_and_grow_at_their_end():
    few, more = chunk_bounds(120, 50), chunk_bounds(300, 50)
    assert [b - a for a, b in few.values()] == [50, 50, 20]
    assert list(more.values())[:2] == list(few.values())[:2]
    assert chunk_bounds(0, 50) == {}
