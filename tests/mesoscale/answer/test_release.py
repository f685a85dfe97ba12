"""The answer: points of the joint distribution, shares of the variance, and the switch on known
pads.
"""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from evidence.failure.rare_failures import known_pad
from evidence.pad.closed_form import ClosedForm
from mesoscale.answer import points, switches
from mesoscale.answer.other_devices import release_by_key
from mesoscale.answer.points import central_point, plan_points
from mesoscale.answer.release import (
    _probability,
    answer,
    answered_in_part,
    shrinks_by,
    switch_on_pad,
)
from mesoscale.answer.switches import PadModel, Solved, solve_point, solve_points
from mesoscale.errors import InputError, NotComputed
from mesoscale.inputs.table import input_table
from mesoscale.pad.curves import closing_alone
from mesoscale.pad.grid import PadGrid, usual_step_nm
from mesoscale.pad.pressed import Pad
from mesoscale.settings import ContactSettings, InputRow
from mesoscale.studies.answer_stability import published_beam
from mesoscale.switch import switch_of
from mesoscale.switch.beam_kernels import solve_beam_matrix
from mesoscale.switch.switch import EDGE

CONTACT = ContactSettings(mechanics="asperity")
PLATE = published_beam(spring_N_per_m=170.0)
RMS = 9.0
SEPARATION = np.linspace(0.05, 12.0, 1200) * RMS
MIDDLE = ClosedForm(
    -4.0,
    3.0 / RMS,
    0.05 / RMS**2,
    3.5 / RMS,
    0.2 / RMS**2,
    0.05 / RMS**2,
    0.048,
    0.95,
    0.5,
    0.0,
    0.215,
    0.165,
)
"""A pad with numbers near those of Table 1."""


def table(**rows):
    """Inputs of Table 1 of which three vary, as those of the study of rare failures, and what is
    stated.
    """
    fixed = {"h_macro": 1.95, "h_prime": 8.375, "q0": 0.025, "hurst": 0.75}
    stated = {
        name: InputRow(distribution="fixed", values=(value,)) for name, value in fixed.items()
    }
    stated["e_star"] = InputRow(distribution="normal", values=(90.0, 4.0))
    stated["rms"] = InputRow(distribution="normal", values=(9.0, 0.8))
    return input_table(**stated | rows)


TABLE = table()


def pad_of_two(law, scale):
    """A pad of two cells that have the law's pressures times 1 - scale and 1 + scale."""
    grid = PadGrid(
        law.separation_nm[::-1], np.flatnonzero(np.isin(law.separation_nm[::-1], law.depth_nm))
    )
    closing, opening = law.closing[:, ::-1], law.opening[::-1, :, ::-1]
    both = np.array([1.0 - scale, 1.0 + scale])
    return Pad(
        grid,
        np.array([0.5, 0.5]),
        np.ones(2),
        np.full(2, 30.0),
        both[:, None, None] * closing,
        both[:, None, None, None] * opening,
        np.ones(2, bool),
        law.flats,
    )


@pytest.fixture
def known(monkeypatch):
    """Pads are those of a closed form, whose two cells differ by a tenth."""

    def press_pad(point, contact, cells, first_seed, **_):
        law = known_pad(point).curves
        return pad_of_two(law, 0.1 / np.sqrt(cells / 2))

    monkeypatch.setattr(switches, "press_pad", press_pad)


def model_of(settings, count, cells=2):
    design = plan_points(TABLE, CONTACT, settings, count)
    numbered = list(enumerate(design.points, 1))
    central = solve_point(central_point(TABLE, CONTACT, settings), CONTACT, cells, 0)
    return PadModel(central, design, tuple(solve_points(numbered, CONTACT, cells)))


def test_points_fill_what_varies_and_nothing_else():
    design = plan_points(table(), CONTACT, published_beam(), 40)
    varying = {design.names[k] for k in design.varying}
    assert {"hamaker", "rms", "gap_cutoff_nm", "bow_nm"} < varying
    assert not {"q0", "hurst"} & varying
    for k in design.varying:  # a Latin hypercube: one in each of 40 equal classes
        assert set(np.floor(40 * design.probability[:, k])) == set(range(40))
    plates = plan_points(table(), CONTACT, PLATE, 4)
    assert not {"bow_nm", "thickness_um"} & set(plates.names)


