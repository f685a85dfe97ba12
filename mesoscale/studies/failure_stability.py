"""Rare, certain and impossible failures, each beside an exact probability or a switch that is
solved (`stability`).
"""

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial

import numpy as np
from scipy.special import ndtr, ndtri

from mesoscale.answer.points import Point
from mesoscale.errors import InputError
from mesoscale.failure.population import FAILURE, Population
from mesoscale.failure.rate import furthest_allowed, learn
from mesoscale.pad.curves import PadCurves, attracting
from mesoscale.settings import DeviceSettings
from mesoscale.studies.answer_stability import made_up_pad, published_beam
from mesoscale.studies.driver import Array, HardCase
from mesoscale.switch import switch_of
from mesoscale.switch.reserve import Attracted
from mesoscale.uncertainty.rare_events import (
    LEAST,
    Moments,
    Sampled,
    correct,
    rates_given,
    sample_event,
)

BEAM = published_beam(hold_voltage_V=80.0)
PLATE = published_beam(spring_N_per_m=1e3, hold_voltage_V=160.0)
PROBABILITIES = (1e-8, 1e-6, 1e-4, 1e-2, 0.1, 0.5, 0.99)
DIMENSION = 12
DEVIATIONS = 4.0
"""A probability may be off by so many of its stated standard errors: by chance in one of 16,000."""
LEAST_VARIATION = 0.02
"""Error of a common event, whose few independent runs may agree by chance."""
CHECK_EXACT = f"within {DEVIATIONS:g} of its stated errors of the exact probability"
CHECK_CORRECTED = "its interval holds what is known"
CHECK_RATES = "quantiles of the share as exact ones"
CHECK_RESERVE = "sticks beyond its reserve and lets go before, by the whole switch"


def hard_cases(population: Population) -> list[HardCase]:
    """The cases; those of the population itself solve none of its switches."""
    return [
        *exact_events(),
        *corrections(),
        *common_rates(),
        *limits(),
        *reserves(),
        *_refusals(population),
    ]


def plane(distance: float, dimension: int = DIMENSION, deviation: float = 0.0) -> Moments:
    """A reserve that falls along all numbers alike, and is 0 at this distance from the middle."""

    def moments(z: Array) -> tuple[Array, Array]:
        return distance - z.sum(axis=1) / np.sqrt(dimension), np.full(len(z), max(deviation, 1e-9))

    return moments


def exact_events() -> Iterator[HardCase]:
    """Events whose probability is known."""
    from scipy.stats import chi2  # slow to import

    def ball(z: Array) -> tuple[Array, Array]:
        return 40.0 - (z**2).sum(axis=1), np.full(len(z), 1e-9)

    def two_sides(z: Array) -> tuple[Array, Array]:
        return 4.0 - np.abs(z[:, 0]), np.full(len(z), 1e-9)

    unsure = 2.0
    events: dict[str, tuple[str, Moments, int, float]] = {}
    for value in PROBABILITIES:
        distance = -float(ndtri(value))
        words = f"a plane in {DIMENSION} numbers"
        events[f"probability {value:g}"] = (words, plane(distance), DIMENSION, value)
    events |= {
        "40 numbers": ("1e-6 in many dimensions", plane(-float(ndtri(1e-6)), 40), 40, 1e-6),
        "one number": ("1e-6 in one dimension", plane(-float(ndtri(1e-6)), 1), 1, 1e-6),
        "two sides": ("two ways to fail, far apart", two_sides, 3, 2.0 * float(ndtr(-4.0))),
        "ball": ("fails on all sides, none likeliest", ball, 10, float(chi2.sf(40.0, 10))),
        "unsure response": (
            "its error is twice the scatter of the switches",
            plane(6.0, DIMENSION, unsure),
            DIMENSION,
            float(ndtr(-6.0 / np.hypot(1.0, unsure))),
        ),
        "none fails": ("20 deviations off", plane(20.0), DIMENSION, 0.0),
        "all fail": ("20 deviations beyond", plane(-20.0), DIMENSION, 1.0),
    }
    for name, (description, moments, dimension, exact) in events.items():
        yield HardCase(name, description, CHECK_EXACT, partial(_exact, moments, dimension, exact))


def _exact(moments: Moments, dimension: int, exact: float) -> tuple[bool, str]:
    sampled = sample_event(moments, dimension, 0.0, 0)
    detail = f"{sampled.probability:.3g} of {exact:.3g}, stated to {sampled.variation:.1%}"
    if exact == 0.0:
        return sampled.probability <= LEAST and not len(sampled.points), detail
    finite = bool(np.isfinite(sampled.points).all())
    known = finite and len(sampled.points) == len(sampled.chance) > 0
    missed = abs(np.log(max(sampled.probability, LEAST) / exact))
    allowed = DEVIATIONS * max(sampled.variation, LEAST_VARIATION)
    return known and missed <= allowed, detail


