"""Error of a rare probability of failure against run time.

The response is that of the switches of the answer, whose pads are there: the stage presses a
hundred more. All values are judged at the attraction with which as many switches as allowed fail by
this response.
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import numpy as np
from scipy.special import ndtr, ndtri

from mesoscale.errors import InputError
from mesoscale.failure.population import FAILURE, Population
from mesoscale.failure.rate import ReserveResponse, just_allowed
from mesoscale.studies.driver import (
    Array,
    Choice,
    Cost,
    Errors,
    Knob,
    Progress,
    Quantity,
    StudyRow,
    root_mean_square,
    rows_of,
    timed,
)
from mesoscale.uncertainty.rare_events import LEAST, REPEATS, SAMPLES, Process, Sampled

SEEDS = 3
"""Independent tries of each choice."""
PARTS = 8
"""Random parts of the switches."""
FIRST_SEED = 100
"""Beyond those of the stage."""
TRIED = 32
"""Switches that are pressed to know the scatter between correcting ones."""
SAMPLED, LEARNED, RUNS = (
    "points of each level",
    "switches learned from",
    "switches that correct a probability",
)
UNIT = "% of the probability"
RATE = Quantity("probability of failure", UNIT)


def accuracy_points(
    population: Population, allowed: float, progress: Progress
) -> Iterator[StudyRow]:
    """Rows of accuracy/failure.csv without the stage.

    Parameters
    ----------
    allowed : share of the switches that may fail.

    Raises
    ------
    InputError : see `response_of_answer`.
    """
    response = response_of_answer(population)
    _, one = timed(partial(population.reserves, ndtri(population.solved[0][:1]), population.hold_V))
    progress(0.3, "response")
    times = just_allowed(response, population.hold_V, allowed)
    sampled = response.sample(times, population.hold_V, FIRST_SEED, repeats=REPEATS)
    knobs = [
        _points(response, times),
        _learned(response, sampled, times, one),
        _runs(response, sampled, times),
    ]
    yield from rows_of(knobs, lambda share, words: progress(0.5 + 0.5 * share, words))


def response_of_answer(population: Population) -> ReserveResponse:
    """The response of the switches whose pads were pressed for the answer.

    Raises
    ------
    InputError : too few of them can be solved.
    """
    units, pads = population.solved
    z = ndtri(units)
    columns = population.columns(z, np.full(len(z), population.hold_V))
    reserves = population.reserves(z, population.hold_V, pads)
    known = reserves > np.log(FAILURE.least_times) + FAILURE.step
    if known.sum() < FAILURE.fewest:
        raise InputError(
            f"pad.points: {known.sum()} of {len(z)} switches can be solved and let go; accepted for"
            f" the accuracy of a failure rate are at least {FAILURE.fewest}; raise pad.points"
        )
    learned = columns[known], reserves[known]
    return ReserveResponse(population, Process(*learned), len(z), *learned)


def _logarithm(probability: float) -> float:
    """Of the probability, in per cent: small differences are then relative ones, large ones have no
    bound.
    """
    return 100.0 * float(np.log(max(probability, LEAST)))


def _points(response: ReserveResponse, times: float) -> Knob:
    """Fewer or more points of each level of subset simulation, by the same response."""
    hold_V = response.population.hold_V

    def probabilities(samples: int, seeds: int = SEEDS) -> Array:
        samples_of_seeds = [
            response.sample(times, hold_V, FIRST_SEED + k, samples=samples, repeats=REPEATS)
            for k in range(seeds)
        ]
        return np.array([[_logarithm(sampled.probability)] for sampled in samples_of_seeds])

    # of fewer than some 400 points OpenTURNS may find a variance below zero, and stops
    counts = (SAMPLES // 4, SAMPLES // 2, SAMPLES)
    choices = [Choice(count, partial(probabilities, count)) for count in counts]
    finest = 4 * SAMPLES
    best = partial(probabilities, finest, 1)
    return Knob(SAMPLED, [RATE], choices, SAMPLES, f"{finest} points", best, f"{SEEDS} seeds")


def _learned(response: ReserveResponse, sampled: Sampled, times: float, one: Cost) -> Knob:
    """A response from random parts of the switches. It takes the time of pressing so many, each at
    the cost `one`.

    Failures by the whole response are weighed by what the other one says of them (importance
    sampling), which costs nothing beside a search of its own.
    """
    count = len(response.reserves)
    hold_V = response.population.hold_V

    def probability(part: int, seed: int) -> float:
        """That of a failure, by the response from a random part of the switches."""
        chosen = np.random.default_rng(seed).permutation(count)[:part]
        process = Process(response.columns[chosen], response.reserves[chosen])
        mean, deviation = replace(response, process=process).moments(sampled.points, hold_V)
        chance = ndtr((np.log(times) - mean) / deviation)
        return sampled.probability * float(np.mean(chance / sampled.chance))

    def errors(part: int) -> Errors:
        by_parts = np.array([[_logarithm(probability(part, seed))] for seed in range(PARTS)])
        apart = by_parts - _logarithm(sampled.probability)
        return Errors(*root_mean_square(apart), one.times(part))

    parts = [round(share * count) for share in (0.4, 0.6, 0.8)]
    choices = [Choice(part, partial(errors, part)) for part in parts]
    words = f"all {count} switches that were learned from"
    return Knob(LEARNED, [RATE], choices, count, words, samples=f"{PARTS} random parts")


def _runs(response: ReserveResponse, sampled: Sampled, times: float) -> Knob:
    """Fewer or more switches that correct the response: standard errors by the scatter of some."""
    factors, cost = timed(partial(correcting_factors, response, sampled, times))
    count = max(factors.size, 1)

    def errors(runs: int) -> Errors:
        error, own_error = relative_errors(factors, runs)
        return Errors([error], [own_error], cost.times(runs / count))

    counts = (FAILURE.runs // 4, FAILURE.runs // 2, FAILURE.runs, 2 * FAILURE.runs)
    choices = [Choice(runs, partial(errors, runs)) for runs in counts]
    words = f"{(factors > 0).sum()} of {factors.size} switches that should fail do"
    return Knob(RUNS, [RATE], choices, FAILURE.runs, words, samples="by their scatter")


def correcting_factors(response: ReserveResponse, sampled: Sampled, times: float) -> Array:
    """Of switches that fail by the response: 1 over its chance where one does fail, else 0; shape
    (runs,).
    """
    chosen = np.random.default_rng(FIRST_SEED).permutation(len(sampled.points))[:TRIED]
    population = response.population
    failed = population.failed(sampled.points[chosen], population.hold_V, times)
    return failed / sampled.chance[chosen]


def relative_errors(factors: Array, runs: int) -> tuple[float, float]:
    """Standard error of the mean of so many factors (%), and its own by leaving one out; NaN where
    none fails.
    """
    if factors.size < 2 or not factors.any():
        return np.nan, np.nan

    def error(values: Array) -> float:
        return 100.0 * float(values.std(ddof=1) / values.mean() / np.sqrt(runs))

    # the jackknife; where the only failure is left out, there is no error
    without_one = [np.delete(factors, k) for k in range(factors.size)]
    errors = np.array([error(values) for values in without_one if values.any()])
    scatter = ((errors - errors.mean()) ** 2).sum()
    own_error = float(np.sqrt((factors.size - 1) / factors.size * scatter))
    return error(factors), own_error