def test_a_D0_that_is_an_input_is_not_drawn_twice():
    drawn = {point.gap_cutoff_nm for point in plan_points(table(), CONTACT, PLATE, 6).points}
    assert len(drawn) == 6
    stated = table(gap_cutoff=InputRow(distribution="fixed", values=(3.7,)))
    design = plan_points(stated, CONTACT, PLATE, 6)
    assert {point.gap_cutoff_nm for point in design.points} == {3.7}
    assert "gap_cutoff_nm" not in {design.names[k] for k in design.varying}


@pytest.mark.parametrize(("reaches", "pixels"), [(0.2, 64), (0.4, 128), (0.41, 256)])
def test_pads_have_the_coarsest_grid_that_holds_all_waves(reaches, pixels):
    row = InputRow(distribution="uniform", values=(0.1, reaches))
    contact = ContactSettings(mechanics="asperity", pixels=256)
    assert points.on_pad_grid(contact, table(q1=row)).pixels == pixels
    assert points.on_pad_grid(contact, table()).pixels == 256  # the grid is the cut-off


def test_an_undecided_point_has_more_cells_and_a_decided_one_has_not(known, monkeypatch):
    asked = []
    press = switches.press_pad

    def counted(point, contact, cells, first_seed, **options):
        asked.append(cells)
        return press(point, contact, cells, first_seed, **options)

    monkeypatch.setattr(switches, "press_pad", counted)
    point = central_point(TABLE, CONTACT, PLATE)
    (decided,) = solve_points([(1, point)], CONTACT, 2)
    assert asked == [2]
    assert decided.error_V == pytest.approx(0.5 * abs(decided.halves_V[0] - decided.halves_V[1]))
    monkeypatch.setattr(switches, "UNDECIDED_SHARE", 1e-6)
    monkeypatch.setattr(switches, "UNDECIDED_OF_RELEASE", 1e-6)
    list(solve_points([(1, point)], CONTACT, 2))
    assert asked[1:] == [2, 2 * switches.MORE_CELLS]


def test_a_point_that_nearly_sticks_has_shorter_steps_until_it_is_stable(known, monkeypatch):
    steps = []
    press = switches.press_pad

    def counted(point, contact, cells, first_seed, *, step_nm=None, **options):
        steps.append(step_nm)
        return press(point, contact, cells, first_seed, **options)

    monkeypatch.setattr(switches, "press_pad", counted)
    point = central_point(TABLE, CONTACT, PLATE)
    (usual,) = solve_points([(1, point)], CONTACT, 2)
    assert not usual.nearly_sticks
    assert steps == [None]
    monkeypatch.setattr(switches, "NEARLY_STICKS", 1.0)
    (stable,) = solve_points([(1, point)], CONTACT, 2)
    half_nm = 0.5 * usual_step_nm(point.values["rms"])
    assert steps[1:] == [None, half_nm]  # the same pad: the first halving moves nothing
    assert stable.states.release_V == usual.states.release_V
    monkeypatch.setattr(Solved, "moves_little", lambda *_: False)
    list(solve_points([(1, point)], CONTACT, 2))
    assert steps[3:] == [None, half_nm, 0.5 * half_nm]


def test_a_point_that_cannot_be_pressed_leaves_its_reason(monkeypatch):
    def refused(*_, **__):
        raise InputError("4 cells closed by 90 nm carry 1 of the 5 MPa")

    monkeypatch.setattr(switches, "press_pad", refused)
    (solved,) = solve_points([(1, central_point(TABLE, CONTACT, PLATE))], CONTACT, 4)
    assert solved.pad is None
    assert not solved.states
    assert "carry 1 of the 5 MPa" in solved.refused
    model = PadModel(solved, plan_points(TABLE, CONTACT, PLATE, 1), (solved,))
    content = switch_on_pad(model, 1e6)
    assert content["central"] is None
    assert content["gate"]["reasons"] == [solved.refused]
    assert content["answer_status"] == f"device: 1 of 1 switches cannot be solved: {solved.refused}"


def test_the_answer_keeps_its_causes_apart(known):
    """A plate on known pads: inputs make the spread, the cells hardly any of it."""
    said = answer(model_of(PLATE, 96, cells=32))
    shares = said.causes
    assert shares["cells"] < 0.01
    assert shares["common"] > 5.0 * shares["each"] > 0.0
    assert shares["common"] + shares["each"] == pytest.approx(1.0, abs=0.15)
    assert said.explained > 0.8
    assert said.sensitivity[0].share_of_variance > 0.3
    assert said.points == 96
    assert said.cells == 2 * 96


