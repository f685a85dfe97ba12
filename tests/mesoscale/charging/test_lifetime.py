"""The life of a held switch: rates beside exact solutions and Radau's method, gaps beside counting,
its voltages beside switches solved with the same charge.
"""

import numpy as np
import pytest
from scipy.constants import elementary_charge
from scipy.integrate import solve_ivp

from mesoscale.charging.gaps import EDGES_NM, GAPS_NM, RISES_NM, HeldGaps, standing_for
from mesoscale.charging.lifetime import (
    TELLING,
    YEAR_S,
    Lives,
    hold_rows,
    life_rows,
    summary,
    times_s,
    volts_a_decade,
)
from mesoscale.charging.rates import (
    LOST,
    Rates,
    contactless_V,
    guesses,
    held_s,
    lost_share,
    shifts_V,
)
from mesoscale.settings import DeviceSettings, LifetimeSettings
from mesoscale.studies.answer_stability import made_up_pad, published_beam
from mesoscale.studies.lifetime_stability import hard_cases, made_up_gaps, made_up_life
from mesoscale.switch import switch_of
from mesoscale.theory import charging
from mesoscale.units import NM, VACUUM_PERMITTIVITY

DEVICE = DeviceSettings()
SETTINGS = LifetimeSettings(years=10.0)
BARRIER_EV = 4.33
ALL = Rates(1e-9, BARRIER_EV, 1e18)
TEN_YEARS_S = 3.15e8
TEN = np.array([10.0])
CASES = list(hard_cases())


def elementary(field):
    exponent = charging.SECOND_EMISSION * BARRIER_EV**1.5 / field
    return charging.FIRST_EMISSION * field**2 / BARRIER_EV * np.exp(-exponent)


@pytest.mark.parametrize(
    ("voltage", "gap_nm", "seconds"),
    [(63.0, 16.0, 1e3), (63.0, 16.0, 1e6), (63.0, 16.0, TEN_YEARS_S), (45.0, 20.0, TEN_YEARS_S)],
)
def test_the_quadrature_is_the_exact_solution_of_the_elementary_law(voltage, gap_nm, seconds):
    vacuum_m = (gap_nm + DEVICE.dielectric_gap_nm) * NM
    lowering = DEVICE.dielectric_nm / (
        VACUUM_PERMITTIVITY * (DEVICE.permittivity * gap_nm + DEVICE.dielectric_nm)
    )
    shares = lost_share(
        elementary, np.array([voltage / vacuum_m]), np.array([lowering]), np.array([seconds])
    )
    exact = charging.emission_shift(
        voltage, gap_nm, seconds, DEVICE.dielectric_nm, DEVICE.permittivity, BARRIER_EV
    )
    assert voltage * shares[0, 0] == pytest.approx(exact, rel=3e-5)


@pytest.mark.parametrize("gap_nm", [0.0, 8.0, 16.0])
def test_both_rates_are_those_of_radaus_method(gap_nm):
    times = np.array([1e-2, 1.0, 1e4])
    found = shifts_V(60.0, np.array([gap_nm]), times, DEVICE, SETTINGS, ALL)[0]
    kelvin = DEVICE.temperature_C + 273.15

    def slope(_, shift):
        left = 60.0 - shift
        if gap_nm:
            field = left / ((gap_nm + DEVICE.dielectric_gap_nm) * NM)
            current = charging.emission_current(field, BARRIER_EV)
        else:
            field = left / (DEVICE.dielectric_nm * NM)
            current = ALL.injection_A_m2 * charging.frenkel_ratio(field, 1e8, 4.0, kelvin)
        return charging.charge_shift(current, DEVICE.dielectric_nm, DEVICE.permittivity)

    known = solve_ivp(slope, (0.0, times[-1]), [0.0], "Radau", times, rtol=1e-9, atol=1e-12).y[0]
    assert found == pytest.approx(known, rel=1e-4)


def test_ten_decades_and_more_grow_without_a_step_that_fails():
    times = np.concatenate([[0.0], np.geomspace(1e-15, 1e15, 121)])
    shifts = shifts_V(90.0, GAPS_NM, times, DEVICE, SETTINGS, ALL)
    assert np.isfinite(shifts).all()
    assert (np.diff(shifts, axis=1) >= 0.0).all()
    assert (shifts[:, 0] == 0.0).all()
    # at first as the current of the uncharged place says
    field = 90.0 / ((20.25 + DEVICE.dielectric_gap_nm) * NM)
    place = int(np.flatnonzero(GAPS_NM == 20.25)[0])
    first = charging.charge_shift(
        charging.emission_current(field, BARRIER_EV), DEVICE.dielectric_nm, DEVICE.permittivity
    )
    assert shifts[place, 17] / times[17] == pytest.approx(first, rel=1e-3)


