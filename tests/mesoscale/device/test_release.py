"""The answer: shares of the variance, the response of a pad to its inputs, and the switch on both."""

from dataclasses import replace
from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.special import ndtri
from scipy.stats import qmc

from mesoscale.device import pad_results
from mesoscale.device.beam_kernels import BANDS, solve_bands
from mesoscale.device.beam_switch import BeamStates, press_GPa
from mesoscale.device.electrode import presser, releases_by_cells, solve_deepened
from mesoscale.device.pad_switch import PadStates
from mesoscale.device.pressing import EDGE, EXACT, FAR_OUT, hardest, held_V, pressing, pressure_to_compute
from mesoscale.device.release import (
    _probability,
    draws_error_V,
    first_order,
    model_of,
    plan_points,
    solve_points,
    try_answer,
)
from mesoscale.errors import InputError, NotComputed
from mesoscale.inputs.distributions import Distribution, InputTable, UncertainInput
from mesoscale.inputs.table import film_table
from mesoscale.pad.cells import PadGrid
from mesoscale.pad.compact import CompactPad
from mesoscale.pad.curves import PadCells
from mesoscale.pad.draws import Draw, draw_rows, laws_of_rows
from mesoscale.pad.memory import Flats
from mesoscale.pad.response import SampledPad, fit_response, law_of_compact
from mesoscale.settings import ContactSettings, DeviceSettings
from mesoscale.settings.device import SpreadRow, SpreadSettings

RANGES = {"hamaker": (0.18, 0.25), "e_star": (80.0, 100.0), "rms": (6.0, 12.0)}
TABLE = InputTable(
    tuple(UncertainInput(name, "", Distribution("uniform", *ends), "literature", "") for name, ends in RANGES.items()),
    np.eye(3),
)
MIDDLE = TABLE.medians()
PLATE = DeviceSettings(spring_N_per_m=170.0)


def true_pad(values, gap_cutoff_nm, lifted=0.0):
    """A closed form that depends on the inputs as a response can."""
    z, size = (values["e_star"] - 90.0) / 10.0, np.log(values["rms"] / MIDDLE["rms"])
    rms = values["rms"]
    strength = values["hamaker"] * np.exp(-1.5 + 0.1 * z - 1.2 * np.log(gap_cutoff_nm / 0.165))
    return CompactPad(
        -4.0 + 0.2 * z + 0.3 * size, 3.0 / rms, 0.05 / rms**2, (3.5 + 0.3 * z) / rms, 0.2 / rms**2, 0.05 / rms**2,
        strength, 0.95, 0.5, lifted, values["hamaker"], gap_cutoff_nm,
    )  # fmt: skip


def sampled(values, gap_cutoff_nm, cells=4, lifted=0.0, higher=0.0):
    """A pad of few cells; `higher`: by how much the logarithm of its repulsion differs from that of all cells."""
    compact = true_pad(values, gap_cutoff_nm, lifted)
    compact = replace(compact, c0=compact.c0 - higher)
    s = np.linspace(0.05, 12.0, 600) * values["rms"]
    law = law_of_compact(compact, np.full(s.size, 0.05), s, depths=5)
    return SampledPad(values, gap_cutoff_nm, cells, law)


@pytest.fixture(scope="module")
def pads():
    units = qmc.LatinHypercube(4, rng=1).random(12)
    values = [dict(zip(TABLE.names, row, strict=True)) for row in TABLE.transform(units[:, :3]).tolist()]
    cutoffs = 0.165 + 0.1 * units[:, 3]
    return [sampled(MIDDLE, 0.165, 64), *(sampled(row, cut) for row, cut in zip(values, cutoffs, strict=True))]


@pytest.mark.parametrize("lifted", [0.0, 4.0])
def test_the_response_finds_a_closed_form_that_is_of_its_kind(pads, lifted):
    """Pads without scatter: the form at inputs that no pad had is the true one."""
    response = fit_response([sampled(pad.values, pad.gap_cutoff_nm, lifted=lifted) for pad in pads], TABLE)
    values = {"hamaker": 0.2, "e_star": 84.0, "rms": 7.0}
    state, wanted = response.at(values, 0.2), true_pad(values, 0.2, lifted)
    s = np.linspace(10.0, 30.0, 50)
    for ours, theirs in zip(state.opening_GPa(s, 9.0), wanted.opening_GPa(s, 9.0), strict=True):
        np.testing.assert_allclose(ours, theirs, rtol=1e-6)