def test_two_points_have_an_answer_that_explains_nothing(known):
    said = answer(model_of(PLATE, 2))
    assert said.points == 2
    assert said.explained == 0.0
    assert said.stuck["low"] < 0.2
    assert said.stuck["high"] > 0.5


def test_devices_that_the_hold_never_closes_are_counted_and_left_out(known):
    """Their share is that of devices whose pull-in on their own pads exceeds the hold."""
    free = model_of(PLATE.model_copy(update={"hold_voltage_V": None}), 32)
    pull_in_V = free.states("pull_in_V")
    hold_V = float(np.quantile(pull_in_V, 0.6))
    said = answer(model_of(PLATE.model_copy(update={"hold_voltage_V": hold_V}), 32))
    never = int((pull_in_V > 1.001 * hold_V).sum())
    assert never > 8
    assert said.never_close["value"] == never / 32
    assert said.points == 32 - never
    assert said.refused == ()
    assert said.pull_in_V["quantiles"]["0.95"] <= 1.001 * hold_V


def test_devices_of_which_hardly_one_closes_have_no_answer(known):
    with pytest.raises(InputError, match=r"32 of 32 switches never close: .*largest voltage"):
        answer(model_of(PLATE.model_copy(update={"hold_voltage_V": 20.0}), 32))


@pytest.mark.parametrize(("noise", "expected"), [(0.0, 1.0), (0.5, 0.5), (100.0, 0.0)])
def test_a_known_number_takes_off_what_it_explains(noise, expected):
    """Of the variance of x + noise, with x of variance 1: 1 - noise / hypot(1, noise)."""
    rng = np.random.default_rng(0)
    pull_in = rng.normal(size=2000)
    release = pull_in + noise * rng.normal(size=2000)
    exact = 1.0 - noise / np.hypot(1.0, noise)
    assert exact == pytest.approx(expected, abs=0.06)
    assert shrinks_by(pull_in, release) == pytest.approx(exact, abs=0.02)
    assert shrinks_by(np.full(20, 3.0), release[:20]) == 0.0


def test_a_pad_that_one_cell_in_a_hundred_carries_is_undecided(monkeypatch):
    """The half of the cells without it has no pressure, so that it cannot carry the switch."""
    law = known_pad(central_point(TABLE, CONTACT, PLATE)).curves
    pair = pad_of_two(law, 0.0)
    share = np.where(np.arange(100) == 37, 100.0, 0.0)
    pad = Pad(
        pair.grid,
        np.full(100, 0.01),
        np.ones(100),
        np.full(100, 30.0),
        share[:, None, None] * pair.closing[0],
        share[:, None, None, None] * pair.opening[0],
        np.ones(100, bool),
        law.flats,
    )
    monkeypatch.setattr(switches, "press_pad", lambda *_, **__: pad)
    solved = solve_point(central_point(TABLE, CONTACT, PLATE), CONTACT, 100, 0)
    assert solved.states.release_V == pytest.approx(
        switch_of(PLATE).states(law).release_V, rel=1e-3
    )
    assert solved.undecided


def test_quantiles_err_as_their_stated_error_says(known):
    """Fifty answers of 24 points each, beside 200 points; a Latin hypercube errs by less."""
    release = model_of(PLATE, 200).states("release_V")
    rng = np.random.default_rng(0)
    model = model_of(PLATE, 24)
    stated = answer(model).quantile_error_V["0.5"]
    medians = [np.median(rng.choice(release, 24)) for _ in range(50)]
    assert stated == pytest.approx(np.std(medians), rel=0.6)


def test_the_gate_fails_where_halves_of_the_cells_disagree_on_sticking(known):
    """Pads that pull with 0.1 and 1.9 times their pressures: one half sticks."""
    central = model_of(PLATE, 1).central
    assert central.pad is not None
    assert switch_on_pad(PadModel(central, plan_points(TABLE, CONTACT, PLATE, 0), ()), 1e6)["gate"][
        "passed"
    ]
    apart = replace(central, halves_V=(0.0, 7.0))
    gate = switch_on_pad(PadModel(apart, plan_points(TABLE, CONTACT, PLATE, 0), ()), 1e6)["gate"]
    assert not gate["passed"]
    assert "do not decide whether the switch sticks" in gate["reasons"][0]


