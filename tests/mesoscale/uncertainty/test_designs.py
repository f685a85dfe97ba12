"""Designs of direct runs: each run depends on its index alone."""

import numpy as np
import pytest

from mesoscale.inputs.table import collect
from mesoscale.uncertainty.chunks import full_chunks
from mesoscale.uncertainty.designs import morris_points, random_runs
from mesoscale.uncertainty.morris import trajectory_effects, trajectory_points
from tests.mesoscale import paper

PAPER = collect(paper.INPUTS, {}, {})


def test_designs_can_be_cut_anywhere():
    whole = random_runs(PAPER, 0, 24)
    assert [run.index for run in whole] == list(range(24))
    assert random_runs(PAPER, 5, 19) == whole[5:19]


def test_more_runs_leave_every_chunk_as_it_is():
    few, more = full_chunks(220), full_chunks(1000)
    assert list(few.values()) == [(0, 100), (100, 200), (200, 300)]
    assert all(more[name] == bounds for name, bounds in few.items())


def test_a_single_chunk_holds_no_more_runs_than_asked_for():
    assert full_chunks(20) == {"000": (0, 20)}
    assert full_chunks(0) == {}


def test_a_trajectory_moves_one_input_at_a_time():
    moved = (np.diff(morris_points(7, 0, 1), axis=0) != 0).sum(axis=1)
    assert moved.tolist() == [1] * 7


def test_effects_of_a_linear_function_are_its_slopes_and_a_product_has_spread():
    points = trajectory_points(3, 30, 1)
    effects = trajectory_effects(points, points @ [1.0, -2.0, 0.0], 1)
    assert effects.mu_star == pytest.approx([1, 2, 0], abs=1e-12)
    assert effects.sigma == pytest.approx([0, 0, 0], abs=1e-12)
    y = points[..., 0] * points[..., 1]
    y[3, 2] = np.nan
    effects = trajectory_effects(points, y, 1)
    assert effects.trajectories == 29
    # |EE| of x0 is x1, of mean 1/2 over the grid
    assert effects.mu_star[0] == pytest.approx(0.5, abs=0.15)
    assert effects.sigma[0] > 0.1
    assert np.isnan(trajectory_effects(points, np.full(y.shape, np.nan), 1).mu_star).all()
