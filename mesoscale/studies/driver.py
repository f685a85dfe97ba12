"""The one driver of the accuracy studies: a stage declares its numerical choices as knobs, and each try is timed."""

import resource
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
Progress = Callable[[float, str], None]
StudyRow = dict[str, Any]
T = TypeVar("T")


class Try(NamedTuple):
    """One value of a knob: its error in each case, shape (cases,) or a number; wall and processor time (s)."""

    value: Any
    error: ArrayLike
    cost: Array


@dataclass(frozen=True)
class Knob:
    """One numerical choice of a stage.

    Attributes
    ----------
    metric : what the error is; one, or one of each case.
    reference : what the error is against, in words.
    tries : computed as they are asked for.
    cases : quantities whose error it is.
    """

    name: str
    metric: str | Sequence[str]
    reference: str
    tries: Iterable[Try]
    cases: Sequence[str] = ("release",)


def rows_of(knobs: Sequence[Knob], progress: Progress | None = None) -> Iterator[StudyRow]:
    """Rows of an accuracy table without the stage: every case of every value of every knob, and memory held so far."""
    for done, knob in enumerate(knobs):
        metrics = [knob.metric] * len(knob.cases) if isinstance(knob.metric, str) else knob.metric
        for value, error, cost in knob.tries:
            for case, one, metric in zip(knob.cases, np.atleast_1d(error).tolist(), metrics, strict=True):
                yield {
                    "case": case,
                    "knob": knob.name,
                    "value": value,
                    "error": one,
                    "error_metric": metric,
                    "reference": knob.reference,
                    "wall_s": round(float(cost[0]), 4),
                    "cpu_s": round(float(cost[1]), 4),
                    "peak_rss_MB": round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024, 1),
                }
            if progress:
                progress((done + 0.5) / len(knobs), f"{knob.name} {value}")


def clock() -> Array:
    """Wall and processor time (s)."""
    return np.array([time.perf_counter(), time.process_time()])


def timed(compute: Callable[[], T], repeats: int = 1) -> tuple[T, Array]:
    """What is computed, and the wall and processor time (s) of one of its repeats."""
    started = clock()
    result = compute()
    return result, (clock() - started) / repeats


def deviation(tried: Any, wanted: Any) -> ArrayLike:
    """Absolute difference of two results."""
    return np.abs(np.subtract(tried, wanted))


def compared(
    best: Callable[[], T],
    tries: Iterable[tuple[Any, Callable[[], T]]],
    error: Callable[[T, T], ArrayLike] = deviation,
    repeats: int = 1,
) -> Iterator[Try]:
    """Values with what computes each, their results compared with the best one.

    Parameters
    ----------
    error : of a result and the best one, shape (cases,) or a number.
    repeats : how many computations of one kind a try is, to state the time of one.
    """
    wanted = best()
    for value, compute in tries:
        result, cost = timed(compute, repeats)
        yield Try(value, error(result, wanted), cost)