def corrections() -> Iterator[HardCase]:
    """Runs that correct a response, of which all, none or but one say the same."""
    sampled = Sampled(np.full(8, 1e-3), np.zeros((64, 2)), np.full(64, 0.5))
    half = np.arange(64) % 2 == 0
    # happened, chance of the response, and the exact probability that the interval must hold
    runs: dict[str, tuple[str, Array, float, float]] = {
        "runs agree": ("half of the runs fail, as the response has it", half, 0.5, 1e-3),
        "all runs fail": ("the response gave each one half", np.ones(64, bool), 0.5, 2e-3),
        "no run fails": ("the response gave each one half", np.zeros(64, bool), 0.5, 2e-5),
        "one run": ("and it fails", np.ones(1, bool), 1.0, 1e-3),
        "no run": ("the response finds no failure", np.zeros(0, bool), 1.0, 0.0),
        "sure response that errs": ("gave each 0.999, half of them fail", half, 0.999, 5e-4),
    }
    for name, (description, happened, chance, exact) in runs.items():
        yield HardCase(
            name,
            description,
            CHECK_CORRECTED,
            partial(_corrected, sampled, happened, chance, exact),
        )


def _corrected(sampled: Sampled, happened: Array, chance: float, exact: float) -> tuple[bool, str]:
    corrected = correct(sampled, happened.astype(bool), np.full(happened.size, chance))
    held = corrected.low * (1.0 - 1e-9) <= exact <= corrected.high * (1.0 + 1e-9)
    inside = 0.0 <= corrected.low <= corrected.high <= 1.0
    return held and inside, f"{corrected.low:.3g} .. {corrected.high:.3g} of {exact:.3g}"


