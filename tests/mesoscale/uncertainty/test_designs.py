"""Designs of direct runs: each run depends on its index alone."""

from mesoscale.inputs.table import collect
from mesoscale.uncertainty.chunks import full_chunks
from mesoscale.uncertainty.designs import random_runs
from tests.mesoscale import paper

PAPER = collect(paper.INPUTS, {}, {})


def test_designs_can_be_cut_anywhere():
    whole = random_runs(PAPER, 0, 24)
    assert [run.index for run in whole] == list(range(24))
    assert random_runs(PAPER, 5, 19) == whole[5:19]


def test_more_runs_leave_every_chunk_as_it_is():
    few, more = full_chunks(220), full_chunks(1000)
    assert list(few.values()) == [(0, 200), (200, 400)]
    assert all(more[name] == bounds for name, bounds in few.items())


def test_a_single_chunk_holds_no_more_runs_than_asked_for():
    assert full_chunks(20) == {"000": (0, 20)}
    assert full_chunks(0) == {}