def test_pads_that_scatter_by_where_they_touch_have_their_slope_and_level():
    """Repulsion falls by 4 per RMS height from 5 ± 0.5 RMS heights on: lines over s would be flat."""
    table = film_table(TABLE, {}, (0.2, 0.6))
    rng = np.random.default_rng(3)
    units = qmc.LatinHypercube(4, rng=rng).random(24)
    pads = []
    for row in table.transform(units).tolist():
        values = dict(zip(table.names, row, strict=True))
        at = 5.0 + 0.5 * rng.normal()
        compact = replace(true_pad(values, 0.3), c0=7.0 - 4.0 * at, c1_per_nm=4.0 / values["rms"], c2_per_nm2=0.0)
        s = np.linspace(at - 0.5, at + 3.0, 300) * values["rms"]
        pads.append(SampledPad(values, 0.3, 4, law_of_compact(compact, np.full(s.size, 1.0), s, depths=5)))
    found = fit_response(pads, table).at(table.medians(), 0.3)
    rms = table.medians()["rms"]
    assert found.c1_per_nm * rms == pytest.approx(4.0, rel=0.02)
    assert (7.0 - found.c0) / (found.c1_per_nm * rms) == pytest.approx(5.0, abs=0.3)  # the mean of 24


def test_a_form_beyond_all_numbers_is_refused():
    s = np.linspace(0.05, 12.0, 600)
    endless = SimpleNamespace(closing_GPa=lambda at: np.stack([np.where(at < 6.0, np.inf, 1e-3 / at), -1e-9 / at]))
    with pytest.raises(InputError, match="the closed form of the pad carries inf GPa"):
        law_of_compact(endless, np.full(s.size, 1.0), s)


def test_too_few_draws_are_refused_with_the_number_that_is_enough(pads):
    with pytest.raises(InputError, match=r"pad\.draws = 2: accepted are at least 4"):
        fit_response(pads[:3], TABLE)


def test_curves_of_draws_come_back_from_their_rows(pads):
    rest = {"h_macro": 1.95, "h_prime": 8.375, "q0": 0.025, "hurst": 0.75}
    draws = [Draw(k, pad.values | rest, pad.gap_cutoff_nm, range(0)) for k, pad in enumerate(pads[:2])]
    rows = [
        {name: "" if value is None else repr(value) for name, value in row.items()}
        for draw, pad in zip(draws, pads, strict=False)
        for row in draw_rows(draw, pad.law)
    ]
    for pad, law in zip(pads, laws_of_rows(rows, draws, ContactSettings()), strict=False):
        np.testing.assert_allclose(law.opening, pad.law.opening, rtol=1e-12)
        np.testing.assert_allclose(law.closing, pad.law.closing, rtol=1e-12)
        assert law.flats == pad.law.flats


def test_shares_of_the_variance_are_those_of_a_known_function():
    """y = 3 x1 + x2^2: variances 9/3 and 4/45."""
    units = qmc.LatinHypercube(3, rng=2).random(200)
    x = 2.0 * units - 1.0
    shares, error = first_order(units, 3.0 * x[:, 0] + x[:, 1] ** 2)
    total = 3.0 + 4.0 / 45.0
    np.testing.assert_allclose(shares, [3.0 / total, 4.0 / 45.0 / total, 0.0], atol=0.02)
    assert error < 1e-9


def test_geometry_counts_only_where_the_electrode_bends():
    names, _, _, points = plan_points(TABLE, DeviceSettings(), 0.165, 0.3)
    assert {"bow_nm", "tilt_nm"} < set(names)
    assert len({point.device.bow_nm for point in points}) == len(points)
    assert not {"bow_nm", "thickness_um"} & set(plan_points(TABLE, PLATE, 0.165, 0.3)[0])
    assert "gap_cutoff" not in plan_points(TABLE, PLATE, 0.165, 0.165)[1]


