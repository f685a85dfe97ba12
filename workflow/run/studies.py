"""The one runner of hard cases and the one writer of accuracy rows, for the studies of all stages."""

import resource
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any

Check = tuple[str, str, str, Callable[[], tuple[bool, str]]]
"""Case, description, what is checked, and the check: whether it passed, with the detail behind it."""


def stability_rows(
    stage: str, checks: Sequence[Check], progress: Callable[[float, str], None] | None = None
) -> Iterator[dict[str, Any]]:
    """Rows of stability/<stage>.csv: every check run and timed; one that raises has failed."""
    for done, (case, description, what, check) in enumerate(checks):
        started = time.perf_counter()
        try:
            passed, detail = check()
        except Exception as error:  # whatever it is, it is this case's result
            passed, detail = False, f"{type(error).__name__}: {' '.join(str(error).split())}"
        yield {
            "stage": stage,
            "case": case,
            "description": description,
            "checks": what,
            "passed": passed,
            "detail": detail,
            "wall_s": round(time.perf_counter() - started, 3),
        }
        if progress is not None:
            progress((done + 1) / len(checks), case)


def accuracy_rows(stage: str, points: Iterable[Mapping[str, Any]]) -> Iterator[dict[str, Any]]:
    """Rows of accuracy/<stage>.csv.

    Parameters
    ----------
    points : case, knob, value, error, error_metric, reference, wall_s, cpu_s, and columns of the stage's own, of each
        value tried. peak_rss_MB is that of this process when the point is made, unless the point has it.
    """
    for point in points:
        row = {"stage": stage, **point}
        row.setdefault("peak_rss_MB", peak_rss_MB())
        yield {key: round(value, 4) if key in ("wall_s", "cpu_s") and value else value for key, value in row.items()}


def peak_rss_MB() -> float:
    """Largest memory that this process has held so far."""
    return round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024, 1)
