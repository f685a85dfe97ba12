"""Estimates with their intervals, at one level in the whole topography stage."""

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


SCATTERS = np.geomspace(0.02, 5.0, 40)
"""Standard deviations of ln C between places that are weighed against each other."""


@dataclass(frozen=True)
class PlaceScatter:
    """Standard deviation of ln C between places: what the measurements say, and what is usual.

    A few places leave their scatter uncertain, and a moment estimate is often 0. So all values
    count, each by its probability, with a half-Cauchy prior (Gelman 2006, doi:10.1214/06-BA117A).
    By it half the films have less than 0.4, RMS heights that differ by 20 %: an assumption, which
    counts where few places are measured.

    Attributes
    ----------
    weights : (len(SCATTERS),) probability of each; None where only one place is measured, of which
        nothing follows.
    """

    weights: np.ndarray | None = None

    @classmethod
    def of(cls, log_likelihood: np.ndarray) -> "PlaceScatter":
        """By ln of the likelihood (up to a constant) of each value of `SCATTERS`."""
        # even steps of the logarithm: a density over s has s times as much in each
        logs = log_likelihood + np.log(SCATTERS) - np.log1p((SCATTERS / 0.4) ** 2)
        weights = np.exp(logs - logs.max())
        return cls(weights / weights.sum())

    @property
    def deviation(self) -> float:
        """Normal standard deviation with one more place's interval; 0 for one place."""
        from scipy.special import ndtr

        if self.weights is None:
            return 0.0
        inside = 1 - 2 * ndtr(-REACH * SCATTERS[:, None] / SCATTERS) @ self.weights
        return float(np.interp(CONFIDENCE, inside, SCATTERS))

    def interval(self) -> tuple[float, float]:
        """Ends of the standard deviation."""
        if self.weights is None:
            return 0.0, 0.0
        below = np.cumsum(self.weights) - 0.5 * self.weights
        low, high = np.exp(np.interp(QUANTILES, below, np.log(SCATTERS)))
        return float(low), float(high)


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
        """The same with a further standard deviation of the value or of its logarithm."""
        centre = np.asarray(self.value)
        edges = np.asarray(self.interval)
        if log:
            centre = np.log(self.value)
            edges = np.log(self.interval)
        low = centre - np.hypot(centre - edges[0], REACH * error)
        high = centre + np.hypot(edges[1] - centre, REACH * error)
        if log:
            low = np.exp(low)
            high = np.exp(high)
        interval = (float(low), float(high))
        return Estimate(self.value, interval, union(interval, self.scatter))


def union(interval: Any, values: Any) -> tuple[float, float]:
    """Smallest range that holds the interval and all values."""
    members = [np.asarray(interval, dtype=float), np.asarray(values, dtype=float)]
    together = np.concatenate(members)
    return float(together.min()), float(together.max())
