"""Creep and bonds of a held switch: energies, sums beside switches that are solved with both, and
tops that creep beside tops of a softer material.
"""

import numpy as np
import pytest

from mesoscale.charging.ageing import (
    Surroundings,
    ageing_of,
    ageing_rows,
    ageing_summary,
)
from mesoscale.charging.rates import guesses
from mesoscale.contact.cycle import run_cycle
from mesoscale.errors import InputError
from mesoscale.history.creep import follow, hardness_factor
from mesoscale.inputs.contact import ContactInputs
from mesoscale.pad.curves import bonded
from mesoscale.settings import ContactSettings, HistorySettings, LifetimeSettings
from mesoscale.settings.ageing import AgeingSettings
from mesoscale.studies.answer_stability import made_up_pad, published_beam
from mesoscale.studies.lifetime_stability import TOPS_GPA, made_up_ageing, made_up_life
from mesoscale.switch import switch_of
from mesoscale.switch.crept import crept_voltages, held_shape

PAD = made_up_pad(2.0)
BEAM = published_beam(hold_voltage_V=85.0)
PLATE = published_beam(spring_N_per_m=1000.0, hold_voltage_V=155.0)
SHARED = Surroundings(TOPS_GPA, None)
END_S = 3.15e8
TIMES = np.array([0.0, 1.0, 1e3, 1e6, END_S])


def aged(humidity=0.2, device=PLATE, of_life=None, apart=True, **ageing):
    settings = LifetimeSettings(years=10.0, ageing=AgeingSettings(**ageing), **(of_life or {}))
    hold_V = device.hold_voltage_V
    return ageing_of(device, hold_V, PAD, settings, END_S, humidity, SHARED, apart=apart)


def aged_beam(**ageing):
    return aged(device=BEAM, apart=False, **ageing)


@pytest.mark.parametrize("energy_J_m2", [0.01, 1.0])
def test_bonds_take_their_energy_of_what_touches(energy_J_m2):
    stronger = bonded(PAD, energy_J_m2, TOPS_GPA)
    assert stronger.closing is PAD.closing
    for before, after in zip(PAD.opening, stronger.opening, strict=True):
        known = np.isfinite(before[0])
        more_GPa = (after - before)[1, known]
        # J/m^2 is GPa nm
        work = -np.trapezoid(more_GPa, PAD.separation_nm[known])
        touching = before[0, known][0] / TOPS_GPA
        assert work == pytest.approx(energy_J_m2 * touching, rel=1e-6)
        assert (more_GPa <= 0.0).all()


def test_bonds_without_energy_change_nothing():
    np.testing.assert_array_equal(bonded(PAD, 0.0, TOPS_GPA).opening, PAD.opening)


@pytest.mark.parametrize("effect", [{"beam": "nickel"}, {"bonds_mJ_m2": (30.0, 30.0)}])
def test_between_strengths_the_switch_is_the_one_that_is_solved(effect):
    ageing = aged_beam(**effect)
    (name,) = ageing.effects
    for seconds in (1e5, 3e7):
        time = np.array([seconds])
        strength = float(ageing.strength(name, time, "central")[0])
        if name == "beam":
            solved = crept_voltages(BEAM, held_shape(BEAM, PAD), strength, PAD)
        else:
            states = switch_of(BEAM).states(bonded(PAD, 1e-3 * strength, TOPS_GPA))
            solved = states.pull_in_V, states.release_V
        fresh = switch_of(BEAM).states(PAD)
        pull_in, release = (
            np.sqrt(volts**2 + moved[0])
            for volts, moved in zip(
                (fresh.pull_in_V, fresh.release_V),
                ageing.squares_V2(time, "central"),
                strict=True,
            )
        )
        assert pull_in == pytest.approx(solved[0], rel=0.02)
        assert release == pytest.approx(solved[1], abs=0.1)


def test_a_switch_that_creeps_and_bonds_is_the_one_that_is_solved_with_both():
    ageing = aged_beam(beam="gold", relaxing=(0.3, 0.3), bonds_mJ_m2=(25.0, 25.0))
    held = held_shape(BEAM, PAD)
    fresh = switch_of(BEAM).states(PAD).release_V
    for seconds in (1e2, 1e3, 1e5, 1e7):
        time = np.array([seconds])
        relaxed = float(ageing.strength("beam", time, "central")[0])
        energy = float(ageing.strength("bonds", time, "central")[0])
        _, both = crept_voltages(BEAM, held, relaxed, bonded(PAD, 1e-3 * energy, TOPS_GPA))
        summed = np.sqrt(fresh**2 + ageing.squares_V2(time, "central")[1][0])
        # the least that a row of the budget counts
        assert summed == pytest.approx(both, abs=0.1)


def test_before_any_hold_nothing_has_moved():
    ageing = aged(beam="nickel", bonds_mJ_m2=(3.0, 100.0))
    for guess in ("least", "central", "most"):
        pull_in, release = ageing.squares_V2(np.zeros(1), guess)
        assert (pull_in[0], release[0]) == (0.0, 0.0)


def test_before_any_hold_an_ageing_switch_is_todays_to_the_bit():
    life, settings = made_up_ageing(
        {"ageing": {"beam": "nickel", "bonds_mJ_m2": (3.0, 100.0)}}, {"hold_voltage_V": 85.0}
    )
    today = switch_of(published_beam(hold_voltage_V=85.0)).states(PAD)
    start = np.zeros(1)
    shift, squares = life.charged(life.hold_V, start, settings, guesses(settings)["most"])
    pull_in, release = life.voltages(shift, squares, life.aged(start, "most"))
    assert (pull_in[0], release[0]) == (today.pull_in_V, today.release_V)