def test_pads_are_computed_to_more_than_the_plate_can_press():
    s = np.array([10.0, 20.0])
    plate, beam = pressure_to_compute(PLATE)(s), pressure_to_compute(DeviceSettings())(s)
    assert (beam > plate).all()
    assert plate[0] > plate[1]
    assert (pressure_to_compute(hardest(pressing(DeviceSettings(), spread=True)))(s) > beam).all()
    tilted = DeviceSettings(tilt_nm=50.0, spread=SpreadSettings(tilt_nm=None))
    assert pressing(tilted, spread=True) == pressing(DeviceSettings(), spread=True)


def test_the_hardest_device_is_one_deviation_out_in_all_that_presses():
    """Of a plate the pressure goes with the cube of the gap; what adds up, adds by squares."""
    wide = SpreadRow(distribution="normal", values=(0.0, 0.1), relative=True)
    gap, thin = PLATE.gap_um * 1e3, PLATE.dielectric_nm / PLATE.permittivity
    of_gap = ((gap * (1 + 0.1 * ndtri(FAR_OUT)) + thin) / (gap + thin)) ** 3 - 1
    alone = PLATE.model_copy(update={"spread": EXACT.model_copy(update={"gap_um": wide})})
    assert held_V(hardest(alone)) ** 2 / held_V(PLATE) ** 2 == pytest.approx(1 + of_gap, rel=1e-6)
    assert hardest(PLATE.model_copy(update={"spread": EXACT})).hold_voltage_V == pytest.approx(held_V(PLATE))


@pytest.mark.parametrize("settings", [PLATE, DeviceSettings()])
def test_a_pad_that_is_pressed_harder_than_it_was_computed_is_continued(settings):
    s = np.linspace(0.05, 12.0, 600) * MIDDLE["rms"]
    local = pressure_to_compute(settings)(
        s
    )  # 2.5 times that of the voltage alone, with less than which a plate presses
    enough, less = (law_of_compact(true_pad(MIDDLE, 0.165), share * local, s) for share in (1.5, 0.3))
    computed, continued = solve_deepened(settings, enough), solve_deepened(settings, less)
    assert (computed["deepened"], continued["deepened"]) == (0.0, 1.0)
    # an opening from deeper is stiffer than from the deepest computed depth, and the tail of closing is Gaussian
    assert continued["release_V"] == pytest.approx(computed["release_V"], rel=0.01)
    assert continued["capacitance_fF"] == pytest.approx(computed["capacitance_fF"], rel=0.01)


def test_a_pad_that_was_closed_far_too_little_stays_refused():
    s = np.linspace(0.05, 12.0, 600) * MIDDLE["rms"]
    smooth = replace(true_pad(MIDDLE, 0.165), beta=0.0, hamaker=1e-9)
    with pytest.raises(NotComputed, match="where its curves end"):
        solve_deepened(DeviceSettings(), law_of_compact(smooth, np.full(s.size, 0.001), s))


@pytest.mark.parametrize("change", [{}, {"bow_nm": 500.0}, {"residual_stress_MPa": 50.0}, {"hold_voltage_V": 120.0}])
def test_pilots_know_what_the_beam_will_press_with(change):
    """From a closing curve that ends too early, within the 15 % by which pilot cells are off."""
    settings = DeviceSettings().model_copy(update=change)
    s = np.linspace(0.05, 12.0, 1200) * MIDDLE["rms"]
    compact = true_pad(MIDDLE, 0.165)
    local = pressure_to_compute(settings)(s)
    short, long = (law_of_compact(compact, share * local, s) for share in (0.6, 3.0))
    pressed = presser(settings)(short.separation_nm, short.closing.sum(axis=0))
    assert pressed == pytest.approx(press_GPa(settings, long), rel=0.15)
    assert pressed > 1.3 * float(local[np.searchsorted(s, short.separation_nm[0])]) / EDGE


def test_a_pad_closed_nearly_to_its_mean_plane_asks_for_nothing_deeper():
    """Its repulsion cannot double before the mean planes meet, so no plan would ever carry the switch."""
    separation = np.linspace(0.5, 3.0, 20)
    assert presser(DeviceSettings())(separation, 1e-6 * np.exp(-(separation - 3.0))) == 0.0


