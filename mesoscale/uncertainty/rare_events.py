"""Probabilities of rare events, down to one in a million, from few runs of a model.

The model gives a reserve: the event happens where it is not above a threshold. A Gaussian process
learns the reserve where the event is likely. With its mean m and deviation d at a point z, the
event happens there with the chance pi = Phi((threshold - m) / d). Then, exactly,

    p = E[pi] x E_h[event / pi],   h proportional to pi times the distribution of z

Subset simulation (Au and Beck, Prob. Eng. Mech. 16 (2001) 263) gives the first factor and points
from h. One run of it states half of its own scatter, because the points of its chains are alike; so
several independent runs are made, and the scatter between them counts. Runs of the model at points
from h give the second factor, which corrects the process (Dubourg, Sudret and Deheeger, Prob. Eng.
Mech. 33 (2013) 47). It is near 1 with a small scatter where the process is good.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr

from mesoscale.extras import needs
from mesoscale.uncertainty.likeliest_process import likeliest

Array = NDArray[np.float64]

SAMPLES, REPEATS = 2000, 16
"""Points of each level of subset simulation, and its independent runs: a probability of 1e-6 beyond
a plane is then known to 12 %. Outside a circle single runs scatter by as much as their mean. There
a mean of eight that is low states a small scatter, too (python -m evidence failure.limits).
"""
CONFIDENCE = 0.95
LEAST = 1e-10
"""Smallest probability that is looked for."""
BLOCK = 20_000
"""Points at which a process is evaluated at once: some 30 MB."""
FARTHEST = 6.5
"""Deviations from the middle beyond which an event is rarer than `LEAST`."""
ANOTHER_SEED = 1_000_003
"""Added to the seed of a run that stops by rounding."""
PLANES = 3
"""Planes that are fitted in turn to a reserve, each about the event of the one before."""


class Process:
    """A Gaussian process through runs of a model, with a trend of first degree and noise.

    Parameters
    ----------
    x : points of the runs, shape (m, k); columns that do not vary are left out.
    y : values, shape (m,).

    Raises
    ------
    InputError : the likeliest process was not found.
    """

    def __init__(self, x: Array, y: Array):
        self.low = x.min(axis=0)
        self.width = np.ptp(x, axis=0)
        scaled = self._scaled(x)
        process = likeliest(scaled, y)
        self.lengths = process.lengths
        self.runs = scaled / self.lengths
        self.amplitude = process.amplitude
        self.noise = process.noise
        noisy = _correlation(self.runs, self.runs) + self.noise * np.eye(len(y))
        self.inverse = np.linalg.inv(noisy)
        trend = _trend(scaled)
        self.by_trend = self.inverse @ trend
        self.of_slopes = np.linalg.inv(trend.T @ self.by_trend)
        self.slopes = self.of_slopes @ (self.by_trend.T @ y)
        self.weights = self.inverse @ (y - trend @ self.slopes)

    def _scaled(self, x: Array) -> Array:
        used = self.width > 0
        return 2.0 * (x[:, used] - self.low[used]) / self.width[used] - 1.0

    def __call__(self, x: Array) -> tuple[Array, Array]:
        """Mean and deviation at points (m, k), shape (m,) each, with the noise of a run."""
        blocks = [self._block(part) for part in np.array_split(x, len(x) // BLOCK + 1)]
        means, deviations = zip(*blocks, strict=True)
        return np.concatenate(means), np.concatenate(deviations)

    def _block(self, x: Array) -> tuple[Array, Array]:
        # universal kriging: Rasmussen and Williams, Gaussian Processes (2006), eqs. 2.41 and 2.42
        scaled = self._scaled(x)
        correlation = _correlation(scaled / self.lengths, self.runs)
        trend = _trend(scaled)
        mean = trend @ self.slopes + correlation @ self.weights
        untold = trend - correlation @ self.by_trend
        variance = 1.0 + self.noise - ((correlation @ self.inverse) * correlation).sum(axis=1)
        variance += ((untold @ self.of_slopes) * untold).sum(axis=1)
        return mean, self.amplitude * np.sqrt(np.maximum(variance, 0.0))


def _trend(scaled: Array) -> Array:
    return np.column_stack([np.ones(len(scaled)), scaled])


def _correlation(first: Array, second: Array) -> Array:
    """Matern's with exponent 5/2, between places in units of its lengths."""
    squares = (first**2).sum(axis=1)[:, None] + (second**2).sum(axis=1) - 2.0 * first @ second.T
    distances = np.sqrt(5.0 * np.maximum(squares, 0.0))
    return (1.0 + distances + distances**2 / 3.0) * np.exp(-distances)


