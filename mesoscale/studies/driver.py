"""The one driver of the studies of all stages: error against run time, and stiff and extreme cases.

Accuracy: a stage declares its numerical choices as knobs. Every value of a knob is computed on
several samples: surfaces, points, glasses or seeds, the same for all values. Its error is the root
mean square deviation from the reference over the samples, and the scatter between samples tells how
well this error is known.

Stability: a stage lists its hard cases, each with the judge that runs it. Tests run the same list.
"""

import resource
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
Progress = Callable[[float, str], None]
StudyRow = dict[str, Any]
T = TypeVar("T")


@dataclass(frozen=True)
class Quantity:
    """A number whose error is told.

    Attributes
    ----------
    name : of the number.
    unit : of the error: that of the number, or % of `scale`.
    scale : what the error is divided by, in the unit of the number; None: nothing, or with % the
        reference itself.
    volts : what an error of one unit moves in the release of the scene's switch, V; None: not
        known.
    """

    name: str
    unit: str
    scale: float | None = None
    volts: float | None = None


RELEASE = Quantity("release", "V", volts=1.0)


@dataclass(frozen=True)
class Cost:
    """Of one computation: wall and processor time (s), and the largest memory that the process held
    (MB).
    """

    wall_s: float
    cpu_s: float
    peak_rss_MB: float

    def times(self, count: float) -> "Cost":
        """Of so many such computations, one after the other."""
        return Cost(count * self.wall_s, count * self.cpu_s, self.peak_rss_MB)

    def __add__(self, other: "Cost") -> "Cost":
        """Of both, one after the other."""
        peak_MB = max(self.peak_rss_MB, other.peak_rss_MB)
        return Cost(self.wall_s + other.wall_s, self.cpu_s + other.cpu_s, peak_MB)


@dataclass(frozen=True)
class Errors:
    """Errors of one value, told by the stage itself.

    Attributes
    ----------
    error, own_error : of each quantity, shape (quantities,).
    cost : of one computation.
    """

    error: ArrayLike
    own_error: ArrayLike
    cost: Cost


@dataclass(frozen=True)
class Choice:
    """One value of a knob.

    Attributes
    ----------
    compute : the quantities on each sample, shape (samples, quantities); or their errors.
    """

    value: Any
    compute: Callable[[], ArrayLike | Errors]


@dataclass(frozen=True)
class Knob:
    """One numerical choice of a stage.

    Attributes
    ----------
    quantities : whose errors are told.
    choices : its values, cheapest first.
    shipped : the value in use; None: no single one is.
    reference : what the errors are against, in words.
    best : the reference, shape (samples, quantities) or of one sample; None: the choices tell their
        errors themselves.
    samples : what the samples are, in words with their number.
    """

    name: str
    quantities: Sequence[Quantity]
    choices: Iterable[Choice]
    shipped: Any
    reference: str
    best: Callable[[], ArrayLike] | None = None
    samples: str = ""


def rows_of(knobs: Sequence[Knob], progress: Progress | None = None) -> Iterator[StudyRow]:
    """Rows of an accuracy table without the stage: every quantity of every value of every knob."""
    for done, knob in enumerate(knobs):
        best = None if knob.best is None else np.atleast_2d(np.asarray(knob.best(), float))
        for choice in knob.choices:
            errors_of_choice = _errors_of(choice, best, knob.quantities)
            errors = np.broadcast_to(
                np.asarray(errors_of_choice.error, float), len(knob.quantities)
            )
            own_errors = np.broadcast_to(
                np.asarray(errors_of_choice.own_error, float), len(knob.quantities)
            )
            for quantity, error, own_error in zip(
                knob.quantities, errors.tolist(), own_errors.tolist(), strict=True
            ):
                volts = None if quantity.volts is None else abs(quantity.volts) * error
                yield {
                    "case": quantity.name,
                    "knob": knob.name,
                    "value": choice.value,
                    "shipped": choice.value == knob.shipped,
                    "error": error,
                    "own_error": own_error,
                    "unit": quantity.unit,
                    "release_V": volts,
                    "reference": "; ".join(filter(None, (knob.reference, knob.samples))),
                    "wall_s": round(errors_of_choice.cost.wall_s, 4),
                    "cpu_s": round(errors_of_choice.cost.cpu_s, 4),
                    "peak_rss_MB": round(errors_of_choice.cost.peak_rss_MB, 1),
                }
            if progress:
                progress((done + 0.5) / len(knobs), f"{knob.name} {choice.value}")


