"""Cells under one plane: means, and memory between depths."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.special import ndtr

from mesoscale.contact import ContactInputs
from mesoscale.contact.surface import random_surface
from mesoscale.errors import InputError
from mesoscale.inputs.contact import FilmInputs
from mesoscale.pad.cells import (
    FIRST_SEED,
    Cell,
    FilmPieces,
    half_of,
    place_ratio,
    sample_cells,
    surface_of,
)
from mesoscale.pad.closing import press_cells
from mesoscale.pad.curves import Flats, PadCurves, deepened
from mesoscale.pad.grid import PadGrid
from mesoscale.pad.local import LocalPad
from mesoscale.pad.pilots import plan_grid
from mesoscale.pad.pressed import Pad
from mesoscale.settings import ContactSettings

MIDDLE = ContactInputs(
    hamaker=0.215, e_star=91.0, h_macro=1.95, h_prime=8.375, q0=0.025, hurst=0.75, rms=8.5
)
CONTACT = ContactSettings(mechanics="asperity", pixels=128)
CELLS, STEP_NM = 16, 0.2
FLATS = Flats(0.215, 0.165)
WANTED_MPa = 5.0


def pressed(inputs, cells, grid=None, contact=CONTACT):
    """A pad of cells, at separations of its own where none are given."""
    grid = grid or plan_grid(inputs, contact, cells, 1e-3 * WANTED_MPa, step_nm=STEP_NM)
    return press_cells(inputs, contact, grid, cells)


@pytest.fixture(scope="module")
def pad():
    return pressed(MIDDLE, sample_cells(MIDDLE, CELLS))


def exponential_law(depths):
    """A pad whose opening is known: exp(-(s - D) / 1.5 nm) 5 exp((25 - D)/2 nm) MPa, and a smooth
    attraction.
    """
    s = np.arange(20.0, 60.0, 0.1)

    def closing(at):
        return 5e-3 * np.exp((25.0 - at) / 2.0)

    def attraction(at):
        return -1e-4 * (20.0 / at) ** 3

    opening = np.full((len(depths), 2, s.size), np.nan)
    for k, depth in enumerate(depths):
        above = s >= depth - 1e-9
        opening[k, 0, above] = closing(depth) * np.exp(-(s[above] - depth) / 1.5)
        opening[k, 1, above] = attraction(s[above])
    law = PadCurves(
        s, np.stack([closing(s), attraction(s)]), np.array(depths), opening, Flats(0.2, 0.165)
    )
    return law, lambda at, depth: (closing(depth) * np.exp(-(at - depth) / 1.5), attraction(at))


def test_the_grid_reaches_the_pressure_and_all_first_contacts(pad):
    pressure = pad.mean(pad.closing)[0]
    assert 0.5 * WANTED_MPa < pressure[-1] * 1e3 < 2.0 * WANTED_MPa
    assert pad.grid.separation_nm[0] > pad.first_contact_nm.max()
    assert (np.diff(pad.grid.separation_nm) < 0).all()


def test_a_pad_that_one_tall_grain_carries_is_opened_from_light_loads(monkeypatch):
    def with_a_grain(inputs, contact, cell):
        heights = surface_of(inputs, contact, cell)
        if cell.seed == FIRST_SEED:
            heights[:48, :48] -= 20.0
        return heights

    monkeypatch.setattr("mesoscale.pad.cells.surface_of", with_a_grain)
    pad = pressed(MIDDLE, sample_cells(MIDDLE, 4))
    assert pad.mean(pad.closing)[0, pad.grid.depths[0]] < 0.3e-3 * WANTED_MPa


def test_a_pressure_out_of_reach_is_refused():
    rigid = ContactSettings(mechanics="asperity", pixels=32, length_nm=1000.0)
    soft = ContactInputs(**{**vars(MIDDLE), "e_star": 1e-6, "hamaker": 0.0})
    with pytest.raises(
        InputError, match=r"of the 5 MPa that the switch presses with; lower hold_voltage_V"
    ):
        plan_grid(soft, rigid, sample_cells(soft, 4), 1e-3 * WANTED_MPa)


def test_openings_start_where_closing_ended_and_deeper_pads_hold_more(pad):
    law = pad.curves
    for depth in law.depth_nm:
        # cells that touch first between two depths have no opening of their own
        assert law.opening_GPa(depth, depth) == pytest.approx(law.closing_GPa(depth), rel=1e-4)


def test_memory_between_depths_is_exact_for_exponential_branches():
    law, exact = exponential_law([21.0, 23.0, 25.0, 27.0])
    at = np.linspace(24.0, 40.0, 50)
    repulsion, attraction = exact(at, 24.0)
    # linear between separations 0.1 nm apart: (0.1 / 1.5)^2 / 8 of an exponential of 1.5 nm; and
    # s^-3 taken as an exponential between depths 2 nm apart: (3 / s^2) 2^2 / 8
    error = np.abs(law.opening_GPa(at, 24.0) - repulsion - attraction)
    assert (error <= 6e-4 * repulsion + 2.7e-3 * np.abs(attraction)).all()


def test_a_pad_that_is_continued_below_its_deepest_closing_is_exact_for_exponential_branches():
    law, exact = exponential_law([22.0, 24.0])
    law = PadCurves(
        law.separation_nm[20:], law.closing[:, 20:], law.depth_nm, law.opening[:, :, 20:], law.flats
    )
    deeper = deepened(law)
    depth = float(deeper.depth_nm[0])
    # twice the repulsion, whose e-fold is 2 nm
    assert depth == pytest.approx(22.0 - 2.0 * np.log(2.0))
    at = np.linspace(depth, 40.0, 50)
    repulsion, attraction = exact(at, depth)
    # s^-3 is no exponential: (3 / s^2) over 1.4 nm, and 0.1 nm between separations
    error = np.abs(deeper.opening_GPa(at, depth) - repulsion - attraction)
    assert (error <= 2e-3 * repulsion + 0.1 * np.abs(attraction)).all()
    np.testing.assert_allclose(deeper.opening_GPa(at, 23.0), law.opening_GPa(at, 23.0), rtol=1e-9)


def test_nothing_is_extrapolated_unasked():
    law, _ = exponential_law([21.0, 23.0])
    with pytest.raises(InputError, match=r"21 \.\. 23 nm"):
        law.opening_GPa(30.0, 20.5)
    with pytest.raises(InputError, match="closed to 20 nm"):
        law.closing_GPa(19.0)


def test_far_away_a_pad_is_two_flats(pad):
    law = pad.curves
    far = law.separation_nm[-1]
    flats = -MIDDLE.hamaker / (6 * np.pi * (far + CONTACT.gap_cutoff_nm) ** 3)
    # two flats to 1 + 6 (rms / separation)^2
    assert law.closing_GPa(far) == pytest.approx(flats, rel=0.02, abs=0)
    twice = (2 * far + CONTACT.gap_cutoff_nm) / (far + CONTACT.gap_cutoff_nm)
    assert law.closing_GPa(2 * far) == pytest.approx(flats / twice**3, rel=1e-12, abs=0)
    pressure, slope = LocalPad(law)(np.array([[2 * far]]), np.array([[np.inf]]))
    assert pressure[0, 0] == pytest.approx(flats / twice**3, rel=1e-12, abs=0)
    assert slope[0, 0] == pytest.approx(
        -3 * pressure[0, 0] / (2 * far + CONTACT.gap_cutoff_nm), rel=1e-12, abs=0
    )


def test_cells_are_pieces_of_a_film():
    """Mean planes and RMS heights scatter as those of square pieces cut out of films of four times
    the side.
    """
    small = ContactSettings(mechanics="asperity", pixels=64)
    large = ContactSettings(mechanics="asperity", pixels=256, length_nm=4000.0)
    pieces = FilmPieces(MIDDLE, small)
    planes = np.random.default_rng(0).normal(size=300)
    ours = np.array(
        [pieces.surface(Cell(seed, 0.0, plane, 1.0)) for seed, plane in enumerate(planes)]
    )
    films = [random_surface(MIDDLE, large, seed) for seed in range(40)]
    cut = np.concatenate(
        [film.reshape(4, 64, 4, 64).swapaxes(1, 2).reshape(16, 64, 64) for film in films]
    )
    for of_surface in (lambda h: h.mean(axis=(1, 2)), lambda h: h.std(axis=(1, 2))):
        # a deviation from 300 pieces is known to 4 %; a cut piece also holds parts of waves longer
        # than itself
        assert of_surface(ours).std() == pytest.approx(of_surface(cut).std(), rel=0.35)
    assert np.mean(ours**2) == pytest.approx(MIDDLE.rms**2, rel=0.02)
    assert np.mean(cut**2) == pytest.approx(MIDDLE.rms**2, rel=0.02)


def film(scatter):
    return FilmInputs(**vars(MIDDLE), rms_scatter=scatter)


@pytest.mark.parametrize("scatter", [0.0, 0.2, 0.75])
@pytest.mark.parametrize("count", [1, 2, 12, 64])
def test_classes_of_places_are_all_places_of_the_film(scatter, count):
    """Weights are the shares of their classes, whose ends lie between the cells; each half is like
    the whole.
    """
    cells = sample_cells(film(scatter), count, pad_cells=1e5)
    assert sum(cell.weight for cell in cells) == pytest.approx(1.0)
    rougher = np.cumsum([cell.weight for cell in cells])
    below = ndtr([cell.rough for cell in cells])
    left_out = 1e-5  # rougher places than the pad has
    assert (below <= rougher + left_out).all()
    assert (below >= (1.0 - left_out) * np.append(0.0, rougher[:-1]) - 1e-9).all()
    assert abs(half_of(count).sum() - half_of(count, other=True).sum()) <= 1


def test_the_mean_over_classes_is_that_over_the_film_without_a_bias():
    """Of the cube of the RMS height, as the load grows: E[exp(3 s z)] = exp(4.5 s^2)."""

    def mean(seed):
        cells = sample_cells(film(0.3), 12, seed)
        return sum(cell.weight * np.exp(3 * 0.3 * cell.rough) for cell in cells)

    found = np.array([mean(seed) for seed in range(200)])
    assert found.mean() == pytest.approx(np.exp(4.5 * 0.09), rel=0.015)
    assert found.std() < 0.15 * found.mean()  # 12 places drawn one by one: 0.33


def test_a_pad_of_few_cells_has_no_place_of_which_there_is_less_than_one():
    assert max(cell.rough for cell in sample_cells(film(0.75), 64, pad_cells=1e3)) < 3.1
    assert max(cell.rough for cell in sample_cells(film(0.75), 64, pad_cells=1e6)) > 3.5


def test_each_half_of_a_pad_stands_for_the_places_of_the_other():
    pressures = np.arange(24.0).reshape(6, 2, 2)
    ones = np.ones(6)
    grid = PadGrid(np.array([2.0, 1.0]), np.array([1]))
    weight = np.array([0.3, 0.2, 0.2, 0.1, 0.1, 0.1])
    settled = ones.astype(bool)
    whole = Pad(grid, weight, ones, ones, pressures, pressures[:, None], settled, FLATS)
    parts = [whole.half(other) for other in (False, True)]
    assert all(part.weight == pytest.approx([0.5, 0.3, 0.2]) for part in parts)
    assert np.concatenate([part.closing for part in parts]).sum() == pressures.sum()


def cells_with_wells(first_contact_nm):
    """Cells that pull only near where they touch first, at wells of 1 nm RMS width and 1 GPa,
    whatever their depth.
    """
    separation, depths = np.arange(50.0, 10.0, -0.1), np.array([330, 360, 390])
    wells = -np.exp(-0.5 * (separation - first_contact_nm[:, None]) ** 2)
    closing = np.stack([np.zeros_like(wells), wells], axis=1)
    opening = np.repeat(closing[:, None], depths.size, axis=1)
    for number, depth in enumerate(depths):
        opening[:, number, :, depth + 1 :] = np.nan
    count = first_contact_nm.size
    ones = np.ones(count)
    return Pad(
        PadGrid(separation, depths),
        ones / count,
        ones,
        first_contact_nm,
        closing,
        opening,
        ones > 0,
        FLATS,
    )


def test_a_dozen_cells_have_the_well_of_a_pad_of_many():
    """Wells at normal places of 3 nm: the mean of many is a well of (1 + 3^2)^0.5 nm, 0.316 GPa
    deep.
    """
    exact = (1.0 + 3.0**2) ** -0.5
    pads = [
        cells_with_wells(30.0 + 3.0 * np.random.default_rng(seed).normal(size=12))
        for seed in range(20)
    ]
    plain, smoothed = (
        np.array([-pull.min() for pull in of])
        for of in (
            [pad.mean(pad.closing)[1] for pad in pads],
            [pad.curves.closing[1] for pad in pads],
        )
    )
    assert abs(smoothed.mean() - exact) < 0.2 * (plain.mean() - exact)
    area = np.array([-0.1 * pad.curves.closing[1].sum() for pad in pads])
    # of a single well: nothing is lost
    assert area == pytest.approx((2.0 * np.pi) ** 0.5, rel=1e-3)


def test_cells_that_touch_first_at_one_separation_are_not_shifted():
    pad = cells_with_wells(np.full(3, 30.0))
    assert pad.curves.closing == pytest.approx(pad.mean(pad.closing)[:, ::-1], rel=1e-12)


def test_cells_whose_repulsion_fell_at_last_do_not_pull_by_it():
    """Asperities that merge carry less than apart; cells that stand below go on by that step."""
    first_nm = 12.0 + 3.0 * np.random.default_rng(3).normal(size=12)
    pad = cells_with_wells(first_nm)
    separation = pad.grid.separation_nm
    push = np.maximum(first_nm[:, None] - separation, 0.0)
    push[:, -1] = 0.5 * push[:, -2]
    closing = np.stack([push, pad.closing[:, 1]], axis=1)
    opening = pad.opening.copy()
    opening[:, :, 0] = np.where(np.isfinite(opening[:, :, 0]), push[:, None], np.nan)
    curves = replace(pad, closing=closing, opening=opening).curves
    assert (curves.closing[0] >= 0.0).all()
    assert (curves.opening[:, 0][np.isfinite(curves.opening[:, 0])] >= 0.0).all()


def test_a_film_whose_places_are_alike_is_one_without_places():
    grid, cells = PadGrid(np.array([60.0, 30.0, 27.0]), np.array([2])), sample_cells(MIDDLE, 4)
    alike, plain = (pressed(inputs, cells, grid) for inputs in (film(0.0), MIDDLE))
    assert (alike.closing == plain.closing).all()
    assert np.array_equal(alike.opening, plain.opening, equal_nan=True)


def test_a_rough_place_in_its_own_steps_has_the_forces_of_short_ones(monkeypatch):
    """Six times the median RMS, steps of 0.8 nm for 0.2: lines overrate a force by 6 %, underrate a
    well by 16 %.
    """
    place = Cell(FIRST_SEED, float(np.log(6.0)) / 0.4, 0.0, 1.0)
    touch = -float(surface_of(film(0.4), CONTACT, place).min())
    grid = PadGrid(
        touch + np.concatenate([np.arange(40.0, 2.0, -1.0), np.arange(2.0, -18.1, -0.2)]),
        np.array([138]),
    )
    own = pressed(film(0.4), [place], grid)
    monkeypatch.setattr("mesoscale.pad.closing.PLACE_STEP_RMS", 0.0)
    short = pressed(film(0.4), [place], grid)
    assert short.closing.max() > 0.0, "not in contact"
    assert own.closing == pytest.approx(short.closing, abs=0.1 * short.closing.max())
    wells = [float(np.nanmin(of.opening[0, 0].sum(axis=0))) for of in (own, short)]
    assert wells[0] == pytest.approx(wells[1], rel=0.2)


def test_steps_grow_with_the_roughness_of_the_places_that_touch():
    unequal, alike = (
        plan_grid(
            film(scatter),
            CONTACT,
            sample_cells(film(scatter), 16),
            1e-3 * WANTED_MPa,
            step_nm=STEP_NM,
        )
        for scatter in (0.15, 0.0)
    )
    steps = -np.diff(unequal.separation_nm)
    assert steps[-5:] == pytest.approx(STEP_NM)
    assert steps.max() < 0.2 * unequal.separation_nm[0]
    assert (np.diff(steps) < 1e-9).all()  # from far to near
    # though rough places touch much farther out
    assert unequal.separation_nm.size < 1.5 * alike.separation_nm.size


def test_where_rough_places_alone_carry_the_pad_the_grid_ends_above_the_typical_first_contact():
    pad = pressed(film(0.4), sample_cells(film(0.4), 16))
    assert (np.diff(pad.grid.separation_nm) < 0).all()
    assert pad.mean(pad.closing)[0, -1] * 1e3 == pytest.approx(WANTED_MPa, rel=0.5)


def test_mean_planes_and_heights_of_a_place_grow_together():
    """As in a film whose amplitude varies slowly from place to place."""
    cell = Cell(FIRST_SEED + 3, 0.7, -0.4, 1.0)
    times = place_ratio(film(0.5), cell)
    here = surface_of(film(0.5), CONTACT, cell)
    assert here == pytest.approx(times * FilmPieces(MIDDLE, CONTACT).surface(cell), abs=1e-9)


def test_a_film_of_long_waves_is_closed_in_steps_that_fit_its_way():
    """One wave to a cell: it carries the pressure after a fraction of a step of 0.05 RMS
    heights.
    """
    long, contact = (
        replace(MIDDLE, q0=0.001, rms=76.0),
        CONTACT.model_copy(update={"length_nm": 6000.0}),
    )
    cells = sample_cells(long, 4)
    grid = plan_grid(long, contact, cells, 1e-3 * WANTED_MPa, step_nm=0.05 * long.rms)
    steps = -np.diff(grid.separation_nm)
    assert steps[-1] <= 0.05 * long.rms / 3 + 1e-9
    assert (
        np.sum(
            grid.separation_nm
            < max(-float(surface_of(long, contact, cell).min()) for cell in cells)
        )
        > 15
    )


def test_a_coarse_film_opens_to_where_it_closes_without_a_step():
    """Ten times the lengths of the known pad: opening and closing differ up to 100 nm above the
    deepest closing.
    """
    law, _ = exponential_law([22.0, 25.0])
    coarse = replace(law, separation_nm=10 * law.separation_nm, depth_nm=10 * law.depth_nm)
    rises = np.arange(0.5, 150.0, 0.5)
    pressure = LocalPad(coarse)((220.0 + rises)[None], np.full((1, rises.size), 220.0))[0][0]
    known = np.stack([coarse.opening_GPa(np.array([220.0 + rise]), 220.0)[0] for rise in rises])
    assert pressure == pytest.approx(known, rel=1e-3, abs=2e-7)


def test_a_pad_of_one_depth_opens_from_it_without_a_warning():
    law, exact = exponential_law([23.0])
    at = np.linspace(23.0, 40.0, 50)
    with np.errstate(all="raise"):
        ours = law.opening_GPa(at, 23.0)
    # linear between separations 0.1 nm apart: (0.1 / 1.5)^2 / 8 of an exponential of 1.5 nm
    np.testing.assert_allclose(ours, np.sum(exact(at, 23.0), axis=0), rtol=2e-3, atol=1e-7)
    pressure, slope = LocalPad(law)(at[None], np.full((1, at.size), 23.0))
    np.testing.assert_allclose(pressure[0], ours, rtol=2e-2, atol=1e-6)
    assert np.isfinite(slope).all()


def test_a_spectrum_beside_the_waves_of_a_cell_is_refused_in_one_line():
    longer = ContactSettings.model_validate(
        {"pixels": 32, "surface": {"spectrum": {"q": [1e-5, 1e-4], "psd": [1, 1]}}}
    )
    with pytest.raises(InputError, match=r"the spectrum has no wave from 0\.00628"):
        FilmPieces(MIDDLE, longer)