@pytest.mark.parametrize(("settings", "stuck", "passed"), [(DeviceSettings(), 0, True), (DeviceSettings(), 12, False)])
def test_the_gate_judges_the_electrode_that_the_answer_has(monkeypatch, settings, stuck, passed):
    """A flat plate that sticks on half of the resampled pads says nothing of an electrode that bends."""
    state = BeamStates(3490.0, 60.0, 60.0, 7.0, False, 0.5, 0.02, 5.0, 100.0)
    flat = [PadStates(60.0, 20.0, 5.0, float(k % 2), k % 2 == 0, 9.0) for k in range(pad_results.RESAMPLES)]
    monkeypatch.setattr(pad_results, "solve_beam", lambda *_: state)
    monkeypatch.setattr(pad_results, "solve_on_pad", lambda *_: flat[1])
    monkeypatch.setattr(pad_results, "resampled_states", lambda *_: flat)
    released = np.repeat([0.0, 7.0], [stuck, 24 - stuck])
    grid = PadGrid(np.array([30.0, 20.0]), np.array([1]))
    forces = np.zeros((8, 2, 2))
    cells = PadCells(grid, np.full(8, 30.0), forces, forces[:, None], np.ones(8, bool))
    gate = pad_results.switch_on_pad(cells, Flats(0.2, 0.0), settings, 1e6, lambda: released)["gate"]
    assert gate["passed"] is passed
    assert passed or "12 of 24 resampled pads; raise pad.cells" in gate["reasons"][0]


def test_a_plate_that_cannot_be_solved_says_nothing_of_an_electrode_that_bends(monkeypatch):
    state = BeamStates(3490.0, 60.0, 60.0, 7.0, False, 0.5, 0.02, 5.0, 100.0)

    def refused(*_):
        raise NotComputed("deepest closing 18.5 nm: the pad was computed for 11.8 .. 18.2 nm")

    monkeypatch.setattr(pad_results, "solve_beam", lambda *_: state)
    monkeypatch.setattr(pad_results, "solve_on_pad", refused)
    grid = PadGrid(np.array([30.0, 20.0]), np.array([1]))
    forces = np.zeros((8, 2, 2))
    cells = PadCells(grid, np.full(8, 30.0), forces, forces[:, None], np.ones(8, bool))
    bending = pad_results.switch_on_pad(cells, Flats(0.2, 0.0), DeviceSettings(), 1e6, lambda: np.full(24, 7.0))
    assert bending["gate"] == {"passed": True, "reasons": []}
    assert bending["mean"] is None
    assert bending["beam"]["release_V"] == 7.0
    flat = pad_results.switch_on_pad(cells, Flats(0.2, 0.0), PLATE, 1e6, lambda: np.full(24, 7.0))
    assert not flat["gate"]["passed"]


@pytest.mark.parametrize("settings", [PLATE, DeviceSettings()])
def test_a_hold_voltage_that_never_closes_the_switch_is_refused_in_one_line(settings):
    s = np.linspace(0.05, 12.0, 600) * MIDDLE["rms"]
    law = law_of_compact(true_pad(MIDDLE, 0.165), 2.0 * pressure_to_compute(settings)(s), s)
    pull_in = solve_deepened(settings, law)["pull_in_V"]
    assert solve_deepened(settings.model_copy(update={"hold_voltage_V": 1.01 * pull_in}), law)["release_V"] >= 0.0
    for share in (0.8, 0.99):
        with pytest.raises(InputError, match=f"never closes this switch, which pulls in at {pull_in:.4g} V") as caught:
            solve_deepened(settings.model_copy(update={"hold_voltage_V": share * pull_in}), law)
        assert "\n" not in str(caught.value)


def test_a_closed_form_that_rises_with_the_separation_is_refused_in_one_line():
    s = np.linspace(0.05, 12.0, 600) * MIDDLE["rms"]
    rising = SimpleNamespace(closing_GPa=lambda at: np.stack([1e-6 * at, 0.0 * at]))
    with pytest.raises(InputError, match="the closed form of the pad still presses there"):
        law_of_compact(rising, np.full(s.size, 1.0), s)


def test_refused_points_widen_the_probability_of_sticking():
    closed, opened = _probability(4, 10, 0), _probability(4, 8, 2)
    assert opened["value"] == 0.5
    assert opened["low"] == closed["low"]
    assert opened["high"] > closed["high"]


