"""Estimates with their intervals: the level of all of them in the topography stage, and how far they reach."""

from dataclasses import dataclass
from typing import Any

import numpy as np

CONFIDENCE = 0.9
QUANTILES = ((1 - CONFIDENCE) / 2, (1 + CONFIDENCE) / 2)
REACH = 1.6448536269514722
"""Half an interval of a normal distribution over its standard deviation."""


def student_reach(freedom: float) -> float:
    """The same of Student's distribution."""
    from scipy.special import stdtrit

    return float(stdtrit(freedom, 0.5 + CONFIDENCE / 2))


def few_places(count: int) -> float:
    """How much further than a normal distribution one reaches whose scatter is estimated from `count` places."""
    return student_reach(count - 1) / REACH if count > 1 else 1.0


@dataclass(frozen=True)
class Estimate:
    """A parameter with its confidence interval and its scatter between scans."""

    value: float
    interval: tuple[float, float]
    scatter: tuple[float, float]

    def plain(self) -> dict[str, Any]:
        """As a result file has it."""
        return {"value": self.value, "interval": list(self.interval), "scatter": list(self.scatter)}

    def widened(self, error: float, log: bool) -> "Estimate":
        """The same with a further error (standard deviation) of the value, or of its logarithm, in quadrature."""
        centre, ends = (np.log(v) if log else np.asarray(v) for v in (self.value, self.interval))
        low, high = (
            centre - np.hypot(centre - ends[0], REACH * error),
            centre + np.hypot(ends[1] - centre, REACH * error),
        )
        interval = (float(np.exp(low)), float(np.exp(high))) if log else (float(low), float(high))
        return Estimate(self.value, interval, union(interval, self.scatter))


def union(interval: Any, values: Any) -> tuple[float, float]:
    """Smallest range that holds the interval and all values."""
    every = np.concatenate([np.asarray(interval, dtype=float), np.asarray(values, dtype=float)])
    return float(every.min()), float(every.max())