def test_a_life_without_ageing_is_the_same_to_the_bit():
    life, settings = made_up_life({}, {"hold_voltage_V": 85.0})
    shift, squares = life.charged(life.hold_V, TIMES, settings, guesses(settings)["central"])
    computed = life.voltages(shift, squares, life.aged(TIMES, "central"))
    np.testing.assert_array_equal(computed, life.voltages(shift, squares))
    assert "ageing" not in settings.model_dump()


def test_more_time_and_a_stronger_guess_age_more():
    ageing = aged(beam="nickel", bonds_mJ_m2=(3.0, 100.0))
    by_guess = [ageing.squares_V2(TIMES, guess)[1] for guess in ("least", "central", "most")]
    assert (np.diff(by_guess, axis=1) <= 0.0).all()
    assert (np.diff(by_guess, axis=0)[:, 1:] < 0.0).all()


def test_gold_relaxes_by_its_share_and_half_of_it_when_held_half_of_the_time():
    settings = {"beam": "gold", "relaxing": (0.1, 0.1)}
    time = np.array([1e6])
    assert aged(**settings).strength("beam", time, "most")[0] == pytest.approx(0.1)
    rests = aged(of_life={"duty": 0.5}, **settings)
    assert rests.strength("beam", time, "most")[0] == pytest.approx(0.05)


def test_aluminium_creeps_by_its_strain():
    strained = aged_beam(beam="aluminium", relaxing=(0.1, 0.1))
    assert 0.0017 < strained.strain < 0.0043
    share = (strained.strain - 0.0017) / 0.0026
    assert strained.strength("beam", TIMES, "most")[-1] == pytest.approx(0.1 * share)
    calm = published_beam(thickness_um=1.0, gap_um=1.0, hold_voltage_V=10.0)
    gentle = aged(device=calm, beam="aluminium")
    assert gentle.strain < 0.0017
    assert not gentle.effects


def test_bonds_grow_only_in_moist_air():
    assert not aged(humidity=0.0, bonds_mJ_m2=(3.0, 100.0)).effects
    assert not aged(humidity=1.0, bonds_mJ_m2=(3.0, 100.0)).effects
    assert aged(humidity=0.3, bonds_mJ_m2=(3.0, 100.0)).effects


def test_bonds_break_when_a_drive_with_a_period_opens():
    ageing = aged(of_life={"period_s": 100.0, "duty": 0.5}, bonds_mJ_m2=(10.0, 10.0))
    strengths = ageing.strength("bonds", np.array([10.0, 1e3, END_S]), "central")
    assert strengths[0] == pytest.approx(10.0 * np.log10(51.0))
    assert strengths[1:] == pytest.approx(10.0 * np.log10(501.0))


def test_each_effect_has_its_rows_and_all_of_them_together():
    life, _ = made_up_ageing(
        {"ageing": {"beam": "nickel", "bonds_mJ_m2": (3.0, 100.0)}}, {"hold_voltage_V": 85.0}
    )
    rows = list(ageing_rows(life))
    assert {row["effect"] for row in rows} == {"beam", "bonds", "all"}
    fresh = [row for row in rows if row["time_s"] == 0.0]
    assert all(row["release_V"] == life.release_V[0] for row in fresh)
    assert all((row["strength"] is None) == (row["effect"] == "all") for row in rows)
    content = ageing_summary(life.ageing)
    assert content["strengths"]["bonds"]["most"] == pytest.approx(
        max(row["strength"] for row in rows if row["effect"] == "bonds")
    )
    assert 4e-3 < content["menisci_s"] < content["menisci_99_s"] < 0.1


def test_tops_that_creep_come_to_where_softer_tops_are_pressed():
    """A contact held while its hardness falls, beside one that was closed at the lower hardness."""
    hard = {"hamaker": 0.215, "e_star": 91.0, "q0": 0.025, "hurst": 0.75, "rms": 8.5}
    inputs = ContactInputs(**hard, h_macro=1.95, h_prime=8.375)
    contact = ContactSettings(pixels=128, q1_per_nm=0.3)
    law = HistorySettings(cycles=1, dwell_s=1e6, creep_strength=0.03)
    held = next(follow(inputs, contact, law, seed=1))
    factor = float(hardness_factor(1e6, law))
    softer = ContactInputs(**hard, h_macro=1.95 * factor, h_prime=8.375 * factor)
    closed = run_cycle(softer, contact, 1, contact_at="lowest").closing
    crept = held.hold[-1]
    sunk_nm = held.hold[0].separation - crept.separation
    assert crept.separation == pytest.approx(closed.separation_nm[-1], abs=0.1 * sunk_nm)
    area = crept.sites * (contact.length_nm / contact.pixels) ** 2
    assert area == pytest.approx(closed.contact_area_nm2[-1], rel=0.02)


@pytest.mark.parametrize(
    ("mistake", "words"),
    [
        ({}, "nothing ages: give beam, tops or bonds_mJ_m2"),
        ({"beam": "copper"}, "beam = 'copper'"),
        ({"beam": "nickel", "grain_nm": (0.0, 50.0)}, "grain_nm"),
        ({"beam": "nickel", "grain_nm": (90.0, 50.0)}, r"grain_nm = \[90, 50\]: give the least"),
        ({"beam": "gold", "relaxing": (0.1, 1.5)}, "relaxing"),
        ({"tops": (-0.1, 0.1)}, "tops"),
        ({"bonds_mJ_m2": (0.0, 0.1)}, "bonds_mJ_m2"),
        ({"bonds_mJ_m2": (float("nan"), 0.1)}, "bonds_mJ_m2"),
    ],
)
def test_bad_ageing_is_refused_in_one_line(mistake, words):
    with pytest.raises(InputError, match=words) as caught:
        AgeingSettings(**mistake)
    assert "\n" not in str(caught.value)