def common_rates() -> Iterator[HardCase]:
    """Shares that fail by what is common to all devices: all, none or half of the numbers."""
    shares = {"nothing common": 0, "half common": DIMENSION // 2, "all common": DIMENSION}
    for name, shared in shares.items():
        for distance in (2.0, 5.0):
            judge = partial(_rates, shared, distance)
            if shared == DIMENSION:
                judge = partial(_rates_of_all, distance)
            yield HardCase(
                f"{name}, {distance:g} deviations off",
                f"{shared} of {DIMENSION} numbers",
                CHECK_RATES,
                judge,
            )


def _rates_of_all(distance: float) -> tuple[bool, str]:
    """Where all is common, all devices of a draw fail or none does."""
    rates = rates_given(plane(distance), np.ones(DIMENSION, bool), 0.0, 0)
    exact = float(ndtr(-distance))
    # the number of draws that fail is binomial
    allowed = DEVIATIONS * np.sqrt(exact / rates.size) + 1.0 / rates.size
    held = abs(rates.mean() - exact) <= allowed
    return set(rates) <= {0.0, 1.0} and held, f"{rates.mean():.3g} of {exact:.3g}"


def _rates(shared: int, distance: float) -> tuple[bool, str]:
    """Given the common part u of a plane, the share is that beyond (distance - a u) / b, with a^2 +
    b^2 = 1.
    """
    rates = rates_given(plane(distance), np.arange(DIMENSION) < shared, 0.0, 0)
    a, b = np.sqrt([shared / DIMENSION, 1.0 - shared / DIMENSION])
    details = []
    held = True
    for probability in (0.25, 0.5, 0.75):
        exact = float(ndtr((a * ndtri(probability) - distance) / b))
        # between the order statistics that hold it, and to the error of the inner draws
        spread = DEVIATIONS * np.sqrt(probability * (1.0 - probability) / rates.size)
        orders = np.clip([probability - spread, probability + spread], 0.0, 1.0)
        low, high = np.quantile(rates, orders)
        held = held and low * 0.5 <= exact <= high * 2.0
        details.append(f"{np.quantile(rates, probability):.2g} of {exact:.2g}")
    return held, ", ".join(details)


def limits() -> Iterator[HardCase]:
    """The last voltage with an allowed probability, on curves that allow all, none, or just the
    first.
    """
    volts = np.array([70.0, 80.0, 90.0])
    rising = np.array([1e-5, 1e-3, 1e-2])
    # half of the logarithm between two voltages
    curves: dict[str, tuple[Array, Array, float, float | None]] = {
        "limit between": (volts, rising, 1e-4, 75.0),
        "limit at the first": (volts, rising, 1e-5, 70.0),
        "nothing allowed": (volts, rising, 1e-6, None),
        "everything allowed": (volts, rising, 0.5, 90.0),
        "a curve of zeros": (volts, np.zeros(3), 1e-8, 90.0),
        "a dip by chance": (volts, np.array([1e-5, 1e-3, 1e-6]), 1e-4, 75.0),
    }
    for name, (values, probability, allowed, exact_value) in curves.items():
        judge = partial(_limit, values, probability, allowed, exact_value)
        yield HardCase(name, f"{allowed:g} allowed", "the voltage that is known", judge)


def _limit(
    values: Array, probability: Array, allowed: float, exact_value: float | None
) -> tuple[bool, str]:
    furthest = furthest_allowed(values, probability, allowed)
    falling = furthest_allowed(100.0 - values, probability, allowed)
    if exact_value is None or furthest is None or falling is None:
        return furthest is falling is exact_value, f"{furthest}"
    rising_held = abs(furthest - exact_value) <= 1e-6
    falling_held = abs(falling - (100.0 - exact_value)) <= 1e-6
    return rising_held and falling_held, f"{furthest:.6g} V"


def reserves() -> Iterator[HardCase]:
    """Switches whose attraction is changed until they just fail."""
    pad = made_up_pad(40.0)
    for name, settings in (("beam", BEAM), ("plate", PLATE)):
        yield HardCase(
            f"reserve of a {name}",
            "bisection of a yes or no",
            CHECK_RESERVE,
            partial(_reserve, settings, pad),
        )
        slower = partial(_asks_for_more, settings, pad)
        yield HardCase(
            f"{name} let go in time", "a window", "no larger reserve than to let go at all", slower
        )
    ends: dict[str, tuple[float, Callable[[float], bool]]] = {
        "a well far deeper than the spring": (
            1e6,
            lambda log_reserve: log_reserve < np.log(FAILURE.least_times) + FAILURE.step,
        ),
        "no adhesion": (
            0.0,
            lambda log_reserve: log_reserve > np.log(FAILURE.most_times) - FAILURE.step,
        ),
    }
    for name, (adhesion_kPa, holds) in ends.items():
        judge = partial(_at_the_end, made_up_pad(adhesion_kPa), holds)
        yield HardCase(
            name, "the reserve is beyond what is tried", "the end of what is tried", judge
        )
    narrow = PLATE.model_copy(update={"gap_um": 0.02})
    yield HardCase(
        "gap of 20 nm",
        "rests in its own pad",
        "told, or refused in one line",
        partial(_told, narrow, pad),
    )


def _reserve(settings: DeviceSettings, pad: PadCurves) -> tuple[bool, str]:
    reserve = Attracted(settings, pad, 0.0).reserve()
    switch = switch_of(settings)

    def sticks(logarithm: float) -> bool:
        scaled = attracting(pad, float(np.exp(logarithm)))
        return switch.states_on(scaled).release_V == 0.0

    held = sticks(reserve + FAILURE.step) and not sticks(reserve - FAILURE.step)
    return held, f"just sticks with {np.exp(reserve):.3g} times the attraction"


def _asks_for_more(settings: DeviceSettings, pad: PadCurves) -> tuple[bool, str]:
    in_time, at_all = (Attracted(settings, pad, volts).reserve() for volts in (2.0, 0.0))
    return in_time <= at_all, f"{np.exp(in_time):.3g} and {np.exp(at_all):.3g} times the attraction"


def _at_the_end(pad: PadCurves, holds: Callable[[float], bool]) -> tuple[bool, str]:
    reserve = Attracted(PLATE, pad, 0.0, coarse=True).reserve()
    return holds(reserve), f"{np.exp(reserve):.3g} times the attraction"


def _told(settings: DeviceSettings, pad: PadCurves) -> tuple[bool, str]:
    try:
        return True, f"fails: {Attracted(settings, pad, 0.0, coarse=True).fails(1.0)}"
    except InputError as error:
        return "\n" not in str(error), str(error)


def _refusals(population: Population) -> Iterator[HardCase]:
    """The scene's population, if none of its pads could be pressed."""

    def refused(_point: Point, _times: int, _number: int) -> None:
        raise InputError("the cells never reach the pressure")

    unpressed = replace(population, press=refused, solved=(population.solved[0][:0], []))
    words = "none of its pads can be pressed"
    yield HardCase(
        "own switches unpressed, learned",
        words,
        "refused in one line",
        partial(_unlearned, unpressed),
    )
    yield HardCase(
        "own switches unpressed", words, "all count as failed", partial(_all_failed, unpressed)
    )


def _unlearned(population: Population) -> tuple[bool, str]:
    try:
        learn(population, lambda *_: None)
    except InputError as error:
        line = str(error)
        return "switches can be solved" in line and "\n" not in line, line
    return False, "learned"


def _all_failed(population: Population) -> tuple[bool, str]:
    failed = population.failed(np.zeros((2, population.dimension)), population.hold_V, 1.0)
    return bool(failed.all()), f"{failed.sum()} of 2 failed"
