"""Designs of direct runs: each run depends on its index alone."""

import numpy as np
import pytest

from mesoscale.inputs.table import collect
from mesoscale.settings import UncertaintySettings
from mesoscale.uncertainty.chunks import full_chunks
from mesoscale.uncertainty.designs import DESIGNS, morris_runs, random_runs, replicate_runs
from mesoscale.uncertainty.morris import trajectory_effects, trajectory_points
from mesoscale.uncertainty.studies.overhead import workload
from tests.mesoscale import paper

PAPER = collect(paper.INPUTS, {}, {}, 0.999)
SETTINGS = UncertaintySettings()


@pytest.mark.parametrize("design", DESIGNS)
def test_designs_can_be_cut_anywhere(design):
    whole = DESIGNS[design](PAPER, SETTINGS, 0, 24)
    assert [run.index for run in whole] == list(range(24))
    assert DESIGNS[design](PAPER, SETTINGS, 5, 19) == whole[5:19]


def test_more_runs_leave_every_chunk_as_it_is():
    few, more = full_chunks(120, 50), full_chunks(1000, 50)
    assert list(few.values()) == [(0, 50), (50, 100), (100, 150)]
    assert all(more[name] == bounds for name, bounds in few.items())


def test_replicates_have_equal_inputs_and_other_surfaces():
    first, again = random_runs(PAPER, SETTINGS, 0, 5), replicate_runs(PAPER, SETTINGS, 0, 5)
    assert [run.values for run in first] == [run.values for run in again]
    assert not {run.seed for run in first} & {run.seed for run in again}


def test_a_trajectory_moves_one_input_at_a_time_on_one_surface():
    runs = morris_runs(PAPER, SETTINGS, 0, 8)
    assert len({run.seed for run in runs}) == 1
    values = np.array([list(run.values.values()) for run in runs])
    moved = (np.diff(values, axis=0) != 0).sum(axis=1)
    assert moved.tolist() == [1] * 7
    assert morris_runs(PAPER, SETTINGS, 8, 9)[0].seed != runs[0].seed


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


def test_overhead_counts_idle_time_but_no_interruption():
    def job(start, end, cpu):
        return {"job_started_s": str(start), "job_ended_s": str(end), "engine_cpu_s": str(cpu)} | {
            "cycles": "10",
            "peak_rss_MB": "100",
        }

    # two cores: 10 s together, 2 s idle, an hour's pause, 10 s on one core
    found = workload([job(0, 10, 10), job(0, 10, 9), job(12, 22, 10), job(3622, 3632, 10)], 2)
    assert found["elapsed_s"] == pytest.approx(32)
    assert found["overhead"] == pytest.approx(1 - 39 / 64)
    assert found["cycles"] == 40
