"""Error of the failure rate against run time, one number of samples at a time.

The rate is that with the attraction with which as many fail as the scene allows: one in a million takes most samples.
"""

from collections.abc import Iterator
from functools import partial

import numpy as np

from mesoscale.failure.rate import Population, ReserveResponse, corrected, just_allowed, learned
from mesoscale.studies.driver import Array, Knob, Progress, Row, Try, clock, rows_of, timed

LEVELS = (500, 1000, 2000, 4000)
"""Points of each level of subset simulation."""
RUNS = (32, 64, 128, 256)
"""Switches that correct the response."""


def accuracy_points(population: Population, allowed: float, progress: Progress | None = None) -> Iterator[Row]:
    """Rows of accuracy/failure.csv.

    Parameters
    ----------
    population : see `mesoscale.failure.rate.Population`.
    allowed : share of the switches that may fail.

    Raises
    ------
    InputError : see `mesoscale.failure.rate.learned`.
    """
    hold, responses, started = population.hold_V, list[tuple[ReserveResponse, Array]](), clock()
    for response in learned(population, progress or (lambda *_: None), 0):
        if not responses or response.switches > responses[-1][0].switches:
            responses.append((response, clock() - started))
    response = responses[-1][0]
    times = just_allowed(response, hold, allowed)

    def level(samples: int, seeds: int = 4) -> Try:
        draws = (response.sample(times, hold, seed, samples=samples).probability for seed in range(seeds))
        shares, cost = timed(partial(list, draws), seeds)
        return Try(samples, float(np.std(shares, ddof=1) / np.mean(shares)), cost)

    case, metric = ["failing by the response"], "relative deviation over 4 seeds"
    yield from rows_of([Knob("points of a level", metric, "their mean", map(level, LEVELS), case)])
    corrections = [timed(partial(corrected, response, times, hold, runs=runs)) for runs in RUNS]
    tries = [Try(rate.runs, rate.variation, cost) for rate, cost in corrections]
    reported = Knob("switches that correct it", "coefficient of variation", "reported by the run", tries, ["failing"])
    yield from rows_of([reported])
    best = corrections[-1][0]
    if best.events:
        shares = [(learner.sample(times, hold, 0).probability, learner.switches, cost) for learner, cost in responses]
        fewer = [Try(switches, abs(share / best.probability - 1.0), cost) for share, switches, cost in shares]
        against = f"corrected by {best.runs} switches"
        yield from rows_of([Knob("switches it learns from", "relative deviation", against, fewer, case)])
