"""How often a switch fails: its reserve, and probabilities against brute force."""

from contextlib import suppress
from dataclasses import replace

import numpy as np
import pytest
from pydantic import ValidationError

from evidence.failure.rare_failures import KnownPad, known_pad, population
from mesoscale.errors import InputError
from mesoscale.failure.population import FAILURE
from mesoscale.failure.rate import (
    corrected,
    furthest_allowed,
    just_allowed,
    learn,
    least_rms_nm,
)
from mesoscale.failure.springs import Sprung, least_spring
from mesoscale.pad.curves import attracting
from mesoscale.settings import FailureSettings
from mesoscale.studies.answer_stability import made_up_pad, published_beam
from mesoscale.switch import switch_of
from mesoscale.switch.beam_switch import BeamSwitch
from mesoscale.switch.reserve import Attracted

BEAM = published_beam(hold_voltage_V=80.0)
PLATE = published_beam(spring_N_per_m=1e3, hold_voltage_V=160.0)


def test_a_closed_beam_lets_go_where_the_solved_one_does():
    law = made_up_pad(40.0)
    for times in (0.5, 1.0):
        release = BeamSwitch(BEAM).states_on(attracting(law, times)).release_V
        closed = BeamSwitch(BEAM).closed_on(law)
        assert release > 0.0
        assert closed(1.01 * release, times)
        assert not closed(0.99 * release, times)


@pytest.mark.parametrize("settings", [BEAM, PLATE])
def test_the_reserve_is_the_attraction_with_which_the_switch_just_sticks(settings):
    law = made_up_pad(40.0)
    reserve = Attracted(settings, law, 0.0).reserve()
    for logarithm, wanted in ((reserve - FAILURE.step, False), (reserve + FAILURE.step, True)):
        scaled = attracting(law, float(np.exp(logarithm)))
        assert (switch_of(settings).states_on(scaled).release_V == 0.0) == wanted
    # to let go in time asks for more than to let go
    assert Attracted(settings, law, 2.0).reserve() <= reserve


@pytest.mark.parametrize("missed", [-9.0, -0.6, -0.04, 0.0, 0.04, 0.6, 9.0])
def test_a_guess_of_the_reserve_changes_nothing_and_a_good_one_spares_tries(missed):
    class Counted(Attracted):
        tried = 0

        def fails(self, times):
            self.tried += 1
            return super().fails(times)

    law = made_up_pad(40.0)
    without = Counted(PLATE, law, 0.0, coarse=True)
    reserve = without.reserve()
    guessed = Counted(PLATE, law, 0.0, coarse=True)
    assert guessed.reserve(about=reserve + missed) == pytest.approx(reserve, abs=1e-12)
    if abs(missed) < FAILURE.step:
        assert guessed.tried <= without.tried / 2


def test_a_well_far_deeper_than_the_spring_and_none_at_all_reach_the_ends():
    assert (
        Attracted(PLATE, made_up_pad(1e6), 0.0, coarse=True).reserve() < np.log(0.1) + FAILURE.step
    )
    assert (
        Attracted(PLATE, made_up_pad(0.0), 0.0, coarse=True).reserve() > np.log(30.0) - FAILURE.step
    )


def test_a_gap_of_20_nm_is_told_or_refused():
    """A switch that rests in its own pad gives an answer or a line, no other error."""
    narrow = Attracted(
        PLATE.model_copy(update={"gap_um": 0.02}), made_up_pad(40.0), 0.0, coarse=True
    )
    with suppress(InputError):
        assert narrow.fails(1.0) in (True, False)


@pytest.mark.parametrize(
    ("allowed", "wanted"),
    [(1e-4, 75.0), (1e-6, None), (0.5, 90.0), (1e-5, 70.0)],
    ids=["between", "none", "all", "least"],
)
def test_the_furthest_value_is_where_the_curve_meets_what_is_allowed(allowed, wanted):
    volts, probability = np.array([70.0, 80.0, 90.0]), np.array([1e-5, 1e-3, 1e-2])
    found = furthest_allowed(volts, probability, allowed)
    assert found == (wanted if wanted is None else pytest.approx(wanted))
    # as heights, of which the least fail most
    falling = furthest_allowed(100.0 - volts, probability, allowed)
    assert falling == (wanted if wanted is None else pytest.approx(100.0 - wanted))


def brute_force(plates, hold_V, times, about, known=()):
    """Share of 600 plates that fail with `times` their attraction, solved one by one, and its
    standard error.

    Parameters
    ----------
    about : where they are drawn, for more of them to fail; each counts with its likelihood,
        whatever the place.
    known : place of a number and its value.
    """
    z = np.random.default_rng(5).normal(size=(600, plates.dimension))
    drawn = [k for k in range(plates.dimension) if k not in known[:1]]
    weights = np.exp(-z[:, drawn] @ about[drawn] - 0.5 * about[drawn] @ about[drawn])
    z += about
    if known:
        z[:, known[0]] = known[1]
    failing = weights * plates.failed(z, hold_V, times)
    return failing.mean(), failing.std(ddof=1) / np.sqrt(len(z))


