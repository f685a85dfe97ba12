"""Accuracy table of the life of a held switch, beside an integrator of differential equations."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from mesoscale.charging.cycles import PER_DECADE
from mesoscale.charging.gaps import GAPS_NM, PEELING, SEPARATIONS, HeldGaps
from mesoscale.charging.lifetime import YEAR_S
from mesoscale.charging.rates import LOST, guesses
from mesoscale.settings import ContactSettings, DeviceSettings, LifetimeSettings
from mesoscale.studies import lifetime_accuracy
from mesoscale.theory import charging
from mesoscale.units import NM

DEVICE = DeviceSettings()
HELD_V = (64.0, 70.0)
GAP_NM = 20.6
YEARS = 10.0


def known_shift_V(hold_V, gap_nm, settings):
    """Shift of a place at the end of the life, by Radau's method."""
    barrier_eV = guesses(settings)["central"].barrier_eV

    def slope(_, shift):
        field = (hold_V - shift) / ((gap_nm + DEVICE.dielectric_gap_nm) * NM)
        current = charging.emission_current(field, barrier_eV)
        return charging.charge_shift(current, DEVICE.dielectric_nm, DEVICE.permittivity)

    end_s = YEARS * YEAR_S
    solved = solve_ivp(slope, (0.0, end_s), [0.0], "Radau", rtol=1e-10, atol=1e-13)
    return float(solved.y[0, -1])


def rows(monkeypatch, **of_life):
    """The table of two switches held over one gap everywhere, with traps for all charge."""
    settings = LifetimeSettings(years=YEARS, traps_e_cm2=(1e15, 1e15), **of_life)
    flat = np.zeros((2, 8, 8))
    gaps = HeldGaps(DEVICE, np.array([GAP_NM]), np.ones(1), flat, np.full(2, 0.5), 500.0)
    monkeypatch.setattr(lifetime_accuracy, "held_gaps", lambda *_: gaps)
    central, point = (SimpleNamespace(held_V=volts) for volts in HELD_V)
    model = SimpleNamespace(central=central, points=[point], solved=np.array([0]))
    contact = ContactSettings(mechanics="asperity")
    made = lifetime_accuracy.accuracy_points(model, contact, settings, lambda *_: None)
    return list(made), settings


def errors_of(made, knob):
    return {row["value"]: row["error"] for row in made if row["knob"] == knob}


def test_an_error_of_classes_is_what_a_line_between_two_gaps_misses(monkeypatch):
    """Both known without the quadrature: shifts of a class and of the gap itself."""
    made, settings = rows(monkeypatch)
    known = errors_of(made, lifetime_accuracy.CLASSES)
    assert len(known) == len(lifetime_accuracy.SPACINGS_NM)
    for spacing_nm, error_V in zip(lifetime_accuracy.SPACINGS_NM, known.values(), strict=True):
        lower_nm = (np.floor(GAP_NM / spacing_nm - 0.5) + 0.5) * spacing_nm
        upper_nm = lower_nm + spacing_nm
        share = (GAP_NM - lower_nm) / spacing_nm
        missed_V = [
            (1.0 - share) * known_shift_V(hold_V, lower_nm, settings)
            + share * known_shift_V(hold_V, upper_nm, settings)
            - known_shift_V(hold_V, GAP_NM, settings)
            for hold_V in HELD_V
        ]
        root_mean_square_V = np.sqrt(np.mean(np.square(missed_V)))
        # the reference of the table has classes of its own, 0.06 nm apart
        assert error_V == pytest.approx(root_mean_square_V, rel=0.02, abs=2e-4)


def test_the_values_in_use_are_those_of_the_stage(monkeypatch):
    made, _ = rows(monkeypatch, period_s=1.0)
    in_use = {row["knob"]: row["value"] for row in made if row["shipped"]}
    assert in_use == {
        lifetime_accuracy.SHARES: LOST.size,
        lifetime_accuracy.CLASSES: GAPS_NM.size,
        lifetime_accuracy.PLACES: SEPARATIONS,
        lifetime_accuracy.PEELED: PEELING,
        lifetime_accuracy.CYCLES: PER_DECADE,
    }
    # one separation stands for a flat pad, whatever their number
    assert set(errors_of(made, lifetime_accuracy.PLACES).values()) == {0.0}
    assert all(row["release_V"] == row["error"] and row["unit"] == "V" for row in made)


def test_errors_fall_with_more_shares_and_cycles(monkeypatch):
    made, _ = rows(monkeypatch, period_s=1.0)
    for knob in (lifetime_accuracy.SHARES, lifetime_accuracy.CYCLES):
        errors = list(errors_of(made, knob).values())
        assert errors[-1] < 0.5 * errors[0]
