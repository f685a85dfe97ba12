"""The accuracy table of the pad: what it must hold, on pads of few small cells."""

import numpy as np
import pytest
from scipy.special import ndtri

from mesoscale.answer.points import central_point, plan_points
from mesoscale.answer.switches import PadModel, solve_point, solve_points, surfaces_of
from mesoscale.contact.surface import random_surface, shared_wave
from mesoscale.inputs.distributions import Distribution, InputTable, UncertainInput
from mesoscale.pad.grid import DEPTHS, LONGEST_STEP_NM, STEP_RMS, PadGrid
from mesoscale.settings import ContactSettings
from mesoscale.studies.answer_stability import published_beam
from mesoscale.studies.pad_accuracy import (
    BY_DEPTHS,
    CELLS,
    POINTS,
    SITES,
    STEPS,
    SamplePad,
    accuracy_points,
    halved,
    opened_from,
    quantile_errors,
    thinned,
    with_waves,
)

FIXED = {"e_star": 91.0, "h_macro": 1.95, "h_prime": 8.375, "q0": 0.025, "hurst": 0.75}
RANGES = {"hamaker": (0.2, 0.23), "rms": (7.5, 9.5)}
DISTRIBUTIONS = {name: Distribution("fixed", value) for name, value in FIXED.items()} | {
    name: Distribution("uniform", *ends) for name, ends in RANGES.items()
}
TABLE = InputTable(
    tuple(
        UncertainInput(name, "", distribution, "literature", "")
        for name, distribution in DISTRIBUTIONS.items()
    ),
    np.eye(len(DISTRIBUTIONS)),
)
CONTACT = ContactSettings(mechanics="asperity", pixels=64)
POINT = central_point(TABLE, CONTACT, published_beam())


@pytest.fixture(scope="module")
def rows():
    """The table, for pads of two cells."""
    central = solve_point(POINT, CONTACT, 8, surfaces_of(0))
    design = plan_points(TABLE, CONTACT, published_beam(), 32)
    solved = solve_points(list(enumerate(design.points[:1], 1)), CONTACT, 2)
    return list(accuracy_points(PadModel(central, design, tuple(solved) * 32), CONTACT, 2))


def test_every_choice_has_errors_with_their_own_and_the_value_in_use(rows):
    assert {row["knob"] for row in rows} == {CELLS, STEPS, BY_DEPTHS, SITES, POINTS}
    assert {row["unit"] for row in rows} == {"V"}
    for row in rows:
        assert np.isfinite([row["error"], row["own_error"], row["cpu_s"]]).all()
        assert row["release_V"] == row["error"]
    in_use = {row["knob"]: row["value"] for row in rows if row["shipped"]}
    step = min(STEP_RMS * POINT.values["rms"], LONGEST_STEP_NM)
    assert in_use == {CELLS: 2, STEPS: step, BY_DEPTHS: DEPTHS, SITES: 2.0, POINTS: 32}


def test_the_depths_converge(rows):
    few, *_, most = [row["error"] for row in rows if row["knob"] == BY_DEPTHS]
    assert most < 0.5 * few


def test_each_number_of_cells_has_its_time(rows):
    cells = [row for row in rows if row["knob"] == CELLS]
    assert [row["value"] for row in cells] == [2, 4]
    assert all(row["cpu_s"] > 0.0 for row in cells)


def test_finer_grids_show_the_same_surface():
    inputs, settings = POINT.contact_of(CONTACT)
    coarse = settings.model_copy(update={"pixels": 32})
    pad = with_waves(SamplePad(POINT, inputs, settings, []), shared_wave(coarse))
    heights = {
        side: random_surface(inputs, pad.settings.model_copy(update={"pixels": side}), 7)
        for side in (32, 64, 128)
    }
    for side in (64, 128):
        every = side // 32
        np.testing.assert_allclose(heights[side][::every, ::every], heights[32], atol=1e-9)


def test_other_steps_keep_what_pads_are_opened_from():
    grid = PadGrid(np.array([30.0, 29.0, 27.0, 26.0, 24.0, 23.0, 22.5, 21.0]), np.array([3, 4, 7]))
    finer = halved(grid)
    coarser = thinned(grid, 4)
    np.testing.assert_array_equal(finer.depth_nm, grid.depth_nm)
    np.testing.assert_array_equal(coarser.depth_nm, grid.depth_nm)
    np.testing.assert_array_equal(finer.separation_nm[::2], grid.separation_nm)
    np.testing.assert_array_equal(coarser.separation_nm, [30.0, 26.0, 24.0, 21.0])
    np.testing.assert_array_equal(opened_from(grid, 2).depth_nm, [26.0, 21.0])


def test_errors_of_quantiles_are_those_of_a_normal_sample():
    """Of the median sqrt(pi / 2) / sqrt(n), and of the 5 and 95 % quantiles sqrt(0.05 0.95) /
    density / sqrt(n).
    """
    values = ndtri((np.arange(20_000) + 0.5) / 20_000)
    low, middle, high = quantile_errors(values, 400) * np.sqrt(400)
    density = np.exp(-0.5 * 1.6449**2) / np.sqrt(2.0 * np.pi)
    # 400 draws know a deviation to 3.5 %; here is three times that
    assert middle == pytest.approx(np.sqrt(0.5 * np.pi), rel=0.11)
    assert low == pytest.approx(np.sqrt(0.05 * 0.95) / density, rel=0.11)
    assert high == pytest.approx(np.sqrt(0.05 * 0.95) / density, rel=0.11)
