import pytest

from mesoscale.contact import run_cycle
from mesoscale.contact.studies.draws import COLUMNS, RANGES, draw_inputs, draw_rows
from mesoscale.contact.studies.stability import draws_by_grid, extreme_cases, judge, study_grid, violations
from mesoscale.contact.surface import random_surface
from mesoscale.settings import ContactSettings
from tests.mesoscale import paper

SMALL = ContactSettings(pixels=64, length_nm=62.5, max_force_nN=200.0, study_draws=51)


def test_draws_are_the_same_whatever_the_chunk():
    """Draw 50 is the only one of chunk 1; its inputs and its grid follow from its number alone."""
    rows = list(draw_rows(1, SMALL))
    assert [(row["draw"], row["seed"], row["pixels"]) for row in rows] == [(50, seed, 32) for seed in (1, 2, 3)]
    assert all(row["hurst"] == round(draw_inputs(50).hurst, 6) for row in rows)
    assert set(rows[0]) == set(COLUMNS)


def test_draws_are_from_table_1():
    rows = paper.INPUTS.rows()
    normal = rows.pop("e_star")
    assert {name: RANGES[name] for name in rows} == {name: (row.a, row.b) for name, row in rows.items()}
    # 2.895 deviations: the central 99.6 %
    assert RANGES["e_star"] == pytest.approx((normal.a - 2.895 * normal.b, normal.a + 2.895 * normal.b), rel=1e-4)


def test_no_extreme_load_or_height_is_left_out():
    names = {case.name for case in extreme_cases(SMALL)}
    assert {"1e+04 nN", "1e+05 nN", "1e+06 nN", "1e+07 nN", "nm x 1e-6", "nm x 1e6"} <= names


def test_a_stiff_case_keeps_all_invariants():
    cases = {case.name: case for case in extreme_cases(SMALL)}
    assert judge(cases["E* x 1000"], SMALL)[0] == []


@pytest.mark.parametrize("flow_volume", ["dropped", "piled_up"])
def test_extreme_coupled_cases_keep_all_invariants_whatever_becomes_of_the_volume(flow_volume):
    settings = ContactSettings(mechanics="coupled", pixels=48, length_nm=96.0, flow_volume=flow_volume)
    cases = extreme_cases(settings)
    assert len(cases) > 40
    assert {case.name: broken for case in cases if (broken := judge(case, settings)[0])} == {}


def test_a_gain_of_energy_over_few_points_is_judged_on_a_finer_path():
    """In this draw two asperities merge; 40 steps see the jump at another place on opening than on closing."""
    inputs, settings = draw_inputs(1160), ContactSettings(pixels=128)
    heights = random_surface(inputs, settings, 3)
    cycle = run_cycle(inputs, settings, 3, heights=heights, keep_surface=True)
    (words,) = violations(cycle, inputs, settings)
    assert words.startswith("energy gained")
    assert violations(cycle, inputs, settings, heights) == []


def test_a_broken_draw_fails_its_row():
    draw = {"draw": "7", "seed": "1", "pixels": "64", "steps": "50", "most_sweeps": "9", "wall_s": "0.1"}
    draw |= {"radius_bound_events": "3", "repeated_steps": "0", "force_miss": "1e-9", "broken": "volume changed"}
    ((*_, check),) = draws_by_grid([draw])
    passed, detail = check()
    assert not passed
    assert "draw 7 seed 1: volume changed" in detail


def test_extreme_cases_keep_the_spacing_on_a_smaller_grid():
    chosen = study_grid(ContactSettings(pixels=1024, length_nm=1000.0))
    assert (chosen.pixels, chosen.length_nm) == (256, 250.0)