def test_half_of_the_shares_give_the_same_life():
    times = np.geomspace(1.0, TEN_YEARS_S, 9)
    fine = shifts_V(70.0, GAPS_NM, times, DEVICE, SETTINGS, ALL)
    coarse = shifts_V(70.0, GAPS_NM, times, DEVICE, SETTINGS, ALL, LOST[1::2])
    assert coarse == pytest.approx(fine, rel=1e-4, abs=1e-9)


def test_a_surface_holds_no_more_than_its_traps():
    few = Rates(1.0, 2.0, 1e11)
    shifts = shifts_V(80.0, GAPS_NM, np.array([1e9]), DEVICE, SETTINGS, few)
    most = charging.charge_shift(
        1e15 * elementary_charge, DEVICE.dielectric_nm, DEVICE.permittivity
    )
    assert shifts.max() == pytest.approx(most)


def test_a_positive_electrode_emits_nothing():
    positive = LifetimeSettings(years=10.0, electrode="positive")
    shifts = shifts_V(80.0, GAPS_NM, np.array([1e9]), DEVICE, positive, ALL)
    assert shifts[0] > 0.0
    assert (shifts[1:] == 0.0).all()


def test_alternating_holds_and_rests_count_for_less_time():
    half = LifetimeSettings(years=10.0, duty=0.5, other_polarity=0.25)
    assert held_s(np.array([100.0]), half) == pytest.approx([25.0])
    seen = LifetimeSettings(years=10.0, contactless_V=0.4)
    assert contactless_V(np.array([0.0, 999.0]), seen) == pytest.approx([0.0, 1.2])
    with pytest.raises(ValueError, match="a time of -1 s"):
        shifts_V(60.0, GAPS_NM, np.array([-1.0]), DEVICE, SETTINGS, ALL)


def test_gaps_are_counted_from_the_surfaces():
    gaps = made_up_gaps(DEVICE)
    each = 20.0 + gaps.heights_nm
    assert gaps.shares.sum() == pytest.approx(1.0)
    assert gaps.touching == pytest.approx((each <= 0.0).mean())
    inside = each[(each > 0.0) & (each < 59.0)]
    mean = float(gaps.shares[1:-1] @ GAPS_NM[1:]) * each.size
    assert mean == pytest.approx(inside.sum(), rel=2e-3)
    exact = (each.clip(0.0) * DEVICE.permittivity + DEVICE.dielectric_nm) ** -1
    factor = 1.0 / (DEVICE.dielectric_nm * exact.mean())
    assert gaps.contact_factor == pytest.approx(factor, rel=2e-3)


def test_errors_fall_with_finer_classes_of_gaps():
    gaps = made_up_gaps(DEVICE)
    exact, *coarse = (
        (gaps.shares_at(classes)[:-1] @ shifts_V(70.0, classes, TEN, DEVICE, SETTINGS, ALL)).item()
        for classes in (
            np.concatenate([[0.0], np.arange(0.5 * step, 60.0, step)])
            for step in (0.0625, 4.0, 2.0, 1.0, 0.5)
        )
    )
    errors = np.abs(np.array(coarse) - exact)
    assert (errors[1:] < 0.5 * errors[:-1]).all()
    assert errors[-1] < 1e-3 * exact


def test_a_share_of_the_pull_is_at_the_separation_in_its_middle():
    separation = np.array([30.0, 10.0, 12.0, 500.0])
    pulls = np.array([2.0, 50.0, 45.0, 3.0])
    shares = np.array([0.5, 0.45, 0.025, 0.025])
    assert standing_for(separation, pulls, shares) == pytest.approx([10.0, 12.0, 30.0, 500.0])
    assert standing_for(separation, pulls, np.ones(1)) == pytest.approx([10.0])


def test_one_class_of_gap_is_charged_evenly():
    flat = made_up_gaps(DEVICE, 10.0, 0.0)
    assert np.abs(flat.uneven).max() < 1e-12
    shifts = shifts_V(70.0, GAPS_NM, np.array([1e3]), DEVICE, SETTINGS, ALL)
    assert flat.mean_V(shifts)[0] == pytest.approx(np.interp(10.0, GAPS_NM, shifts[:, 0]), rel=1e-9)