def test_the_probability_is_that_of_brute_force():
    """Some 1 % of the plates fail."""
    plates = population()
    response = learn(plates, lambda *_: None)
    found = corrected(response, 1.42, plates.hold_V)
    about = response.sample(1.42, plates.hold_V, 0).points.mean(axis=0)
    share, error = brute_force(plates, plates.hold_V, 1.42, about)
    assert error < 0.12 * share
    assert found.low - 2.0 * error < share < found.high + 2.0 * error
    assert found.runs + response.switches < 400
    one_in_a_million = corrected(response, 1.18, plates.hold_V)
    assert 1e-7 < one_in_a_million.probability < 1e-4
    assert one_in_a_million.variation < 0.3
    # less attraction bears smoother films
    smoother, least = (least_rms_nm(response, times, plates.hold_V, 0.01) for times in (1.18, 1.42))
    assert smoother is not None
    assert least is not None
    assert smoother <= least
    known = plates.names.index("rms"), (least - 9.0) / 0.8  # deviations of the study's input
    # all numbers are common: with a confidence of 0.9 all devices of up to a tenth of the batches
    # may fail
    assert 0.004 < brute_force(plates, plates.hold_V, 1.42, about, known)[0] < 0.1
    # so does less attraction bear weaker springs
    likely = response.sample(just_allowed(response, plates.hold_V, 0.01), plates.hold_V, 0)
    sprung = Sprung(plates, likely, plates.hold_V)
    weaker, spring = (least_spring(sprung, times, 0.01) for times in (1.29, 1.42))
    assert weaker is not None
    assert spring is not None
    assert weaker < spring
    for times, value in ((1.29, weaker), (1.42, spring)):
        sprung = replace(
            plates, settings=plates.settings.model_copy(update={"spring_N_per_m": value})
        )
        share, error = brute_force(sprung, plates.hold_V, times, about)
        # the spring's 32 switches know 1 % to 25 %
        assert abs(np.log(share / 0.01)) < 2.0 * np.hypot(0.25, error / share)


def test_a_switch_whose_halves_disagree_is_decided_by_more_cells():
    """Pads of few cells that pull ten times too hard on one half of them; those of many pull as
    they should.
    """
    asked = []

    class Uneven(KnownPad):
        @property
        def halves(self):
            return self.curves, attracting(self.curves, 10.0)

    def press(point, times, number):
        asked.append(times)
        law = known_pad(point).curves
        return KnownPad(law) if times > 1 else Uneven(law)

    plates = replace(population(4), press=press)
    z = np.zeros((1, plates.dimension))
    assert not plates.failed(z, plates.hold_V, 1.0)[0]
    assert asked == [1, 4]


def test_a_switch_that_cannot_be_pressed_has_failed():
    def refused(*_):
        raise InputError("the cells never reach the pressure")

    plates = replace(population(4), press=refused)
    assert plates.failed(np.zeros((2, plates.dimension)), plates.hold_V, 1.0).all()


def test_populations_that_cannot_be_pressed_and_windows_that_none_reaches_are_one_line():
    def refused(*_):
        raise InputError("the cells never reach the pressure")

    plates = population()
    with pytest.raises(InputError, match=r"failure: 0 of \d+ switches can be solved"):
        learn(replace(plates, press=refused, solved=(plates.solved[0][:0], [])), lambda *_: None)
    with pytest.raises(
        InputError, match=r"failure\.release_V = 60: 0 of \d+ switches release above it"
    ):
        learn(replace(population(), release_V=60.0), lambda *_: None)


@pytest.mark.parametrize(
    ("given", "line"),
    [
        ({"probability": 0.0}, "greater than 0"),
        ({"probability": 1.0}, "less than 1"),
        ({"probability": 1e-6, "release_V": -1.0}, "greater than or equal to 0"),
        ({"probability": 1e-6, "release_V": [5.0, 9.0]}, "valid number"),  # a window has one side
    ],
)
def test_settings_of_failures_outside_their_range_are_one_line(given, line):
    with pytest.raises(ValidationError, match=line) as refused:
        FailureSettings.model_validate(given)
    assert refused.value.error_count() == 1


def test_the_least_spring_is_found_where_stiff_switches_press_too_hard():
    """Pads that bear the scene's own spring and no stiffer one."""
    plates = population()
    own = plates.settings.spring_N_per_m

    def press(point, *_):
        if point.device.spring_N_per_m > 1.001 * own:
            raise InputError("the pad is closed to its mean plane")
        return known_pad(point)

    response = learn(plates, lambda *_: None)
    likely = response.sample(1.42, plates.hold_V, 0)
    bearing = replace(plates, press=press)
    found, known = (
        least_spring(Sprung(switches, likely, plates.hold_V), 1.0, 0.01)
        for switches in (bearing, plates)
    )
    assert found == pytest.approx(known, rel=0.03)
    assert found < own
