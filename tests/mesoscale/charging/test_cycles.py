"""A drive in cycles, between which charge leaks: beside cycles that are stepped one by one, and
beside exact sums.
"""

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import zeta

from mesoscale.charging.cycles import cycled_V, driven_V
from mesoscale.charging.gaps import GAPS_NM
from mesoscale.charging.rates import Rates, charged_places, guesses, held_s, shifts_V
from mesoscale.errors import InputError
from mesoscale.settings import DeviceSettings, LifetimeSettings
from mesoscale.studies.lifetime_stability import made_up_life
from mesoscale.theory import charging
from mesoscale.units import NM

DEVICE = DeviceSettings()
BARRIER_EV = 4.33
HOLD_V = 70.0
PLACES_NM = np.array([0.0, 8.0, 16.0, 20.0])


def drive(**changes):
    return LifetimeSettings(**{"years": 10.0, "period_s": 1e-3, **changes})


def rates(exponent, most_e_cm2=1e18, injection_A_m2=1e-9):
    return Rates(injection_A_m2, BARRIER_EV, most_e_cm2, exponent)


def rate_V_s(gap_nm, felt_V, injection_A_m2=1e-9):
    """Growth of the shift of a place that feels a voltage of either sign."""
    size = abs(felt_V)
    if gap_nm:
        field = size / ((gap_nm + DEVICE.dielectric_gap_nm) * NM)
        current = charging.emission_current(field, BARRIER_EV)
    else:
        field = size / (DEVICE.dielectric_nm * NM)
        kelvin = DEVICE.temperature_C + 273.15
        current = injection_A_m2 * charging.frenkel_ratio(field, 1e8, 4.0, kelvin)
    grown = charging.charge_shift(current, DEVICE.dielectric_nm, DEVICE.permittivity)
    return float(np.sign(felt_V) * grown)


def held(gap_nm, voltage, shift, seconds, steps=8):
    """A hold by the method of Runge and Kutta."""
    step = seconds / steps
    for _ in range(steps):
        first = rate_V_s(gap_nm, voltage - shift)
        second = rate_V_s(gap_nm, voltage - shift - 0.5 * step * first)
        third = rate_V_s(gap_nm, voltage - shift - 0.5 * step * second)
        fourth = rate_V_s(gap_nm, voltage - shift - step * third)
        shift += step / 6.0 * (first + 2.0 * second + 2.0 * third + fourth)
    return shift


def stepped(gap_nm, settings, exponent, cycles):
    """Shift at the end of the hold of the last of so many cycles, each of which is followed."""
    hold_s = settings.duty * settings.period_s
    other_s = settings.other_polarity * hold_s
    rest_s = settings.period_s - hold_s
    gains = np.zeros(cycles)
    left = (1.0 + np.arange(1, cycles + 1) * rest_s / settings.recovery_s) ** -exponent
    shift = 0.0
    for number in range(cycles):
        before = float(gains[:number] @ left[:number][::-1])
        shift = held(gap_nm, HOLD_V, before, hold_s - other_s)
        after = held(gap_nm, -HOLD_V, shift, other_s) if other_s else shift
        gains[number] = after - before
    return shift


@pytest.mark.parametrize("gap_nm", [0.0, 16.0])
@pytest.mark.parametrize(
    ("changes", "exponent"),
    [
        ({"duty": 0.5, "period_s": 1e-3}, 0.3),
        ({"duty": 0.1, "period_s": 0.05}, 0.1),
        ({"duty": 0.02, "period_s": 1.0}, 0.5),
        ({"duty": 0.02, "period_s": 0.1, "recovery_s": 1e-4}, 1.3),
        ({"duty": 0.5, "period_s": 1e-3, "other_polarity": 0.2}, 0.3),
        ({"duty": 1.0, "period_s": 1e-3, "other_polarity": 0.4}, 0.3),
    ],
)
def test_a_thousand_cycles_are_those_stepped_one_by_one(gap_nm, changes, exponent):
    settings = drive(**changes)
    assert settings.period_s is not None
    times = np.array([1000 * settings.period_s])
    found = cycled_V(HOLD_V, np.array([gap_nm]), times, DEVICE, settings, rates(exponent))
    known = stepped(gap_nm, settings, exponent, 1000)
    # between known cycles, 20 a decade, a gain that falls as 1 / N is off by 0.2 % at most
    assert found[0, 0] == pytest.approx(known, rel=2e-3)