@pytest.fixture(scope="module")
def alike(pads):
    """The central pad, of cells without scatter."""
    law = pads[0].law
    grid = PadGrid(law.separation_nm[::-1], np.flatnonzero(np.isin(law.separation_nm[::-1], law.depth_nm)))
    closing = np.tile(law.closing[:, ::-1], (16, 1, 1))
    one = np.full((len(grid.depths), 2, law.separation_nm.size), np.nan)
    for k, depth in enumerate(grid.depth_nm):
        above = law.separation_nm >= depth - 1e-9
        one[k][:, above] = true_pad(MIDDLE, 0.165).opening_GPa(law.separation_nm[above], depth)
    return PadCells(grid, np.full(16, 30.0), closing, np.tile(one[:, :, ::-1], (16, 1, 1, 1)), np.ones(16, bool))


def test_the_error_by_the_draws_is_how_answers_of_other_draws_scatter(pads, alike):
    """Of answers by independent draws whose few cells scatter, and nothing where they do not."""
    about = TABLE, pads[0].law.flats
    points = plan_points(TABLE, PLATE, 0.165, 0.265, 24)[3][:8]
    rng = np.random.default_rng(7)

    def drawn(deviation):
        units = qmc.LatinHypercube(4, rng=rng).random(24)
        values = [dict(zip(TABLE.names, row, strict=True)) for row in TABLE.transform(units[:, :3]).tolist()]
        higher = deviation * rng.normal(size=24)
        return [
            sampled(*row, higher=more) for *row, more in zip(values, 0.165 + 0.1 * units[:, 3], higher, strict=True)
        ]

    assert draws_error_V(alike, drawn(0.0), *about, points, 0.165) < 0.01
    medians, errors = [], []
    for _ in range(12):  # whose deviation is known to 21 %
        draws = drawn(1.0)
        solved, _ = solve_points(points, model_of(alike, draws, *about, 0.165))
        medians.append(np.median([state["release_V"] for state in solved.values()]))
        errors.append(draws_error_V(alike, draws, *about, points, 0.165))
    assert np.sqrt(np.mean(np.square(errors))) == pytest.approx(np.std(medians, ddof=1), rel=0.5)
    assert draws_error_V(alike, draws[:4], *about, points, 0.165) is None


def test_the_answer_keeps_its_causes_apart(pads, alike):
    """A plate on pads without scatter between cells: the cells' share is nothing, the inputs' nearly all."""
    law = pads[0].law
    released = partial(releases_by_cells, PLATE, alike, law.flats)
    state = try_answer(alike, pads[1:], TABLE, law.flats, PLATE, 0.165, released, 2)
    assert state["answer_status"] == "ok"
    shares = {row["cause"]: row["share_of_variance"] for row in state["answer"]["causes"]}
    assert shares["cells"] < 1e-9
    assert shares["inputs"] + shares["gap_cutoff"] > 0.8
    assert state["answer"]["sensitivity"][0]["share_of_variance"] > 0.3
    beside = state["answer"]["at_curves"]
    assert beside["gap_cutoff_nm"] == 0.165
    assert beside["by_carried_curves"]["release_V"] == pytest.approx(beside["by_curves"]["release_V"], rel=2e-3)
    middle = 0.5 * (0.165 + max(pad.gap_cutoff_nm for pad in pads))
    assert state["answer"]["central"]["gap_cutoff_nm"] == pytest.approx(middle)


def test_banded_systems_with_a_border_are_solved_with_row_exchanges():
    """Even where the band without its border is singular."""
    rng = np.random.default_rng(0)
    n = 20
    for singular in (False, True):
        full = np.triu(np.tril(rng.normal(size=(n + 1, n + 1)), BANDS), -BANDS)
        full[np.arange(n), np.arange(n)] *= 1e-3
        full[:, n], full[n] = rng.normal(size=n + 1), rng.normal(size=n + 1)
        if singular:
            full[n - 1, :n] = 0.0
        bands, sides = np.zeros((n, 3 * BANDS + 1)), rng.normal(size=(n, 2))
        for i in range(n):
            for j in range(max(i - BANDS, 0), min(i + BANDS + 1, n)):
                bands[i, j - i + BANDS] = full[i, j]
        wanted = np.linalg.solve(full, np.vstack([sides, np.zeros(2)]))[:n]
        bordered = np.column_stack([sides, full[:n, n]])
        solve_bands(bands, full[n, :n].copy(), full[n, n], bordered)
        np.testing.assert_allclose(bordered[:, :2], wanted, rtol=1e-7)
