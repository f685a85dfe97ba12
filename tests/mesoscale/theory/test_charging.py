"""Charge in a dielectric: exact numbers, two published ones, and independent solutions."""

import numpy as np
import pytest
from scipy.constants import elementary_charge
from scipy.integrate import solve_ivp

from mesoscale.theory import charging
from mesoscale.units import NM, VACUUM_PERMITTIVITY

THICK_NM, PERMITTIVITY, BARRIER_EV = 200.0, 7.9, 4.33
TEN_YEARS_S = 3.15e8
E_CM2 = elementary_charge * 1e4
"""C/m^2 of one charge a square centimetre."""


@pytest.mark.parametrize(("charges", "volts"), [(1e11, 0.458105), (1e12, 4.581045)])
def test_even_charge_shifts_the_voltage(charges, volts):
    shift = charging.charge_shift(charges * E_CM2, THICK_NM, PERMITTIVITY)
    assert shift == pytest.approx(volts, rel=2e-6)


@pytest.mark.parametrize(("gap_nm", "volts"), [(1.0, 2.0120), (20.0, 1.9109), (3600.0, 0.00047)])
def test_a_wave_of_charge_is_felt_near_and_not_far(gap_nm, volts):
    felt = charging.felt_charge_wave(1e-3, 2.0 * np.pi / 2000.0, gap_nm, THICK_NM, PERMITTIVITY)
    assert felt == pytest.approx(volts, rel=2e-2 if gap_nm > 1e3 else 1e-4)


def test_a_long_wave_is_felt_as_even_charge_of_its_rms():
    felt = charging.felt_charge_wave(1e-3, 1e-9, 20.0, THICK_NM, PERMITTIVITY)
    even = charging.charge_shift(1e-3, THICK_NM, PERMITTIVITY)
    assert felt == pytest.approx(even / np.sqrt(2.0), rel=1e-6)


def test_a_wave_of_charge_is_that_of_laplaces_equation():
    """Own finite differences of phi'' = k^2 phi across dielectric and gap, electrodes at 0 V."""
    wave_number = 2.0 * np.pi / 300.0
    gap_nm, spacing_nm = 30.0, 0.05
    below = round(THICK_NM / spacing_nm)
    above = round(gap_nm / spacing_nm)
    count = below + above - 1
    main = np.full(count, -2.0 - (wave_number * spacing_nm) ** 2)
    lower = np.ones(count - 1)
    upper = np.ones(count - 1)
    right = np.zeros(count)
    surface = below - 1
    # flux: phi'(gap) - eps phi'(dielectric) = -density / eps0, each half cell with its k^2 phi
    half = 0.5 * (wave_number * spacing_nm) ** 2
    main[surface] = -(1.0 + half) - PERMITTIVITY * (1.0 + half)
    lower[surface - 1] = PERMITTIVITY
    right[surface] = -1e-3 * spacing_nm * NM / VACUUM_PERMITTIVITY
    matrix = np.diag(main) + np.diag(lower, -1) + np.diag(upper, 1)
    potential = np.linalg.solve(matrix, right)
    field = potential[-1] / (spacing_nm * NM)
    felt = (gap_nm + THICK_NM / PERMITTIVITY) * NM * field / np.sqrt(2.0)
    formula = charging.felt_charge_wave(1e-3, wave_number, gap_nm, THICK_NM, PERMITTIVITY)
    assert formula == pytest.approx(felt, rel=1e-3)


@pytest.mark.parametrize(("gap_nm", "seconds"), [(13.0, 0.061), (16.0, 1.24), (20.0, 69.0)])
def test_charge_comes_through_a_gap_in_the_time_of_murphy_and_good(gap_nm, seconds):
    field = 63.0 / ((gap_nm + THICK_NM / PERMITTIVITY) * NM)
    took = 1.1e12 * E_CM2 / charging.emission_current(field, BARRIER_EV)
    assert took == pytest.approx(seconds, rel=1e-2)


@pytest.mark.parametrize(
    ("voltage", "gap_nm", "seconds", "volts"),
    [
        (63.0, 16.0, 1e3, 2.54702),
        (63.0, 16.0, 1e6, 10.8598),
        (63.0, 16.0, TEN_YEARS_S, 16.3608),
        (45.0, 20.0, TEN_YEARS_S, 0.38e-3),
    ],
)
def test_the_shift_grows_linearly_and_then_with_the_logarithm(voltage, gap_nm, seconds, volts):
    shift = charging.emission_shift(voltage, gap_nm, seconds, THICK_NM, PERMITTIVITY, BARRIER_EV)
    assert shift == pytest.approx(volts, rel=2e-2 if volts < 1.0 else 1e-5)


def test_the_shift_is_that_of_runge_and_kutta():
    vacuum = (16.0 + THICK_NM / PERMITTIVITY) * NM
    first = charging.FIRST_EMISSION / BARRIER_EV
    second = charging.SECOND_EMISSION * BARRIER_EV**1.5

    def grows(_, shift):
        field = (63.0 - shift) / vacuum
        current = first * field**2 * np.exp(-second / field)
        return charging.charge_shift(current, THICK_NM, PERMITTIVITY)

    solved = solve_ivp(grows, (0.0, 1e3), [0.0], method="Radau", rtol=1e-10, atol=1e-12)
    shift = charging.emission_shift(63.0, 16.0, 1e3, THICK_NM, PERMITTIVITY, BARRIER_EV)
    assert shift == pytest.approx(solved.y[0, -1], rel=1e-7)


def test_the_shift_starts_at_nothing_and_never_passes_the_voltage():
    times = np.geomspace(1e-9, 1e30, 40)
    shift = charging.emission_shift(63.0, 1.0, times, THICK_NM, PERMITTIVITY, BARRIER_EV)
    assert (np.diff(shift) > 0.0).all()
    assert shift[-1] < 63.0
    early = charging.emission_shift(63.0, 30.0, 1e-30, THICK_NM, PERMITTIVITY, BARRIER_EV)
    assert early == pytest.approx(0.0, abs=1e-9)


def test_traps_emit_as_frenkel_says():
    fields = np.array([1e8, 2e8, 3.5e8])
    lowering = charging.frenkel_lowering(fields, 4.0)
    np.testing.assert_allclose(lowering, [0.37947, 0.53665, 0.70992], atol=5e-6)
    assert charging.frenkel_ratio(3.5e8, 1e8, 4.0, 300.0) == pytest.approx(1.2457e6, rel=1e-4)
    volts = charging.frenkel_volts_per_decade(np.array([30.0, 60.0]), THICK_NM, 4.0, 300.0)
    np.testing.assert_allclose(volts, [6.9, 10.1], atol=0.05)


def test_gold_relaxes_over_the_barrier_that_was_published():
    """A film of 200 nm (IMECE2004-61385): 0.544 eV stated."""
    barrier = charging.thermal_barrier(
        np.array([295.0, 312.0, 323.0]), np.array([250.0, 67.0, 40.0])
    )
    assert barrier == pytest.approx(0.5455, abs=1e-4)
    assert barrier == pytest.approx(0.544, rel=5e-3)


def test_a_meniscus_forms_over_the_barrier_that_was_published():
    """4.2 ms at 299 K, 0.7 ms at 332 K and 40 % humidity (PRL 95, 135502): a factor of 6.0."""
    barrier_eV = 7.8e-20 / elementary_charge
    ratio = charging.thermal_ratio(barrier_eV, 299.0, 332.0)
    assert ratio == pytest.approx(6.54, abs=0.01)
    assert ratio == pytest.approx(6.0, rel=0.1)