def _errors_of(choice: Choice, best: Array | None, quantities: Sequence[Quantity]) -> Errors:
    """The errors of a choice against the reference, or as it tells them."""
    result, cost = timed(choice.compute)
    if isinstance(result, Errors):
        return result
    assert best is not None, "a knob whose choices do not tell their errors needs a reference"
    values = np.atleast_2d(np.asarray(result, float))
    deviations = values - best
    for column, quantity in enumerate(quantities):
        if quantity.unit == "%":
            scale = np.abs(best[:, column]) if quantity.scale is None else quantity.scale
            deviations[:, column] *= 100.0 / scale
        elif quantity.scale is not None:
            deviations[:, column] /= quantity.scale
    error, own_error = root_mean_square(deviations)
    count = len(values)
    return Errors(error, own_error, cost.times(1 / count))


def root_mean_square(deviations: ArrayLike) -> tuple[Array, Array]:
    """Root mean square over samples, and its standard error by leaving out one sample at a time
    (jackknife).

    Samples without a number are left out. The standard error of a single sample is not known (NaN).

    Parameters
    ----------
    deviations : shape (samples, quantities).
    """
    values = np.asarray(deviations, float)
    errors = np.full(values.shape[1], np.nan)
    own_errors = np.full(values.shape[1], np.nan)
    for column, deviation in enumerate(values.T):
        squares = deviation[np.isfinite(deviation)] ** 2
        count = squares.size
        if count:
            errors[column] = np.sqrt(squares.mean())
        if count > 1:
            without = np.sqrt((squares.sum() - squares) / (count - 1))
            own_errors[column] = np.sqrt(
                (count - 1) / count * np.sum((without - without.mean()) ** 2)
            )
    return errors, own_errors


def timed(compute: Callable[[], T]) -> tuple[T, Cost]:
    """What is computed, and what it cost this process and its children."""
    _forget_peak()
    started = time.perf_counter()
    worked = _processor_s()
    result = compute()
    return result, Cost(time.perf_counter() - started, _processor_s() - worked, _peak_MB())


def _processor_s() -> float:
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + children.ru_utime + children.ru_stime


def _forget_peak() -> None:
    """Let the kernel count the peak of memory anew; where it does not, the peak is that of the
    process so far.
    """
    with suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5", encoding="ascii")


def _peak_MB() -> float:
    """Largest memory since `_forget_peak`."""
    with suppress(OSError):
        for line in Path("/proc/self/status").read_text(encoding="ascii").splitlines():
            if line.startswith("VmHWM:"):
                return int(line.split()[1]) / 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


@dataclass(frozen=True)
class HardCase:
    """A stiff or extreme case of a stage.

    Attributes
    ----------
    name, description : what it is, and what is hard about it.
    checks : what must hold.
    judge : runs it; whether all held, with the numbers behind the verdict. One that raises has
        failed.
    """

    name: str
    description: str
    checks: str
    judge: Callable[[], tuple[bool, str]]


def stability_rows(
    cases: Sequence[HardCase], progress: Progress | None = None
) -> Iterator[StudyRow]:
    """Rows of a stability table without the stage: every case run and timed."""
    for done, case in enumerate(cases, 1):
        verdict, cost = timed(partial(_judged, case))
        passed, detail = verdict
        yield {
            "case": case.name,
            "description": case.description,
            "checks": case.checks,
            "passed": passed,
            "detail": detail,
            "wall_s": round(cost.wall_s, 3),
            "cpu_s": round(cost.cpu_s, 3),
        }
        if progress is not None:
            progress(done / len(cases), case.name)


def _judged(case: HardCase) -> tuple[bool, str]:
    try:
        return case.judge()
    except Exception as error:  # whatever it is, it is this case's result
        return False, f"{type(error).__name__}: {' '.join(str(error).split())}"
