"""Runs of the real engine on small surfaces: planning, failures, repeated inputs."""

import numpy as np
import pytest

from mesoscale.inputs.contact import contact_of
from mesoscale.inputs.table import collect
from mesoscale.law.branches import fit_cycle
from mesoscale.law.parameters import FITTED
from mesoscale.settings import ContactSettings
from mesoscale.uncertainty import runs as runs_module
from mesoscale.uncertainty.designs import Run, collocation_runs, random_runs
from mesoscale.uncertainty.runs import compute, compute_all, compute_rows
from tests.mesoscale import paper

PAPER = collect(paper.INPUTS, {}, {})
CONTACT = ContactSettings(mechanics="asperity", pixels=64)
CENTRE = collocation_runs(PAPER, 0, 1)[0].values


def computed(values, seed):
    cycle = compute(values, seed, CONTACT)
    assert not isinstance(cycle, str), cycle
    return cycle


def test_runs_of_a_chunk_go_through_the_nodes_of_one_surface_after_the_other():
    runs = collocation_runs(PAPER, 14, 16)
    assert [run.seed for run in runs] == [0, 1]
    assert [run.node for run in runs] == [14, 0]


def test_random_runs_can_be_cut_anywhere():
    whole = random_runs(PAPER, 0, 10)
    assert random_runs(PAPER, 4, 10) == whole[4:]
    assert len({run.seed for run in whole}) == 10
    assert all(2 <= run.values["rms"] <= 15 for run in whole)


def test_a_cycle_gives_four_numbers_a_branch():
    cycle = computed(CENTRE, 0)
    outcome = fit_cycle(cycle)
    assert outcome.closing.parameters.shape == outcome.opening.parameters.shape == (4,)
    assert outcome.closing.d_c_nm == pytest.approx(cycle.first_contact_nm)
    # a smooth closing: contact a few rms from the mean plane
    assert 2 < outcome.closing.d_c_nm / CENTRE["rms"] < 6


def test_rough_responses_touch_at_separations_in_proportion_to_rms():
    """Common random numbers: the same response, scaled."""
    cycles = [computed({**CENTRE, "rms": rms}, 3) for rms in (4.0, 8.0)]
    assert cycles[1].first_contact_nm == pytest.approx(2 * cycles[0].first_contact_nm)


def test_a_failing_engine_is_reported_and_leaves_no_numbers():
    rows = list(compute_rows([Run(0, -1, 1, {**CENTRE, "e_star": -1.0})], CONTACT))
    assert str(rows[0]["curve_status"]).startswith("failed: InputError")
    assert all(rows[0][name] == "" for name in FITTED)


def test_equal_inputs_are_computed_once(monkeypatch):
    calls = []
    monkeypatch.setattr(runs_module, "compute", lambda *args: calls.append(args) or "failed: test")
    same = [Run(k, k, 0, CENTRE) for k in range(5)]
    assert len(list(compute_all(same, CONTACT))) == 5
    assert len(calls) == 1


def test_the_cut_off_is_an_input_and_never_beyond_the_grid():
    _, settings = contact_of({**CENTRE, "q1": 0.1}, CONTACT)
    assert settings.q1_per_nm == 0.1
    fine, coarse = (computed({**CENTRE, "q1": q1}, 1).first_contact_nm for q1 in (0.2, 0.1))
    assert fine != coarse
    assert "1/nm" in str(compute({**CENTRE, "q1": 100.0}, 1, CONTACT))


def test_the_eighth_input_reaches_the_engine():
    inputs, settings = contact_of({**CENTRE, "gap_cutoff": 0.3}, CONTACT)
    assert settings.gap_cutoff_nm == 0.3
    near, far = (fit_cycle(computed({**CENTRE, "gap_cutoff": d}, 1)) for d in (0.165, 0.3))
    assert near.closing.C_a_GPa_nm > far.closing.C_a_GPa_nm
    assert np.isclose(near.closing.rho_r_nm, far.closing.rho_r_nm)
    assert inputs.rms == CENTRE["rms"]