def test_uneven_charge_of_one_wave_is_felt_as_the_wave():
    """Two flats, half of it a little nearer: stripes of charge, whose waves are summed by hand."""
    side_nm, pixels = 400.0, 64
    heights = np.zeros((pixels, pixels))
    # places at 8 nm belong to the third class, a little above to the fourth
    heights[pixels // 2 :] = 1e-6
    split = HeldGaps(
        DEVICE,
        np.array([8.0]),
        np.ones(1),
        np.stack([heights]),
        np.ones(1),
        side_nm,
    )
    squares = split.uneven[:, 2, 2]
    pattern = np.zeros(pixels)
    pattern[: pixels // 2] = 1.0 / charging.charge_shift(
        1.0, DEVICE.dielectric_nm, DEVICE.permittivity
    )
    amplitudes = np.asarray(2.0 * np.abs(np.fft.rfft(pattern))[1:] / pixels, float)
    wave_numbers = np.linspace(1.0, amplitudes.size, amplitudes.size) * 2.0 * np.pi / side_nm
    amplitudes[-1] /= 2.0
    for rise, square in zip(RISES_NM, squares, strict=True):
        felt = charging.felt_charge_wave(
            amplitudes, wave_numbers, 8.0 + rise, DEVICE.dielectric_nm, DEVICE.permittivity
        )
        assert square == pytest.approx(np.sum(felt**2), rel=2e-2)


def test_the_classes_of_a_life_sum_to_its_mean():
    gaps = made_up_gaps(DEVICE)
    shifts = shifts_V(70.0, GAPS_NM, np.array([1e3]), DEVICE, SETTINGS, ALL)
    number = np.searchsorted(EDGES_NM, GAPS_NM)
    weights = np.array([gaps.shares[:-1][number == k].sum() for k in range(EDGES_NM.size)])
    within = number < EDGES_NM.size
    of_classes = float(weights @ gaps.class_V(shifts)[:, 0])
    assert of_classes == pytest.approx(
        float(gaps.shares[:-1][within] @ shifts[within, 0]), rel=1e-6
    )


def test_before_any_hold_the_answer_is_todays():
    life, settings = made_up_life({}, {"hold_voltage_V": 85.0})
    today = switch_of(published_beam(hold_voltage_V=85.0)).states(made_up_pad(2.0))
    shift, squares = life.charged(life.hold_V, np.zeros(1), settings, guesses(settings)["most"])
    pull_in, release = life.voltages(shift, squares)
    assert (pull_in[0], release[0]) == (today.pull_in_V, today.release_V)


@pytest.mark.parametrize(("guess", "seconds"), [("most", 1.0), ("most", 1e6)])
def test_between_strengths_the_switch_is_the_one_that_is_solved(guess, seconds):
    life, settings = made_up_life({}, {"hold_voltage_V": 85.0})
    rates = guesses(settings)[guess]
    times = np.array([seconds])
    shift, squares = life.charged(85.0, times, settings, rates)
    _, release = life.voltages(shift, squares)
    classes = life.gaps.class_V(shifts_V(85.0, GAPS_NM, times, DEVICE, settings, rates))[:, 0]
    table = np.einsum("c,rcd,d->r", classes, life.gaps.uneven, classes)
    assert table[TELLING] == pytest.approx(squares[0])
    felt = zip(life.gaps.middle_nm + RISES_NM, table, strict=True)
    charged = published_beam(hold_voltage_V=85.0, uneven={"felt": (*felt, (1e5, 0.0))})
    solved = switch_of(charged).states(made_up_pad(2.0))
    assert solved.release_V < life.release_V[0]
    assert release[0] == pytest.approx(solved.release_V + shift[0], abs=0.05)


def test_a_life_of_devices_has_its_rows():
    lives = [
        made_up_life({}, {"hold_voltage_V": 85.0, "thickness_um": thick})
        for thick in (3.9, 4.0, 4.05)
    ]
    devices = tuple(life for life, _ in lives)
    all_lives = Lives(devices[1], devices, (), SETTINGS, guesses(SETTINGS))
    rows = list(life_rows(all_lives))
    assert len(rows) == 3 * (times_s(SETTINGS).size + 1)
    assert rows[-1]["time_s"] == pytest.approx(10.0 * YEAR_S)
    fresh = [row for row in rows if row["time_s"] == 0.0]
    assert len({row["release_q50_V"] for row in fresh}) == 1
    ends = [row for row in rows if row["time_s"] == rows[-1]["time_s"]]
    assert ends[0]["shift_V"] < ends[1]["shift_V"] < ends[2]["shift_V"]
    holds = list(hold_rows(all_lives))
    content = summary(all_lives, holds)
    assert 0.0 < content["touching"] < 1.0
    assert content["contact_factor"] > 1.0
    assert content["guesses"]["central"]["volts_a_decade"] > 0.0


def test_volts_a_decade_are_the_slope_of_the_time():
    rows = [{"hold_V": volts, "time_to_1V_s": 10.0 ** (12.0 - volts / 6.0)} for volts in range(50)]
    assert volts_a_decade(rows, 30.2) == pytest.approx(6.0)
    assert volts_a_decade(rows[:1], 0.0) is None


@pytest.mark.parametrize("case", CASES, ids=[case.name for case in CASES])
def test_an_extreme_life_is_solved_or_refused_in_one_line(case):
    passed, detail = case.judge()
    assert passed, detail


def test_there_are_enough_extreme_lives():
    assert len(CASES) >= 25