@pytest.mark.parametrize(("exponent", "decades"), [(0.3, 3), (0.3, 9), (1.5, 9), (0.05, 12)])
def test_a_current_that_its_charge_does_not_lower_adds_up_exactly(exponent, decades):
    """Cycles of one gain each: what is left of them is a sum of Hurwitz."""
    settings = drive(duty=0.5, period_s=2.0, recovery_s=3.0)
    weak = rates(exponent, injection_A_m2=1e-30)
    times = np.array([2.0, 2.0 * 10**decades])
    first, last = cycled_V(HOLD_V, np.zeros(1), times, DEVICE, settings, weak)[0]
    cycles = 10**decades
    if exponent > 1.0:
        begin, end = zeta(exponent, np.array([3.0, 3.0 + cycles]))
        exact = 3.0**exponent * (begin - end)
    else:
        early = np.sum((1.0 + np.arange(1000) / 3.0) ** -exponent)
        edges = 1.0 + (np.array([1000.0, cycles]) - 0.5) / 3.0
        powers = edges ** (1.0 - exponent)
        exact = early + 3.0 * (powers[1] - powers[0]) / (1.0 - exponent)
    assert last / first == pytest.approx(exact, rel=1e-5)


def test_without_rest_or_leak_cycles_are_one_hold():
    times = np.concatenate([[1e-6, 1e-4], 1e-3 * np.rint(np.geomspace(1.0, 3e11, 15))])
    for settings, exponent in ((drive(duty=1.0), 0.3), (drive(duty=0.25), 0.0)):
        found = cycled_V(HOLD_V, PLACES_NM, times, DEVICE, settings, rates(exponent))
        counted = held_s(times, settings)
        counted[times < 1e-3] = np.minimum(times[times < 1e-3], settings.duty * 1e-3)
        known = shifts_V(HOLD_V, PLACES_NM, counted, DEVICE, settings, rates(exponent))
        assert found == pytest.approx(known, rel=1e-3)


def test_errors_fall_with_the_square_of_the_known_cycles():
    settings = drive(duty=0.25)
    times = np.array([1e7])
    fine, *coarse = (
        cycled_V(HOLD_V, PLACES_NM, times, DEVICE, settings, rates(0.2), count)[:, 0]
        for count in (160, 5, 10, 20)
    )
    errors = [np.abs(shift - fine).max() for shift in coarse]
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.3)
    assert errors[1] / errors[2] == pytest.approx(4.0, rel=0.3)


def test_alternating_fast_settles_where_both_holds_are_as_strong():
    """Emission by the longer hold from V - q is that of the shorter one from V + q."""
    settings = drive(duty=1.0, period_s=1e-6, other_polarity=0.1)
    found = cycled_V(HOLD_V, PLACES_NM, np.array([1e6]), DEVICE, settings, rates(0.0))[:, 0]
    for gap_nm, shift in zip(PLACES_NM[[0, 2, 3]], found[[0, 2, 3]], strict=True):

        def balance(shift, gap_nm=gap_nm):
            longer = 0.9 * rate_V_s(gap_nm, HOLD_V - shift)
            return longer - 0.1 * rate_V_s(gap_nm, HOLD_V + shift)

        assert shift == pytest.approx(brentq(balance, 0.0, 0.9 * HOLD_V), rel=5e-3)


def test_the_sign_is_that_of_the_longer_hold():
    settings = drive(other_polarity=0.2, duty=0.5)
    swapped = drive(other_polarity=0.8, duty=0.5)
    times = np.array([1.0, 1e4])
    found = driven_V(HOLD_V, PLACES_NM, times, DEVICE, settings, rates(0.2))
    assert (found > 0.0).all()
    other = driven_V(HOLD_V, PLACES_NM, times, DEVICE, swapped, rates(0.2))
    assert other == pytest.approx(-found)


