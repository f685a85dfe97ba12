"""Error of the failure rate against run time, one number of samples at a time.

The rate is that with the attraction with which as many fail as the scene allows: one in a million takes most samples.
"""

import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.failure.rate import Population, ReserveResponse, corrected, just_allowed, learned
from mesoscale.uncertainty.rare_events import Corrected

Row = dict[str, Any]

LEVELS = (500, 1000, 2000, 4000)
"""Points of each level of subset simulation."""
SEEDS = 4
RUNS = (32, 64, 128, 256)
"""Switches that correct the response."""


def accuracy_points(
    population: Population, allowed: float, progress: Callable[[float, str], None] | None = None
) -> Iterator[Row]:
    """Rows of accuracy/failure.csv.

    Parameters
    ----------
    population : see `mesoscale.failure.rate.Population`.
    allowed : share of the switches that may fail.

    Raises
    ------
    InputError : see `mesoscale.failure.rate.learned`.
    """
    tell = progress or (lambda *_: None)
    hold, responses, costs, started = population.hold_V, [], [], _clock()
    for response in learned(population, tell, 0):
        if not responses or response.switches > responses[-1].switches:
            responses.append(response)
            costs.append(_clock() - started)
    response = responses[-1]
    times = just_allowed(response, hold, allowed)
    tell(0.7, "samples")
    for samples in LEVELS:
        started = _clock()
        shares = [response.sample(times, hold, seed, samples=samples).probability for seed in range(SEEDS)]
        error = float(np.std(shares, ddof=1) / np.mean(shares))
        metric, cost = f"relative deviation over {SEEDS} seeds", (_clock() - started) / SEEDS
        yield _row("failing by the response", "points of a level", samples, error, metric, "their mean", cost)
    tell(0.8, "corrections")
    best: Corrected | None = None
    for runs in RUNS:
        started = _clock()
        best = corrected(response, times, hold, runs=runs)
        metric, cost = "coefficient of variation", _clock() - started
        yield _row(
            "failing", "switches that correct it", best.runs, best.variation, metric, "reported by the run", cost
        )
    if best and best.events:
        yield from _by_learning(responses, costs, times, hold, best)


def _by_learning(
    responses: list[ReserveResponse], costs: list[NDArray[np.float64]], times: float, hold_V: float, best: Corrected
) -> Iterator[Row]:
    """Fewer switches that the response learns from: its own rate beside the best one."""
    for response, cost in zip(responses, costs, strict=True):
        error = abs(response.sample(times, hold_V, 0).probability / best.probability - 1.0)
        metric, reference = "relative deviation", f"corrected by {best.runs} switches"
        yield _row(
            "failing by the response", "switches it learns from", response.switches, error, metric, reference, cost
        )


def _clock() -> NDArray[np.float64]:
    return np.array([time.perf_counter(), time.process_time()])


def _row(case: str, knob: str, value: int, error: float, metric: str, reference: str, cost: NDArray[np.float64]) -> Row:
    """A row; `cost` is wall and processor time (s)."""
    wall_s, cpu_s = cost.tolist()
    said = {"case": case, "knob": knob, "value": value, "error": error, "error_metric": metric, "reference": reference}
    return said | {"wall_s": wall_s, "cpu_s": cpu_s}