@dataclass(frozen=True)
class Sampled:
    """The event by a response.

    Attributes
    ----------
    estimates : E[pi] by each of the independent runs, shape (runs,).
    points : points from h, shape (m, n); none where the event is not met.
    chance : pi at these points.
    """

    estimates: Array
    points: Array
    chance: Array

    @property
    def probability(self) -> float:
        """E[pi]."""
        return float(self.estimates.mean())

    @property
    def variation(self) -> float:
        """Coefficient of variation of the probability between the runs; 0 of one run."""
        if self.estimates.size < 2 or not self.estimates.any():
            return 0.0
        relative = self.estimates.std(ddof=1) / self.estimates.mean()
        return float(relative / np.sqrt(self.estimates.size))

    def interval(self, confidence: float = CONFIDENCE) -> tuple[float, float]:
        """Interval of the probability by the response."""
        return _interval(self.probability, self.variation, self.estimates.size - 1, confidence)


def _interval(
    value: float, variation: float, freedom: int, confidence: float
) -> tuple[float, float]:
    """Interval of a lognormal estimate, its variation known with so many degrees of freedom."""
    from scipy.special import stdtrit  # Student's quantile

    factor = stdtrit(max(freedom, 1), 0.5 + 0.5 * confidence)
    spread = float(np.exp(factor * np.sqrt(np.log1p(variation**2))))
    return value / spread, min(value * spread, 1.0)


Moments = Callable[[Array], tuple[Array, Array]]
"""Mean and deviation (m,) of the reserve at standard normal points (m, n)."""


def sample_event(
    moments: Moments,
    dimension: int,
    threshold: float,
    seed: int,
    samples: int = SAMPLES,
    repeats: int = REPEATS,
) -> Sampled:
    """Subset simulation of: mean + deviation x (standard normal) is not above the threshold.

    Parameters
    ----------
    samples : points of each level.
    repeats : independent runs.
    """
    runs = [
        _simulate(moments, dimension, threshold, seed * REPEATS + k, samples)
        for k in range(repeats)
    ]
    estimates = np.array([probability for probability, _ in runs])
    if not estimates.any():
        return Sampled(estimates, np.empty((0, dimension)), np.empty(0))
    # of each run so many as its share of the probability
    rng = np.random.default_rng(np.random.SeedSequence([seed, 0x5A]))
    counts = [round(samples * share) for share in (estimates / estimates.sum()).tolist()]
    drawn = []
    for (_, likely), count in zip(runs, counts, strict=True):
        if count and len(likely):
            drawn.append(rng.choice(likely, count))
    points = np.concatenate(drawn)
    mean, deviation = moments(points)
    return Sampled(estimates, points, ndtr((threshold - mean) / deviation))