def test_pads_are_computed_to_more_than_the_plate_can_press():
    s = np.array([10.0, 20.0])
    plate, beam = switch_of(PLATE).least_GPa(s), switch_of(published_beam()).least_GPa(s)
    assert (beam > plate).all()
    assert plate[0] > plate[1]
    assert published_beam(tilt_nm=50.0).level == published_beam()


@pytest.mark.parametrize("settings", [PLATE, published_beam()])
def test_a_pad_that_is_pressed_harder_than_it_was_computed_is_continued(settings):
    # 2.5 times that of the voltage alone, with less than which a plate presses
    local = switch_of(settings).least_GPa(SEPARATION)
    enough, less = (MIDDLE.pressed(share * local, SEPARATION) for share in (1.5, 0.3))
    computed, continued = switch_of(settings).states(enough), switch_of(settings).states(less)
    assert (computed.deepened, continued.deepened) == (False, True)
    # an opening from deeper is stiffer than from the deepest computed depth, and the tail of
    # closing is Gaussian
    assert continued.release_V == pytest.approx(computed.release_V, rel=0.01)
    assert continued.capacitance_fF == pytest.approx(computed.capacitance_fF, rel=0.01)


def test_a_pad_that_was_closed_far_too_little_stays_refused():
    smooth = replace(MIDDLE, beta=0.0, hamaker=1e-9)
    with pytest.raises(NotComputed, match="where its curves end"):
        switch_of(published_beam()).states(
            smooth.pressed(np.full(SEPARATION.size, 0.001), SEPARATION)
        )


@pytest.mark.parametrize(
    "change", [{}, {"bow_nm": 500.0}, {"residual_stress_MPa": 50.0}, {"hold_voltage_V": 120.0}]
)
def test_pilots_know_what_the_beam_will_press_with(change):
    """From a closing curve that ends too early, within the 15 % by which pilot cells are off."""
    settings = published_beam().model_copy(update=change)
    local = switch_of(settings).least_GPa(SEPARATION)
    short, long = (MIDDLE.pressed(share * local, SEPARATION) for share in (0.6, 3.0))
    switch = switch_of(settings)
    pressed = switch.pressed_GPa(closing_alone(short.separation_nm, short.closing.sum(axis=0)))
    assert pressed == pytest.approx(switch.pressed_GPa(long), rel=0.15)
    electrostatic = float(local[np.searchsorted(SEPARATION, short.separation_nm[0])]) / EDGE
    assert pressed > 1.3 * electrostatic


def test_a_pad_closed_nearly_to_its_mean_plane_asks_for_nothing_deeper():
    """Its repulsion cannot double before the mean planes meet, so no plan would ever carry the
    switch.
    """
    separation = np.linspace(0.5, 3.0, 20)
    pad = closing_alone(separation, 1e-6 * np.exp(-(separation - 3.0)))
    assert switch_of(published_beam()).pressed_GPa(pad) == 0.0


@pytest.mark.parametrize("settings", [PLATE, published_beam()])
def test_a_hold_voltage_that_never_closes_the_switch_is_refused_in_one_line(settings):
    law = MIDDLE.pressed(2.0 * switch_of(settings).least_GPa(SEPARATION), SEPARATION)
    pull_in = switch_of(settings).states(law).pull_in_V
    held = settings.model_copy(update={"hold_voltage_V": 1.01 * pull_in})
    assert switch_of(held).states(law).release_V >= 0.0
    for share in (0.8, 0.99):
        with pytest.raises(
            InputError, match=f"never closes this switch, which pulls in at {pull_in:.4g} V"
        ) as caught:
            switch_of(settings.model_copy(update={"hold_voltage_V": share * pull_in})).states(law)
        assert "\n" not in str(caught.value)


def test_refused_points_widen_the_probability_of_sticking():
    closed, opened = _probability(4, 10, 0), _probability(4, 8, 2)
    assert opened["value"] == 0.5
    assert opened["low"] == closed["low"]
    assert opened["high"] > closed["high"]


