"""The switch against the analytic limits of its model."""

from dataclasses import replace

import numpy as np
import pytest

from mesoscale.device.contact_law import pressure_GPa, scale_adhesion
from mesoscale.device.statistics import analytic_pull_in_V, analytic_release_V, probability
from mesoscale.device.switch import (
    NM,
    VACUUM_PERMITTIVITY,
    beam_stiffness_N_per_m,
    solve_switch,
    switch_from_settings,
)
from mesoscale.law.compact import Law
from mesoscale.settings import DeviceSettings

CLOSING = Law(31.8, 15.1e-5, 6.4e-4, 3.31, hamaker=0.215)  # means of the paper's Table 2
OPENING = Law(28.48, 20.6e-5, 9.16e-4, 2.669, hamaker=0.215)
LIMIT = 1e-6  # relative; asked of the analytic limits


def beam(last_share=1.0, **changes):
    return replace(switch_from_settings(DeviceSettings(bends_as="beam", **changes)), last_share=last_share)


def test_beam_stiffness_is_that_of_a_uniformly_loaded_clamped_beam():
    # centre deflection q L^4 / (384 E I) with I = b t^3 / 12, load q L
    settings = DeviceSettings(bends_as="beam")
    inertia = settings.width_um * settings.thickness_um**3 / 12 * 1e-24
    length = settings.length_um * 1e-6
    expected = 384 * settings.youngs_modulus_GPa * 1e9 * inertia / length**3
    assert beam_stiffness_N_per_m(settings) == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("dielectric_nm", [0.0, 200.0])
def test_pull_in_without_contact_is_the_ideal_plate(dielectric_nm):
    nothing = Law(10.0, 0.0, 1e-6, 1.0, hamaker=0.0)
    switch = beam(dielectric_nm=dielectric_nm)
    states = solve_switch(switch, nothing, nothing)
    gap = (switch.gap_nm + switch.dielectric_nm) * NM
    ideal = np.sqrt(8 * switch.spring_N_per_m * gap**3 / (27 * VACUUM_PERMITTIVITY * switch.area_m2))
    assert states.pull_in_V[0] == pytest.approx(ideal, rel=LIMIT)
    assert analytic_pull_in_V(switch) == pytest.approx(ideal, rel=1e-12)


@pytest.mark.parametrize("last_share", [0.01, 1.0])
def test_release_without_adhesion_is_analytic(last_share):
    switch = beam(last_share=last_share)
    states = solve_switch(switch, scale_adhesion(CLOSING, 0), scale_adhesion(OPENING, 0))
    assert states.release_V[0] == pytest.approx(analytic_release_V(switch, OPENING), rel=LIMIT)
    assert states.release_nm[0] == pytest.approx(OPENING.d_c_nm, abs=1e-6)
    assert not states.stuck[0]
    assert np.isinf(states.critical_fraction[0])


def test_release_is_a_state_of_balance_at_which_stability_ends():
    switch = beam(last_share=0.005)
    states = solve_switch(switch, CLOSING, OPENING)
    s, volts = states.release_nm[0], states.release_V[0]
    electrostatic = VACUUM_PERMITTIVITY * switch.area_m2 * volts**2 / 2 / ((s + switch.dielectric_nm) * NM) ** 2
    assert switch.net_force_N(s, OPENING, switch.last_share) == pytest.approx(electrostatic, rel=1e-9)
    around = switch.voltage_squared(s + np.array([-1e-3, 0, 1e-3]), OPENING, switch.last_share)
    assert around[1] <= around[0]
    assert around[1] <= around[2]


def test_adhesion_lowers_release_and_sticks_above_the_critical_fraction():
    critical = solve_switch(beam(last_share=0.001), CLOSING, OPENING).critical_fraction[0]
    below = solve_switch(beam(last_share=critical * (1 - 1e-6)), CLOSING, OPENING)
    above = solve_switch(beam(last_share=min(critical * (1 + 1e-6), 1)), CLOSING, OPENING)
    free = solve_switch(beam(), scale_adhesion(CLOSING, 0), scale_adhesion(OPENING, 0))
    assert 0 < below.release_V[0] < 0.01 * free.release_V[0]
    assert not below.stuck[0]
    assert above.stuck[0]
    assert above.release_V[0] == 0
    # a tenth of the adhesion allows ten times the landed area, up to the far attraction
    tenth = solve_switch(beam(), scale_adhesion(CLOSING, 0.1), scale_adhesion(OPENING, 0.1))
    assert tenth.critical_fraction[0] == pytest.approx(10 * critical, rel=1e-6)


def test_release_voltage_agrees_with_a_brute_force_sweep():
    rng = np.random.default_rng(4)
    switch = beam(last_share=0.003)
    for _ in range(20):
        law = Law(
            rng.uniform(5, 60),
            rng.uniform(0, 4e-4),
            10 ** rng.uniform(-4.5, -2.5),
            rng.uniform(1, 6),
            hamaker=rng.uniform(0.18, 0.25),
        )
        states = solve_switch(switch, law, law)
        # between the first repulsion as stiff as the barrier is high and the pull-in fold
        s = np.linspace(max(law.d_c_nm - 12 * law.rho_r_nm, -20), law.d_c_nm + 300, 1_000_000)
        curve = switch.voltage_squared(s, law, switch.last_share)
        start = np.argmax(np.where(s <= law.d_c_nm, curve, -np.inf))
        lowest = max(curve[start:].min(), 0)
        assert states.release_V[0] == pytest.approx(np.sqrt(lowest), abs=1e-4)


def test_many_samples_give_what_each_gives_alone():
    switch = beam(last_share=0.002)
    d_c = np.array([12.0, 25.0, 40.0, 55.0])
    together = solve_switch(switch, replace(CLOSING, d_c_nm=d_c), replace(OPENING, d_c_nm=d_c - 3))
    for i, contact in enumerate(d_c):
        alone = solve_switch(switch, replace(CLOSING, d_c_nm=contact), replace(OPENING, d_c_nm=contact - 3))
        assert together.release_V[i] == alone.release_V[0]
        assert np.array_equal(together.hold_nm[i], alone.hold_nm[0], equal_nan=True)


def test_held_switch_is_in_balance_at_its_hold_voltage():
    switch = beam(last_share=0.5)
    states = solve_switch(switch, CLOSING, OPENING, hold_voltage_V=40.0)
    assert switch.voltage_squared(states.hold_nm[0], CLOSING) == pytest.approx(40.0**2, rel=1e-9)
    assert states.hold_pressure_GPa[0] == pytest.approx(float(pressure_GPa(states.hold_nm[0], CLOSING)))


def test_what_comes_off_last_of_a_beam_is_what_the_parabola_of_mid_span_keeps_within_the_range():
    settings = DeviceSettings()
    x = np.linspace(-0.5, 0.5, 2_000_001)
    # a clamped beam pushed down at mid-span: 16 |x|^3 - 12 x^2 + 1 of its gap, in units of its length
    lifted = settings.gap_um * 1e3 * (12.0 * x**2 - 16.0 * np.abs(x) ** 3)
    wanted = float(np.mean(lifted < 2.0))
    # the cubic term is 2/3 of the share itself
    assert switch_from_settings(settings, 2.0).last_share == pytest.approx(wanted, rel=0.02)
    assert switch_from_settings(DeviceSettings(spring_N_per_m=170.0), 2.0).last_share == 1.0


def test_probability_interval_is_sensible_at_the_ends():
    none, every = probability(0, 100), probability(100, 100)
    assert none["low"] == 0
    assert 0 < none["high"] < 0.05
    assert every["high"] == 1
    assert 0.95 < every["low"] < 1
