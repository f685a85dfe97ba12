"""Do failure rates hold exact probabilities where the limit is a plane, a circle, two planes, or a
corner?

A switch of the plates fails beyond a limit whose probability is exactly one in a million. Its
reserve is the distance from the limit, `SLOPE` a deviation, known to the steps in which reserves
are sought. Everything else is the stage's own: what it learns from, how it samples and corrects.
`loops`: the same plane at several levels, half of its variance common to all devices; quantiles of
the share beside their closed form.
"""

from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from time import process_time
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr, ndtri, stdtrit
from scipy.stats import qmc

from evidence.failure.rare_failures import CUTOFFS_NM, PLATE, TABLE, known_pad
from evidence.failure.two_loops import VARIED
from mesoscale.failure.population import Population
from mesoscale.failure.rate import corrected, learn
from mesoscale.switch.reserve import LEAST_TIMES, MOST_TIMES, STEP
from mesoscale.uncertainty.rare_events import LEAST, REPEATS, quantiles_of

Array = NDArray[np.float64]
Limit = Callable[[Array], Array]

EXACT_P = 1e-6
LEVELS = (1e-2, 1e-4, 1e-6, 1e-8)
SLOPE = 0.4
"""Of the reserve, a deviation: a logarithm of the attraction, as RMS heights that vary by 9 % give.
"""
FIRST_SEED = 7600
SOLVED = 36
"""Switches of the answer, the fewest that a scene has."""


def plane(probability: float) -> Limit:
    """Beyond a plane that all numbers cross alike."""
    return lambda z: -float(ndtri(probability)) - z.sum(axis=1) / np.sqrt(z.shape[1])


def circle(probability: float) -> Limit:
    """Outside a circle of two numbers."""
    return lambda z: np.sqrt(-2.0 * np.log(probability)) - np.hypot(z[:, 0], z[:, 1])


def two_sides(probability: float) -> Limit:
    """Beyond either of two planes that face each other."""
    return lambda z: -float(ndtri(0.5 * probability)) - np.abs(z.sum(axis=1)) / 2.0


def corner(probability: float) -> Limit:
    """Where two numbers are both too large."""
    return lambda z: -float(ndtri(np.sqrt(probability))) - np.minimum(z[:, 0], z[:, 1])


LIMITS = {"plane": plane, "circle": circle, "two_sides": two_sides, "corner": corner}


@dataclass(frozen=True)
class Limited(Population):
    """Switches that fail beyond a limit in their numbers."""

    limit: Limit

    def columns(self, z: Array, hold_V: Array) -> Array:
        """The numbers themselves."""
        return np.column_stack([z, hold_V])

    def reserves(self, z: Array, hold_V: float, pads: Any = None, about: Any = None) -> Array:
        """Distances from the limit, in the steps of `mesoscale.switch.reserve`."""
        low, high = np.log(LEAST_TIMES), np.log(MOST_TIMES)
        step = (high - low) / 2.0 ** np.ceil(np.log2((high - low) / STEP))
        cells = np.floor((SLOPE * self.limit(z) - low) / step)
        return low + step * (np.clip(cells, 0.0, (high - low) / step - 1.0) + 0.5)

    def failed(self, z: Array, hold_V: float, times: float) -> NDArray[np.bool_]:
        """Which are beyond the limit."""
        return SLOPE * self.limit(z) <= np.log(times)


def limited(limit: Limit, table: Any = TABLE) -> Limited:
    """Switches of a limit, some of them solved."""
    units = qmc.LatinHypercube(4, rng=0).random(SOLVED)
    return Limited(table, PLATE, CUTOFFS_NM, 0.0, known_pad, (units, []), limit)


def arguments(parser: ArgumentParser) -> None:
    """How many repetitions."""
    parser.add_argument("--repeats", type=int, default=20)
    parser.add_argument("--limits", nargs="*", default=list(LIMITS))


def rows(given: Namespace) -> Iterator[dict[str, Any]]:
    """A row for each limit and repetition, and for each level and quantile."""
    for name in given.limits:
        for seed in range(FIRST_SEED, FIRST_SEED + given.repeats):
            yield _limit_row(name, seed)
    if "plane" in given.limits:
        for level in LEVELS:
            yield from _loop_rows(level)


def _limit_row(name: str, seed: int) -> dict[str, Any]:
    started = process_time()
    switches = limited(LIMITS[name](EXACT_P))
    response = learn(switches, lambda *_: None, seed)
    found = corrected(response, 1.0, switches.hold_V, seed)
    low, high = found.low, found.high
    if found.probability:  # the ends of 90 % from those of 95 %, both of Student's t
        share = stdtrit(REPEATS - 1, 0.95) / stdtrit(REPEATS - 1, 0.975)
        low = found.probability * (found.low / found.probability) ** share
        high = found.probability * (found.high / found.probability) ** share
    return _row(name, seed, EXACT_P, found.probability, low, high, started) | {
        "by_response": found.by_response,
        "events": found.events,
        "runs": found.runs,
    }


def _loop_rows(level: float) -> Iterator[dict[str, Any]]:
    started = process_time()
    switches = limited(plane(level), VARIED)
    response = learn(switches, lambda *_: None, FIRST_SEED)
    found = quantiles_of(response.rates(1.0, switches.hold_V, seed=FIRST_SEED))
    for q, stated in found.items():
        common = ndtri(float(q)) * np.sqrt(0.5)
        exact = float(ndtr((ndtri(level) + common) / np.sqrt(0.5)))
        yield _row(
            f"loops_{q}", FIRST_SEED, exact, stated["value"], stated["low"], stated["high"], started
        ) | {"by_response": level, "events": "", "runs": ""}


def _row(
    limit: str, seed: int, exact: float, value: float, low: float, high: float, started: float
) -> dict[str, Any]:
    return {
        "limit": limit,
        "seed": seed,
        "exact": exact,
        "probability": value,
        "low": low,
        "high": high,
        "cpu_s": process_time() - started,
    }


def figures(table: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """In how many repetitions the exact probability lies in the 90 % interval, and by how much
    quantiles of a share above 1e-10 are off at most.
    """
    shown = {}
    for name in LIMITS:
        these = [row for row in table if row["limit"] == name]
        if these:
            held = [float(row["low"]) <= EXACT_P <= float(row["high"]) for row in these]
            shown[f"held_{name}"] = f"{sum(held)} of {len(held)}"
    loops = [
        row for row in table if row["limit"].startswith("loops") and float(row["exact"]) > LEAST
    ]
    if loops:
        off = [abs(np.log(float(row["probability"]) / float(row["exact"]))) for row in loops]
        shown["loops_off"] = f"{np.exp(max(off)):.1f}"
    return shown
