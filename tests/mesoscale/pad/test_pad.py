"""Cells under one plane: means, and memory between depths."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.special import ndtri

from mesoscale.contact import ContactInputs
from mesoscale.contact.surface import random_surface
from mesoscale.errors import InputError
from mesoscale.inputs.contact import FilmInputs
from mesoscale.inputs.table import film_table, input_table
from mesoscale.pad.cells import FIRST_SEED, FilmPieces, PadGrid, close_cells, place_of, plan_grid
from mesoscale.pad.curves import adhesion_by_cells, assemble
from mesoscale.pad.draws import plan_draws
from mesoscale.pad.local import LocalPad
from mesoscale.pad.memory import Flats, PadLaw, deepened, flats_of, law_of
from mesoscale.settings import ContactSettings, InputRow, PadGridSettings, PadSettings

MIDDLE = ContactInputs(hamaker=0.215, e_star=91.0, h_macro=1.95, h_prime=8.375, q0=0.025, hurst=0.75, rms=8.5)
CONTACT = ContactSettings(pixels=128)
CELLS, STEP_NM = 16, 0.2
GRID = PadGridSettings(pilot_cells=4, depths=5)
WANTED_MPa = 5.0


def wanted_GPa(separation_nm):
    return np.full_like(separation_nm, WANTED_MPa * 1e-3)


@pytest.fixture(scope="module")
def pad():
    grid = plan_grid(MIDDLE, CONTACT, GRID, wanted_GPa, step_nm=STEP_NM)
    cells = list(close_cells(MIDDLE, CONTACT, grid, range(FIRST_SEED, FIRST_SEED + CELLS)))
    return assemble(grid, cells, CONTACT.length_nm**2)


def exponential_law(depths):
    """A pad whose opening is known: exp(-(s - D) / 1.5 nm) 5 exp((25 - D)/2 nm) MPa, and a smooth attraction."""
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
    law = PadLaw(s, np.stack([closing(s), attraction(s)]), np.array(depths), opening, Flats(0.2, 0.165))
    return law, lambda at, depth: (closing(depth) * np.exp(-(at - depth) / 1.5), attraction(at))


def test_the_grid_reaches_the_pressure_and_all_first_contacts(pad):
    pressure = pad.closing[:, 0].mean(axis=0)
    assert 0.5 * WANTED_MPa < pressure[-1] * 1e3 < 2.0 * WANTED_MPa
    assert pad.grid.separation_nm[0] > pad.first_contact_nm.max()
    assert (np.diff(pad.grid.separation_nm) < 0).all()


def test_a_pad_that_one_tall_grain_carries_is_opened_from_light_loads(monkeypatch):
    piece = FilmPieces.surface

    def with_a_grain(self, seed):
        heights = piece(self, seed)
        if seed == FIRST_SEED:
            heights[:48, :48] -= 20.0
        return heights

    monkeypatch.setattr(FilmPieces, "surface", with_a_grain)
    grid = plan_grid(MIDDLE, CONTACT, GRID, wanted_GPa, step_nm=STEP_NM)
    cells = list(close_cells(MIDDLE, CONTACT, grid, range(FIRST_SEED, FIRST_SEED + GRID.pilot_cells)))
    pressure = assemble(grid, cells, CONTACT.length_nm**2).closing[:, 0].mean(axis=0)
    assert pressure[grid.depths[0]] < 0.3e-3 * WANTED_MPa


def test_a_pressure_out_of_reach_is_refused():
    rigid = ContactSettings(pixels=32, length_nm=1000.0)
    soft = ContactInputs(**{**vars(MIDDLE), "e_star": 1e-6, "hamaker": 0.0})
    with pytest.raises(InputError, match=r"of the 5 MPa that the switch presses with; lower hold_voltage_V"):
        plan_grid(soft, rigid, GRID, wanted_GPa)


def test_openings_start_where_closing_ended_and_deeper_pads_hold_more(pad):
    law = law_of(pad, flats_of(MIDDLE, CONTACT))
    for depth in law.depth_nm:
        assert law.opening_GPa(depth, depth) == pytest.approx(law.closing_GPa(depth), rel=1e-6)


def test_memory_between_depths_is_exact_for_exponential_branches():
    law, exact = exponential_law([21.0, 23.0, 25.0, 27.0])
    at = np.linspace(24.0, 40.0, 50)
    repulsion, attraction = exact(at, 24.0)
    # linear between separations 0.1 nm apart: (0.1 / 1.5)^2 / 8 of an exponential of 1.5 nm; and s^-3 taken as an
    # exponential between depths 2 nm apart: (3 / s^2) 2^2 / 8
    error = np.abs(law.opening_GPa(at, 24.0) - repulsion - attraction)
    assert (error <= 6e-4 * repulsion + 2.7e-3 * np.abs(attraction)).all()


def test_a_pad_that_is_continued_below_its_deepest_closing_is_exact_for_exponential_branches():
    law, exact = exponential_law([22.0, 24.0])
    law = PadLaw(law.separation_nm[20:], law.closing[:, 20:], law.depth_nm, law.opening[:, :, 20:], law.flats)
    deeper = deepened(law)
    depth = float(deeper.depth_nm[0])
    assert depth == pytest.approx(22.0 - 2.0 * np.log(2.0))  # twice the repulsion, whose e-fold is 2 nm
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
    law = law_of(pad, flats_of(MIDDLE, CONTACT))
    far = law.separation_nm[-1]
    flats = -MIDDLE.hamaker / (6 * np.pi * (far + CONTACT.gap_cutoff_nm) ** 3)
    # two flats to 1 + 6 (rms / separation)^2
    assert law.closing_GPa(far) == pytest.approx(flats, rel=0.02, abs=0)
    twice = (2 * far + CONTACT.gap_cutoff_nm) / (far + CONTACT.gap_cutoff_nm)
    assert law.closing_GPa(2 * far) == pytest.approx(flats / twice**3, rel=1e-12, abs=0)
    pressure, slope = LocalPad(law)(np.array([[2 * far]]), np.array([[np.inf]]))
    assert pressure[0, 0] == pytest.approx(flats / twice**3, rel=1e-12, abs=0)
    assert slope[0, 0] == pytest.approx(-3 * pressure[0, 0] / (2 * far + CONTACT.gap_cutoff_nm), rel=1e-12, abs=0)


def test_adhesion_falls_with_the_number_of_cells(pad):
    rows = adhesion_by_cells(pad, (1, 4, 8))
    deepest = [row for row in rows if row["depth_nm"] == rows[-1]["depth_nm"]]
    values = [row["net_adhesion_kPa"] for row in deepest if row["method"] == "groups"]
    assert values == sorted(values, reverse=True)
    assert deepest[-1]["cells"] == CELLS


def test_groups_of_equal_cells_pull_as_one_cell():
    """Without scatter between cells nothing averages out."""
    separation = np.linspace(40.0, 20.0, 50)
    grid = PadGrid(separation, np.array([49]))
    net = -np.exp(-((separation - 30.0) ** 2))
    one = np.stack([np.zeros(50), net])
    from mesoscale.pad.curves import PadCells

    cells = PadCells(grid, np.full(16, 31.0), np.tile(one, (16, 1, 1)), np.tile(one, (16, 1, 1, 1)), np.ones(16, bool))
    for row in adhesion_by_cells(cells, (1, 2, 8)):
        assert row["net_adhesion_kPa"] == pytest.approx(-net.min() * 1e6)


def test_cells_are_pieces_of_a_film():
    """Mean planes and RMS heights scatter as those of square pieces cut out of films of four times the side."""
    small = ContactSettings(pixels=64)
    large = ContactSettings(pixels=256, length_nm=4000.0)
    pieces = FilmPieces(MIDDLE, small)
    ours = np.array([pieces.surface(seed) for seed in range(300)])
    films = [random_surface(MIDDLE, large, seed) for seed in range(40)]
    cut = np.concatenate([film.reshape(4, 64, 4, 64).swapaxes(1, 2).reshape(16, 64, 64) for film in films])
    for of_surface in (lambda h: h.mean(axis=(1, 2)), lambda h: h.std(axis=(1, 2))):
        # a deviation from 300 pieces is known to 4 %; a cut piece also holds parts of waves longer than itself
        assert of_surface(ours).std() == pytest.approx(of_surface(cut).std(), rel=0.35)
    assert np.mean(ours**2) == pytest.approx(MIDDLE.rms**2, rel=0.02)
    assert np.mean(cut**2) == pytest.approx(MIDDLE.rms**2, rel=0.02)


def film(scatter):
    return FilmInputs(**vars(MIDDLE), rms_scatter=scatter)


def test_places_of_successive_seeds_are_spread_evenly():
    """Windows of 64 cells: independent places would miss the mean of ln RMS by 0.3 / 8."""
    logs = np.log([place_of(film(0.3), FIRST_SEED + number).rms / MIDDLE.rms for number in range(6400)])
    windows = logs.reshape(100, 64)
    assert windows.mean(axis=1).std() < 0.4 * 0.3 / 8
    assert windows.std(axis=1) == pytest.approx(0.3, rel=0.1)
    assert np.sort(logs) == pytest.approx(0.3 * ndtri((np.arange(6400) + 0.5) / 6400), abs=0.05)


def test_a_film_whose_places_are_alike_is_one_without_places():
    grid = PadGrid(np.array([60.0, 30.0, 27.0]), np.array([2]))
    alike, plain = (
        assemble(grid, list(close_cells(inputs, CONTACT, grid, range(4))), 1.0) for inputs in (film(0.0), MIDDLE)
    )
    assert (alike.closing == plain.closing).all()
    assert np.array_equal(alike.opening, plain.opening, equal_nan=True)


def test_steps_grow_with_the_roughness_of_the_places_that_touch():
    unequal, alike = (plan_grid(film(scatter), CONTACT, GRID, wanted_GPa, step_nm=STEP_NM) for scatter in (0.15, 0.0))
    steps = -np.diff(unequal.separation_nm)
    assert steps[-5:] == pytest.approx(STEP_NM)
    assert steps.max() < 0.2 * unequal.separation_nm[0]
    assert (np.diff(steps) < 1e-9).all()  # from far to near
    assert unequal.separation_nm.size < 1.5 * alike.separation_nm.size  # though rough places touch much farther out


def test_where_rough_places_alone_carry_the_pad_the_grid_ends_above_the_typical_first_contact():
    grid = plan_grid(film(0.4), CONTACT, GRID, wanted_GPa, step_nm=STEP_NM)
    assert (np.diff(grid.separation_nm) < 0).all()
    pad = assemble(
        grid, list(close_cells(film(0.4), CONTACT, grid, range(FIRST_SEED, FIRST_SEED + 4))), CONTACT.length_nm**2
    )
    assert pad.closing[:, 0, -1].mean() * 1e3 == pytest.approx(WANTED_MPa, rel=0.5)


def test_mean_planes_and_heights_of_a_place_grow_together():
    """As in a film whose amplitude varies slowly from place to place."""
    seed = FIRST_SEED + 3
    times = place_of(film(0.5), seed).rms / MIDDLE.rms
    here = FilmPieces(place_of(film(0.5), seed), CONTACT).surface(seed)
    assert here == pytest.approx(times * FilmPieces(MIDDLE, CONTACT).surface(seed), abs=1e-9)


def test_a_film_of_two_kinds_of_places_carries_what_both_kinds_carry(monkeypatch):
    """Half of the places smooth, half rough: cells are independent, so the pad is the mean of both pads."""
    smooth, rough = (replace(MIDDLE, rms=rms) for rms in (2.0, 8.0))
    grid = PadGrid(np.concatenate([np.arange(60.0, 40.0, -2.0), np.arange(40.0, 23.0, -0.5)]), np.array([40]))
    of_kind = [assemble(grid, list(close_cells(kind, CONTACT, grid, range(0, 32, 2))), 1.0) for kind in (smooth, rough)]
    monkeypatch.setattr("mesoscale.pad.cells.place_of", lambda inputs, seed: (smooth, rough)[seed % 2])
    mixed = assemble(grid, list(close_cells(film(0.7), CONTACT, grid, range(32))), 1.0)
    expected = 0.5 * (of_kind[0].closing + of_kind[1].closing).mean(axis=0)
    error = mixed.closing.std(axis=0) / 32**0.5 * 2**0.5
    assert np.abs(mixed.closing.mean(axis=0) - expected)[0, -1] < 3 * error[0, -1]
    # rough places alone carry it: the mean of heights would put the load at the middle RMS
    assert of_kind[0].closing[:, 0].max() == 0.0 < expected[0, -1]


def test_a_film_of_long_waves_is_closed_in_steps_that_fit_its_way():
    """One wave to a cell: it carries the pressure after a fraction of a step of 0.05 RMS heights."""
    long, contact = replace(MIDDLE, q0=0.001, rms=76.0), CONTACT.model_copy(update={"length_nm": 6000.0})
    grid = plan_grid(long, contact, GRID, wanted_GPa, step_nm=0.05 * long.rms)
    steps = -np.diff(grid.separation_nm)
    assert steps[-1] <= 0.05 * long.rms / 3 + 1e-9
    pilots = [-float(FilmPieces(long, contact).surface(FIRST_SEED + k).min()) for k in range(GRID.pilot_cells)]
    assert np.sum(grid.separation_nm < max(pilots)) > 15


def test_a_coarse_film_opens_to_where_it_closes_without_a_step():
    """Ten times the lengths of the known pad: opening and closing differ up to 100 nm above the deepest closing."""
    law, _ = exponential_law([22.0, 25.0])
    coarse = replace(law, separation_nm=10 * law.separation_nm, depth_nm=10 * law.depth_nm)
    rises = np.arange(0.5, 150.0, 0.5)
    pressure = LocalPad(coarse)((220.0 + rises)[None], np.full((1, rises.size), 220.0))[0][0]
    known = np.stack([coarse.opening_GPa(np.array([220.0 + rise]), 220.0)[0] for rise in rises])
    assert pressure == pytest.approx(known, rel=1e-3, abs=2e-7)


def test_a_D0_that_is_an_input_is_not_drawn_twice():
    drawn = {draw.gap_cutoff_nm for draw in plan_draws(input_table(), CONTACT, 6, 4)}
    assert len(drawn) == 6
    fixed = input_table(gap_cutoff=InputRow(distribution="fixed", values=(3.7,)))
    assert {draw.gap_cutoff_nm for draw in plan_draws(fixed, CONTACT, 6, 4)} == {3.7}


def test_draws_of_unequal_places_have_the_same_surfaces():
    assert len({draw.seeds for draw in plan_draws(input_table(), CONTACT, 6, 4)}) == 6
    film = film_table(input_table(), {}, (0.2, 0.5))
    assert len({draw.seeds for draw in plan_draws(film, CONTACT, 6, 4)}) == 1


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
    longer = ContactSettings.model_validate({"pixels": 32, "surface": {"spectrum": {"q": [1e-5, 1e-4], "psd": [1, 1]}}})
    with pytest.raises(InputError, match=r"the spectrum has no wave from 0\.00628"):
        FilmPieces(MIDDLE, longer)


def test_pilots_are_cells_and_many_of_unequal_places():
    few, usual = (PadSettings.model_validate({"cells": cells, "grid": {"pilot_cells": 32}}) for cells in (16, 128))
    assert [few.piloted(unequal).pilot_cells for unequal in (False, True)] == [16, 16]
    assert [usual.piloted(unequal).pilot_cells for unequal in (False, True)] == [32, 64]
