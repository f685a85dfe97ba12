"""One spectrum of a surface over all scales, from everything that was measured on it.

Each measurement gives ln C on common bands of log q. Places differ, and so do instruments:
measurement k is the surface's spectrum f times a factor of its own, ln C_kb = f_b + a_k + error,
with a_k of an unknown variance. This mixed linear model (Henderson 1975, doi:10.2307/2529430) joins
ranges that merely overlap without a jump where one begins or ends; the variance is found by
expectation maximisation. Changes of the logarithmic slope from band to band are held small, which
carries f over a gap between instruments with an uncertainty that grows into it.

Waves about as long as the longest measurement are changed by levelling and hardly measured one by
one, but their sum is: its levelled heights have the mean square that the spectrum must give from
about 0.7 waves a side on. Where nothing is measured, the spectrum of a rough surface is flat or
falls as steeply as a self-affine one, and nothing else.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from mesoscale.topography.description.bands import (
    BANDS_PER_DECADE,
    Seen,
    at_points,
    on_bands,
    seen_by,
)
from mesoscale.topography.description.intervals import QUANTILES, REACH, SCATTERS, PlaceScatter
from mesoscale.topography.description.trusted_range import TrustedSpectrum

DRAWS = 500
EXTENSION_DECADES = 1.0
"""The last slope is carried on this far beyond what is measured."""
STATISTICS = {
    "rms_height": (0, 1.0, "nm"),
    "rms_slope": (2, 1.0, "1"),
    "rms_curvature": (4, 0.5, "1/nm"),
}
"""Power of q under the integral, factor and unit of each number of the roughness."""


@dataclass(frozen=True)
class OneSpectrum:
    """The spectrum of a surface on bands.

    Attributes
    ----------
    q : (m,) centres of the bands, 1/nm, from waves twice as long as the longest measurement on.
    log_psd : (m,) ln C of the typical place, C in nm^4.
    covariance : (m, m) of log_psd; REACH times its root is an end of the interval.
    between : scatter of ln C between places and instruments, common to all bands.
    count : (m,) measurements behind each band; 0 in a gap between instruments and before the first.
    names : measurements that take part.
    longest : smallest wave vector that a mean square height tells of (1/nm); None where only bands
        tell.
    logs : (draws, m) values of ln C that the measurements allow, where they are not normally
        distributed; else None.
    """

    q: np.ndarray
    log_psd: np.ndarray
    covariance: np.ndarray
    between: PlaceScatter
    count: np.ndarray
    names: tuple[str, ...]
    longest: float | None = None
    logs: np.ndarray | None = None

    @property
    def place_sd(self) -> float:
        """Standard deviation of ln C between places; 0 for one measurement."""
        return self.between.deviation

    @property
    def seen(self) -> float:
        """Smallest wave vector that the measurements tell of, one by one or in a sum, 1/nm."""
        return min(self.first, self.longest or np.inf)

    @property
    def psd(self) -> np.ndarray:
        """(m,) C of the typical place, nm^4."""
        return np.exp(self.log_psd)

    @property
    def log_sd(self) -> np.ndarray:
        """(m,) standard deviation of ln C of the typical place."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def first(self) -> float:
        """Smallest wave vector that is measured, 1/nm."""
        return float(self.q[self.count > 0][0])

    def band(self) -> tuple[np.ndarray, np.ndarray]:
        """(m,) lower and upper end of C of the typical place, nm^4."""
        reach = REACH * self.log_sd
        return np.exp(self.log_psd - reach), np.exp(self.log_psd + reach)

    def draws(self, places: bool, count: int = DRAWS) -> np.ndarray:
        """(count, m) possible spectra C in nm^4, of the typical place or of any place."""
        rng = np.random.default_rng(0)  # the same draws whenever they are asked for
        logs = self.logs
        if logs is None:
            logs = self._normal_draws(rng, count)
        logs = logs[:count]
        if places:
            logs = logs + self.place_sd * rng.standard_normal((count, 1))
        return np.exp(logs)

    def with_mean_square(
        self, mean_square: float, seen: Seen, count: int, common_error: float
    ) -> "OneSpectrum":
        """The spectrum, conditioned on the mean square height (nm^2) of the longest measurements.

        Of spectra that the bands allow, those are drawn that the mean square allows (importance
        resampling). Waves of the bands are in both: what chance makes of them counts once.

        Parameters
        ----------
        count : measurements that it is the mean of.
        common_error : of its logarithm, the same in all of them.
        """
        from scipy.special import gammaln

        rng = np.random.default_rng(3)
        candidates = 10_000
        logs = self._normal_draws(rng, candidates)
        drawn = np.exp(logs)
        measured = self.moment(0, low=seen.first, psd=drawn, counted=seen.share)
        long_waves = measured + self.tail(drawn)
        counted = seen.share_in_bands
        in_bands = self.moment(0, low=seen.low, high=seen.high, psd=drawn, counted=counted)
        remainder = np.maximum(long_waves - seen.common * in_bands, 1e-12)
        unseen = seen.scatter(self.q, logs, seen.first, seen.low)
        short = seen.scatter(self.q, logs, seen.low, self.q[-1])
        unseen_variance = (unseen * (long_waves - in_bands)) ** 2
        variance = unseen_variance + (1 - seen.common) * (short * in_bands) ** 2
        # half of them: the shape of a Gamma law
        modes = count * remainder**2 / (variance + (self.place_sd * remainder) ** 2)
        level, worth = np.polynomial.hermite_e.hermegauss(9)
        remaining = (
            mean_square * np.exp(np.hypot(common_error, 0.1) * level)
            - seen.common * seen.in_bands_nm2
        )
        over = np.maximum(remaining, 0.01 * mean_square) / remainder[:, None]
        modes = modes[:, None]
        gamma = modes * (np.log(modes * over) - over) - gammaln(modes) + np.log(worth)
        chance = np.logaddexp.reduce(gamma, axis=1)
        weight = np.exp(chance - chance.max())
        weight /= weight.sum()
        centre = weight @ logs
        covariance = (weight[:, None] * (logs - centre)).T @ (logs - centre)
        drawn = logs[rng.choice(candidates, size=DRAWS, p=weight)]
        return replace(self, log_psd=centre, covariance=covariance, logs=drawn, longest=seen.first)

    def with_error(self, error: np.ndarray) -> "OneSpectrum":
        """The same with a further error of ln C: `error` (m,) times one normal variable for all."""
        logs = self.logs
        if logs is not None:
            logs = logs + np.random.default_rng(5).standard_normal((len(logs), 1)) * error
        return replace(self, covariance=self.covariance + np.outer(error, error), logs=logs)

    def _normal_draws(self, rng: np.random.Generator, count: int) -> np.ndarray:
        values, vectors = np.linalg.eigh(self.covariance)
        factor = vectors * np.sqrt(np.maximum(values, 0.0))
        return self.log_psd + rng.standard_normal((count, len(self.q))) @ factor.T

    def moment(
        self,
        power: int,
        low: float = 0.0,
        high: float = np.inf,
        psd: np.ndarray | None = None,
        counted: Callable[[np.ndarray], np.ndarray] = np.ones_like,
    ) -> np.ndarray:
        """Integral of 2 pi q C q^power over low .. high (1/nm) of C (..., m), flat below q[0].

        Power 0 is the mean square height (nm^2), 2 the mean square slope, 4 that of the Laplacian
        (1/nm^2). Of the waves at q (1/nm) the share `counted` enters.
        """
        if psd is None:
            psd = self.psd
        start = float(low or self.q[0])
        end = min(high, self.q[-1])
        if end <= start:
            return np.zeros(psd.shape[:-1])
        below = 0.0
        if low == 0:  # flat below the longest wave
            below = 2 * np.pi * psd[..., 0] * start ** (power + 2) / (power + 2)
        between = self.q[(self.q > start) & (self.q < end)]
        edges = np.log([start, *between, end])
        half = np.diff(edges)[:, None] / 2
        # of a power law between two bands exact to 1e-6
        place, weight = np.polynomial.legendre.leggauss(3)
        fine = np.exp(edges[:-1, None] + half * (1 + place)).ravel()
        area = (half * weight).ravel() * 2 * np.pi * fine ** (power + 2)
        psd_fine = np.exp(at_points(fine, self.q, np.log(psd)))
        return np.asarray(psd_fine @ (area * counted(fine)) + below)

    def carried_on(self, psd: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Points (1/nm, nm^4) of a spectrum (m,), its last slope continued by a decade."""
        end = float(self.q[-1])
        extension = end * 10 ** np.linspace(0.1, EXTENSION_DECADES, 10)
        slope = self._end_slope(psd)
        continued = psd[-1] * (extension / end) ** slope
        return np.concatenate([self.q, extension]), np.concatenate([psd, continued])

    def tail(self, psd: np.ndarray) -> np.ndarray:
        """Mean square heights of the continuations of spectra (..., m), nm^2."""
        power = self._end_slope(psd) + 2.0
        grown = 10.0 ** (EXTENSION_DECADES * power) - 1.0
        return 2.0 * np.pi * psd[..., -1] * self.q[-1] ** 2 * grown / power

    def _end_slope(self, psd: np.ndarray) -> np.ndarray:
        """Logarithmic slopes of the ends of spectra (..., m), over the last 0.3 decades.

        A spectrum that ends before its power law says nothing of it: the slopes are then spread
        over all possible ones.
        """
        end = self.q > self.q[-1] * 10**-0.31
        logs = np.log(psd[..., end]).reshape(-1, np.count_nonzero(end))
        slopes = np.polyfit(np.log(self.q[end]), logs.T, 1)[0]
        # of a self-affine surface (0 < H < 1); shallower ones have no finite RMS height
        possible = (-4.0, -2.1)
        unseen = slopes > possible[1]
        count = np.count_nonzero(unseen)
        places = (np.arange(count) + 0.5) / max(count, 1)
        slopes[unseen] = np.interp(places, (0, 1), possible)
        return slopes.reshape(psd.shape[:-1])

    def statistics(self) -> dict[str, dict[str, Any]]:
        """RMS height, slope and curvature of the measured waves, with intervals.

        Curvature is half the RMS Laplacian, the mean of both principal ones.
        """
        drawn = self.draws(places=False)
        first = self.first
        result = {}
        for key, (power, factor, unit) in STATISTICS.items():
            value = factor * float(np.sqrt(self.moment(power, first)))
            possible = factor * np.sqrt(self.moment(power, first, psd=drawn))
            low, high = np.quantile(possible, QUANTILES)
            result[key] = {"value": value, "interval": [float(low), float(high)], "unit": unit}
        return result


def merge(spectra: Sequence[TrustedSpectrum], common_error: float = 0.0) -> OneSpectrum | None:
    """The spectrum behind all measurements; None where none has two bands to offer.

    Parameters
    ----------
    common_error : of ln C, the same at all waves (`tip_on_grains`).
    """
    measured = [(item.name, *on_bands(item)) for item in spectra]
    measured = [entry for entry in measured if len(entry[1])]
    if sum(len(entry[1]) for entry in measured) < 4:
        return None
    seen = np.concatenate([entry[1] for entry in measured])
    # waves twice as long as the longest measurement still tilt and bow it
    names = {entry[0] for entry in measured}
    longest = min(item.spectrum.spacing for item in spectra if item.name in names) / 2
    lowest = int(np.floor(np.log10(longest) * BANDS_PER_DECADE))
    bands = np.arange(min(seen.min(), lowest), seen.max() + 1)
    index = np.concatenate([np.searchsorted(bands, entry[1]) for entry in measured])
    values = np.concatenate([entry[2] for entry in measured])
    weight = 1 / np.concatenate([entry[3] for entry in measured])
    lengths = [len(entry[1]) for entry in measured]
    owner = np.repeat(np.arange(len(measured)), lengths)
    m = len(bands)
    places = len(measured)
    system = np.zeros((len(values), m + places))
    system[np.arange(len(values)), index] = 1.0
    system[np.arange(len(values)), m + owner] = 1.0
    normal = system.T @ (weight[:, None] * system)
    right = system.T @ (weight * values)
    # standard deviation of the change of slope times the band's width, from band to band
    bends = np.diff(np.eye(m), 2, axis=0) / 0.35
    normal[:m, :m] += bends.T @ bends
    unseen = int(np.searchsorted(bands, seen.min()))
    width = np.log(10) / BANDS_PER_DECADE
    first = min(measured, key=lambda entry: entry[1][0])
    slope, error = unseen_slope(first[1] * width, *first[2:])
    rise = np.diff(np.eye(m), axis=0)[:unseen] / width
    normal[:m, :m] += rise.T @ rise / error**2
    right[:m] += rise.sum(axis=0) * slope / error**2
    between = _between(normal, right, places)
    normal[m:, m:] += np.eye(places) / max(between.deviation, SCATTERS[0]) ** 2
    covariance = np.linalg.inv(normal)
    solution = covariance @ right
    centres = 10 ** ((bands + 0.5) / BANDS_PER_DECADE)
    covered = [(bands >= entry[1][0]) & (bands <= entry[1][-1]) for entry in measured]
    result = OneSpectrum(
        centres,
        solution[:m],
        covariance[:m, :m] + common_error**2,
        between,
        np.sum(covered, axis=0),
        tuple(entry[0] for entry in measured),
    )
    rough = [item for item in spectra if item.name in names and item.rms_nm > 0]
    seen_waves = [(item, waves) for item in rough if (waves := seen_by(item)) is not None]
    longest_nm = max((waves.length_nm for _, waves in seen_waves), default=0.0)
    # of a line that has measured these waves
    if longest_nm == 0 or result.first < 2 * np.pi / longest_nm:
        return result
    kind = next(waves for _, waves in seen_waves if waves.length_nm == longest_nm)
    alike = [
        (item, waves)
        for item, waves in seen_waves
        if waves.length_nm > 0.8 * longest_nm and waves.line == kind.line
    ]
    mean_square = np.mean([item.rms_nm**2 for item, _ in alike])
    in_bands_nm2 = np.mean([waves.in_bands_nm2 for _, waves in alike])
    kind = replace(kind, in_bands_nm2=float(in_bands_nm2))
    # what is form and what is roughness is unknown to what a parabola would take
    error = np.hypot(np.mean([item.form for item, _ in alike]), common_error)
    return result.with_mean_square(float(mean_square), kind, len(alike), float(error))


def _between(normal: np.ndarray, right: np.ndarray, places: int) -> PlaceScatter:
    """Scatter of places by the restricted likelihood of the mixed model (without bands and levels).

    Parameters
    ----------
    normal, right : normal equations of bands and, last, levels of the places, which have no prior
        yet.
    """
    if places == 1:
        return PlaceScatter()
    levels = np.diag(np.arange(len(normal)) >= len(normal) - places).astype(float)
    covariances = np.linalg.inv(normal + levels / SCATTERS[:, None, None] ** 2)
    determinants = np.linalg.slogdet(covariances)[1]
    fitted = right @ covariances @ right
    chance = determinants + fitted - 2 * places * np.log(SCATTERS)
    return PlaceScatter.of(0.5 * chance)


def unseen_slope(
    log_q: np.ndarray, log_psd: np.ndarray, variance: np.ndarray
) -> tuple[float, float]:
    """Logarithmic slope of waves longer than all measured ones, and the deviation of each band.

    Self-affine surfaces have slopes of -2 to -4 (H of 0 to 1), and go on or roll off. What is
    shallower rolls off to a plateau, of slope 0. The longest bands leave a slope uncertain, in
    which few waves are. Five bands share a slope.

    Parameters
    ----------
    log_q, log_psd, variance : ln q, ln C and the variance of ln C of the bands of the longest
        measurement.
    """
    end = slice(None, BANDS_PER_DECADE // 2)
    possible = np.linspace(-4.0, 0.0, 33)
    q = log_q[end]
    level = log_psd[end]
    weight = 1 / variance[end]
    q = q - weight @ q / weight.sum()
    precision = float(weight @ q**2)
    away = possible - np.clip(weight * q @ level / precision, -4.0, 0.0)
    chance = np.exp(-0.5 * precision * away**2)
    chance /= chance.sum()
    going_on = possible * np.interp(-possible, (1.5, 3.0), (0.0, 0.85))
    mean = float(chance @ going_on)
    deviation = chance @ ((going_on - mean) ** 2 + (0.4 - 0.25 * possible) ** 2)
    return mean, float(np.sqrt(5 * deviation))