def test_rests_and_leaks_lower_the_shift_over_all_decades():
    times = np.geomspace(1e-4, 3e10, 60)
    before = shifts_V(HOLD_V, GAPS_NM, times, DEVICE, drive(), rates(0.0))
    for duty, exponent in ((0.9, 0.05), (0.5, 0.05), (0.5, 0.3), (0.01, 0.3), (0.01, 4.0)):
        shifts = cycled_V(HOLD_V, GAPS_NM, times, DEVICE, drive(duty=duty), rates(exponent))
        assert np.isfinite(shifts).all()
        assert (shifts >= 0.0).all()
        assert (shifts <= 1.002 * before).all()
        assert (np.diff(shifts, axis=1) >= -1e-4 * HOLD_V).all()
        before = shifts


def test_a_drive_without_period_is_as_before():
    settings = LifetimeSettings(years=10.0, duty=0.5, other_polarity=0.75)
    times = np.geomspace(1.0, 1e6, 4)
    found = driven_V(HOLD_V, PLACES_NM, times, DEVICE, settings, rates(0.3))
    known = -shifts_V(HOLD_V, PLACES_NM, 0.25 * times, DEVICE, settings, rates(0.0))
    assert (found == known).all()


def test_full_traps_and_no_drive_are_no_cycles():
    few = rates(0.1, most_e_cm2=1e11)
    times = np.array([1.0, 1e6])
    shifts = cycled_V(90.0, GAPS_NM, times, DEVICE, drive(duty=0.5), few)
    most = charging.charge_shift(1.602176634e-4, DEVICE.dielectric_nm, DEVICE.permittivity)
    assert shifts.max() == pytest.approx(most)
    assert (cycled_V(0.0, GAPS_NM, times, DEVICE, drive(), few) == 0.0).all()
    positive = drive(electrode="positive")
    assert (cycled_V(90.0, GAPS_NM, times, DEVICE, positive, few)[1:] == 0.0).all()
    assert len(list(charged_places(90.0, GAPS_NM, DEVICE, positive, few))) == 1


def test_guesses_of_least_charge_leak_most():
    by_guess = guesses(drive(recovery_exponent=(0.1, 0.4)))
    assert [of.recovery_exponent for of in by_guess.values()] == pytest.approx([0.4, 0.25, 0.1])


def test_a_life_in_cycles_is_shorter_charged():
    """Ten years of a tenth of the time, held at once and in cycles that leak."""
    at_once, settings = made_up_life({"duty": 0.1}, {"hold_voltage_V": 85.0})
    times = np.array([0.0, 1e4, 3e8])
    of_hold, _ = at_once.charged(85.0, times, settings, rates(0.3))
    of_cycles, squares = at_once.charged(85.0, times, drive(duty=0.1), rates(0.3))
    assert of_hold[0] == of_cycles[0] == squares[0] == 0.0
    assert (of_cycles[1:] > 0.0).all()
    assert (of_cycles[1:] < of_hold[1:]).all()


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"period_s": 0.0}, "period_s"),
        ({"period_s": -1.0}, "period_s"),
        ({"recovery_exponent": (0.3, 0.1)}, "least value first"),
        ({"recovery_exponent": (-0.1, 0.1)}, "recovery_exponent"),
        ({"recovery_s": 0.0}, "recovery_s"),
        ({"other_polarity": 0.5}, "sum to nothing"),
    ],
)
def test_a_drive_that_is_none_is_refused_in_one_line(changes, words):
    with pytest.raises(InputError, match=words) as refused:
        drive(**changes)
    assert "\n" not in str(refused.value)


def test_a_time_below_zero_is_refused():
    with pytest.raises(ValueError, match="a time of -2 s"):
        cycled_V(HOLD_V, PLACES_NM, np.array([-2.0]), DEVICE, drive(), rates(0.1))