def test_the_matrix_of_a_beam_that_stretches_is_solved_where_the_beam_alone_is_singular():
    rng, nodes, stretching = np.random.default_rng(0), 20, 0.3
    for singular in (False, True):
        full, blocks, coupling = (
            np.zeros((2 * nodes, 2 * nodes)),
            rng.normal(size=(nodes, 2, 2)),
            np.zeros((nodes, 2, 2)),
        )
        blocks += blocks.transpose(0, 2, 1)
        coupling[:-1] = rng.normal(size=(nodes - 1, 2, 2))
        for k in range(nodes):
            full[2 * k : 2 * k + 2, 2 * k : 2 * k + 2] = blocks[k]
        for k in range(nodes - 1):
            full[2 * k : 2 * k + 2, 2 * k + 2 : 2 * k + 4] = coupling[k]
            full[2 * k + 2 : 2 * k + 4, 2 * k : 2 * k + 2] = coupling[k].T
        if singular:  # by the last entry, on which the determinant depends linearly
            full[-1, -1] -= 1.0 / np.linalg.inv(full)[-1, -1]
            blocks[-1, 1, 1] = full[-1, -1]
            assert np.linalg.cond(full) > 1e12
        right = rng.normal(size=(nodes, 3, 2))
        column = right[:, 2].ravel()
        wanted = [
            np.linalg.solve(full + stretching * np.outer(column, column), right[:, k].ravel())
            for k in (0, 1)
        ]
        solve_beam_matrix(blocks, coupling, right, stretching)
        np.testing.assert_allclose([right[:, 0].ravel(), right[:, 1].ravel()], wanted, rtol=1e-7)


@pytest.mark.parametrize("settings", [PLATE, published_beam()])
def test_release_by_key_is_that_of_the_changed_device_and_ends_with_a_reason(settings):
    law = MIDDLE.pressed(2.0 * switch_of(settings).least_GPa(SEPARATION), SEPARATION)
    rows = release_by_key(settings, law)
    keys = list(dict.fromkeys(row["key"] for row in rows))
    assert len(keys) == (6 if settings.kind == "beam" else 5)
    for key in keys:
        of_key = [row for row in rows if row["key"] == key]
        assert [row["value"] for row in of_key] == sorted(row["value"] for row in of_key)
        assert sum(row["own"] for row in of_key) == 1
        assert not any(row["reason"] for row in of_key[1:-1]), "nothing is solved beyond an end"
        for row in (row for row in (of_key[0], of_key[-1]) if not row["reason"]):
            state = switch_of(settings.model_copy(update={key: row["value"]})).states(law)
            assert (row["pull_in_V"], row["release_V"]) == (state.pull_in_V, state.release_V)
    (low,) = [row for row in rows if row["key"] == "hold_voltage_V" and row["reason"]]
    assert "never closes" in low["reason"]
    assert low["release_V"] is None
    stiffer = [
        row["release_V"]
        for row in rows
        if row["key"] == ("gap_um" if settings.kind == "beam" else "spring_N_per_m")
    ]
    assert stiffer == sorted(stiffer)


def test_release_by_key_has_no_row_where_the_device_has_no_answer():
    smooth = replace(MIDDLE, beta=0.0, hamaker=1e-9)
    assert (
        release_by_key(
            published_beam(), smooth.pressed(np.full(SEPARATION.size, 0.001), SEPARATION)
        )
        == []
    )


@pytest.mark.parametrize(
    ("release_V", "refused", "stuck", "median_V"),
    [
        ([0.0, 2.0, 3.0, 4.0, 5.0], 2, (1 / 7, 3 / 7), (2.0, 4.0)),
        ([0.0, 0.0, 0.0, 4.0], 1, (3 / 5, 4 / 5), (0.0, 0.0)),
        ([0.0, 2.0, 3.0], 3, (1 / 6, 4 / 6), (0.0, np.inf)),
    ],
)
def test_of_too_few_answers_it_says_what_is_so_whatever_the_others_do(
    release_V, refused, stuck, median_V
):
    """All ways in which the others may come out lie within."""
    model = SimpleNamespace(states=lambda name: np.array(release_V), refused=["why"] * refused)
    known = answered_in_part(model)
    assert known.stuck == stuck
    assert known.median_V == median_V
    nobody = SimpleNamespace(states=lambda name: np.array([]), refused=["why"])
    assert answered_in_part(nobody) is None