def _simulate(
    moments: Moments, dimension: int, threshold: float, seed: int, samples: int
) -> tuple[float, Array]:
    """Probability and points of one run of subset simulation; 0 and none without an event."""
    with needs("uncertainty"):
        import openturns as ot

    def reserve(sample: Any) -> Array:
        z = np.array(sample)
        mean, deviation = moments(z[:, :-1])
        return (mean + deviation * z[:, -1])[:, None]

    ot.RandomGenerator.SetSeed(seed)
    inputs = ot.RandomVector(ot.Normal(dimension + 1))
    function = ot.PythonFunction(dimension + 1, 1, func_sample=reserve)
    event = ot.ThresholdEvent(
        ot.CompositeRandomVector(function, inputs), ot.LessOrEqual(), threshold
    )
    subset = ot.SubsetSampling(event)
    subset.setMaximumOuterSampling(4)
    subset.setBlockSize(samples // 4)
    subset.setMinimumProbability(LEAST)
    subset.setKeepSample(True)
    try:
        subset.run()
    except RuntimeError as error:
        if "too small" not in str(error):
            raise
        return 0.0, np.empty((0, dimension))
    except TypeError as error:
        # OpenTURNS stops where rounding puts its own variance below 0: with other numbers it runs
        if "variance estimate" not in str(error):
            raise
        return _simulate(moments, dimension, threshold, seed + ANOTHER_SEED, samples)
    last = subset.getStepsNumber() - 1
    sample = np.array(subset.getInputSample(last, ot.SubsetSampling.EVENT1))
    points = sample.reshape(-1, dimension + 1)[:, :-1]
    return float(subset.getResult().getProbabilityEstimate()), points


def rates_given(
    moments: Moments,
    common: NDArray[np.bool_],
    threshold: float,
    seed: int,
    draws: int = 400,
    inner: int = 100,
) -> Array:
    """Probability of the event by what is common to all devices, per draw of it, (draws,).

    The error of the response is one unknown for all devices too: each draw has its own, mean +
    deviation x (a standard normal number). The numbers of each device are drawn about the likeliest
    event, which planes through their reserves find, and count with their likelihood (importance
    sampling; Rackwitz and Fiessler, Comput. Struct. 9 (1978) 489).

    Parameters
    ----------
    common : which of the numbers z are, shape (n,); if all are, rates are 0 or 1.
    inner : draws of what differs between devices.
    """
    rng = np.random.default_rng(np.random.SeedSequence([seed, 0x2100]))
    shared = rng.normal(size=(draws, 1, common.size))
    error = rng.normal(size=(draws, 1))

    def reserve(x: Array) -> Array:
        z = np.tile(shared, (1, x.shape[1], 1))
        z[..., ~common] = x
        mean, deviation = moments(z.reshape(-1, common.size))
        mean = mean.reshape(x.shape[:2])
        deviation = deviation.reshape(x.shape[:2])
        return mean + deviation * error - threshold

    if common.all():
        single = reserve(np.empty((draws, 1, 0)))
        return (single[:, 0] <= 0.0).astype(float)
    differing = int((~common).sum())
    likeliest = np.zeros((draws, 1, differing))
    for _ in range(PLANES):
        around = rng.normal(size=(draws, inner, differing))
        likeliest = _likeliest(likeliest, around, reserve(likeliest + around))
    x = likeliest + rng.normal(size=(draws, 2 * inner, differing))
    # density of z about 0 over that about the likeliest event
    moved = (x * likeliest).sum(axis=-1)
    weight = np.exp(0.5 * (likeliest**2).sum(axis=-1) - moved)
    fails = reserve(x) <= 0.0
    return np.minimum((weight * fails).mean(axis=1), 1.0)


def _likeliest(centre: Array, around: Array, reserves: Array) -> Array:
    """The likeliest event of each draw: where a plane through reserves is 0 nearest to the middle.

    Parameters
    ----------
    centre : about which the plane is fitted, shape (draws, 1, n).
    around : places relative to it, shape (draws, inner, n).
    reserves : at these places, shape (draws, inner).
    """
    ones = np.ones((*around.shape[:2], 1))
    inverse = np.linalg.pinv(np.concatenate([ones, around], axis=2))
    fitted = (inverse @ reserves[..., None])[..., 0]
    level = fitted[:, :1]
    slope = fitted[:, None, 1:]
    steepness = np.maximum(np.linalg.norm(slope, axis=-1), 1e-9)
    distance = (level - (slope * centre).sum(axis=-1)) / steepness
    return -(np.clip(distance, 0.0, FARTHEST) / steepness)[..., None] * slope


def quantiles_of(
    rates: Array, probabilities: Sequence[float] = (0.05, 0.5, 0.95)
) -> dict[str, dict[str, float]]:
    """Quantiles of rates, each between the order statistics that hold it with 95 %."""
    spread = 1.96 * np.sqrt([q * (1.0 - q) / rates.size for q in probabilities])
    result = {}
    for q, error in zip(probabilities, spread.tolist(), strict=True):
        orders = np.clip([q, q - error, q + error], 0.0, 1.0)
        value, low, high = np.quantile(rates, orders).tolist()
        result[f"{q:g}"] = {"value": value, "low": low, "high": high}
    return result


@dataclass(frozen=True)
class Corrected:
    """Probability of an event by a response that runs of the model correct.

    Attributes
    ----------
    probability, low, high : with its 95 % interval.
    variation : coefficient of variation.
    scatter : part of it by the runs of the model.
    by_response : probability by the response alone.
    runs, events : runs of the model, and those in which the event happened.
    """

    probability: float
    low: float
    high: float
    variation: float
    scatter: float
    by_response: float
    runs: int
    events: int


def correct(
    sampled: Sampled, happened: NDArray[np.bool_], chance: Array, confidence: float = CONFIDENCE
) -> Corrected:
    """The probability from runs of the model at points from h.

    Parameters
    ----------
    happened : whether the event happened at each, shape (m,); an event by a response that is not
        met has no runs.
    chance : pi of the runs, shape (m,).
    """
    if not happened.size:
        return Corrected(0.0, 0.0, LEAST, 0.0, 0.0, sampled.probability, 0, 0)
    factors = happened / chance
    mean = float(factors.mean())
    runs = happened.size
    events = int(happened.sum())
    if not events:  # fewer than three times one in so many runs, by 95 %
        return Corrected(
            0.0, 0.0, 3.0 / runs * sampled.probability, 0.0, 0.0, sampled.probability, runs, 0
        )
    # one more run that differs keeps the scatter of few runs from being none
    deviation = float(np.std(np.append(factors, 0.0), ddof=1))
    scatter = deviation / mean / np.sqrt(runs)
    variation = float(np.hypot(scatter, sampled.variation))
    value = mean * sampled.probability
    low, high = _interval(value, variation, sampled.estimates.size - 1, confidence)
    return Corrected(value, low, high, variation, scatter, sampled.probability, runs, events)
