"""Maximum-likelihood fit of equation 9 to the spectra of several scans at once.

The mean of a spectrum over n independent modes is Gamma distributed about the true C(q) with n
degrees of freedom (Whittle's likelihood).  All scans share q0 and the slope; each has its own
amplitude, drawn from a log-normal population, because amplitudes of real places differ by far more
than their statistical error.

A line profile enters with the spectrum C1(k) along it, which is compared with what equation 9 gives
along a line. Its converted spectrum C(q) is smoothed, which rounds the knee.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from mesoscale.topography.description.intervals import SCATTERS, PlaceScatter
from mesoscale.topography.description.trusted_range import (
    TrustedSpectrum,
    blur,
    curvature,
    tip_bias,
)
from mesoscale.topography.profile_conversion import spread
from mesoscale.topography.roughness_spectrum import RoughSpectrum, mean_square

# relative error of C that no averaging removes: rest of tip, noise and window corrections, which
# act beyond the knee; on the plateau only levelling is left, and the trusted range leaves its waves
# out
DISCREPANCY, PLATEAU_DISCREPANCY = 0.04, 0.01
MAX_SLOPE = 10.0


@dataclass(frozen=True)
class LikelihoodFit:
    """Fit of equation 9 to all scans.

    Attributes
    ----------
    plateau, q0, slope : of the typical place (median of the population).
    covariance : (3, 3) of (ln plateau, ln q0, slope).
    amplitudes : (scans,) plateau of each scan, nm^4.
    between : scatter of ln amplitude between places, statistical error removed.
    dispersion : mean square residual in units of its expectation.
    misfit : RMS of the logarithmic residuals of the pooled bins beyond chance; above about 0.3 this
        is no power law.
    plateau_gain, power_gain : improvement of 2 ln L over a pure power law and over a flat spectrum.
    names : of the scans that were fitted.
    settled : the search for q0 and slope ended within its tolerance.
    """

    plateau: float
    q0: float
    slope: float
    covariance: np.ndarray
    amplitudes: np.ndarray
    between: PlaceScatter
    dispersion: float
    misfit: float
    plateau_gain: float
    power_gain: float
    names: tuple[str, ...]
    settled: bool = True

    @property
    def amplitude_sd(self) -> float:
        """Standard deviation of ln amplitude between places."""
        return self.between.deviation

    def spectrum(self, q1: float) -> RoughSpectrum:
        """The typical place's spectrum up to q1."""
        return RoughSpectrum(self.plateau, self.q0, self.slope, q1)

    def scan_rms(self, q1: float) -> np.ndarray:
        """(scans,) RMS heights in nm of the places scanned, integrated from zero to q1."""
        return np.sqrt(self.amplitudes * mean_square(1.0, self.q0, self.slope, q1))


class _Data:
    """Trusted shells of all scans and bins of all lines, flat, with the scan and bin of each."""

    def __init__(self, spectra: Sequence[TrustedSpectrum], knee: float = 0.0, per_decade: int = 12):
        columns = []
        for number, item in enumerate(spectra):
            s, ok = item.spectrum, item.trusted
            if item.line is not None:
                s = item.line
                ok = np.ones(len(item.line.q), dtype=bool)
            bins = np.floor(np.log10(s.q[ok]) * per_decade).astype(int)
            # scans of one size share their discrepancies
            size_class = round(float(np.log(s.spacing)) * 20)
            constants = (
                number,
                size_class,
                item.tip_radius_nm,
                0.0 if s.sharp else s.spacing,
                item.line is not None,
            )
            shells = int(ok.sum())
            repeated = [np.full(shells, value) for value in constants]
            columns.append([s.q[ok], s.psd[ok], s.modes[ok], bins, *repeated])
        joined = [np.concatenate(column) for column in zip(*columns, strict=True)]
        self.q, self.psd, self.modes, bins, scan, size_class, self.tip, spacing, line = joined
        with np.errstate(divide="ignore"):
            self.shell = self.q / spacing  # infinite where nothing is blurred
        self.scan = scan.astype(int)
        self.scans = len(spectra)
        _, self.bin = np.unique(np.stack([size_class, bins]), axis=1, return_inverse=True)
        self.bin = self.bin.ravel()
        per_bin = np.bincount(self.bin, self.modes)
        # weight of a bin: modes in parallel with the discrepancy, shared out in proportion to the
        # modes
        log_q_sum = np.bincount(self.bin, self.modes * np.log(self.q))
        centre = np.exp(log_q_sum / per_bin)
        discrepancy = np.where(centre < knee, PLATEAU_DISCREPANCY, DISCREPANCY)
        self.weight = self.modes / (1 + discrepancy**2 * per_bin)[self.bin]
        self.log_q = np.log(self.q)
        self.line = line.astype(bool)
        # a line's C1(k) is the integral of 2 C(q) q over t, with q = k cosh t
        end = 7.7  # arcosh(q/k) = 1100 k
        t, step = np.polynomial.legendre.leggauss(48)
        t = end * (t + 1) / 2
        step = end / 2 * step
        spacing = np.array([item.spectrum.spacing for item in spectra])
        k = spread(self.q[self.line], spacing[self.scan[self.line]])
        self.line_q = np.concatenate(k[:, :, None] * np.cosh(t), axis=1)
        self.line_log_q = np.log(self.line_q)
        self.line_weight = self.line_q * np.concatenate([step, step])
        self.per_scan = np.bincount(self.scan, self.weight, self.scans)

    def ratio(
        self, log_q0: float, slope: float, level: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """ln of the model's shape (tip's bias at `level`), and measured over modelled."""
        shape = -slope * np.maximum(self.log_q - log_q0, 0.0)
        shape += np.where(self.log_q > log_q0, blur(slope, self.shell), 0.0)
        shape -= tip_bias(curvature(self.tip, self.q, np.exp(level[self.scan] + shape)))
        if self.line.any():
            falling = -slope * np.maximum(self.line_log_q - log_q0, 0.0)
            if self.tip[self.line].any():
                amplitude = level[self.scan[self.line], None] + falling
                falling -= tip_bias(
                    curvature(self.tip[self.line, None], self.line_q, np.exp(amplitude))
                )
            along_line = np.sum(self.line_weight * np.exp(falling), axis=1)
            shape[self.line] = np.log(along_line)
        return shape, self.psd * np.exp(-shape)


def skip_blurred_shells(spectra: Sequence[TrustedSpectrum], q0: float) -> list[TrustedSpectrum]:
    """Raise the lower bound of scans that begin beyond the knee, to where the blur is small.

    On the plateau the window's blur does nothing; at the first shells of a scan too small to show
    the plateau it is large, and mixes plateau and power law.
    """
    unblurred = []
    for item in spectra:
        begins_late = item.low > q0 / 2 and not item.spectrum.sharp
        low = max(item.low, 5.0 * item.spectrum.spacing)
        unblurred.append(replace(item, low=low) if begins_late else item)
    return unblurred


def fit(
    spectra: Sequence[TrustedSpectrum], knee: float = 0.0, per_decade: int = 12
) -> LikelihoodFit | None:
    """Fit plateau, q0 and slope to the trusted ranges; None where there are too few shells to fit.

    Below `knee` (1/nm), where it is known roughly, the corrections that the discrepancy stands for
    do not act. A decade has `per_decade` bins that share one.
    """
    from scipy.optimize import minimize

    spectra = [item for item in spectra if item.trusted.sum() >= 3]
    if not spectra:
        return None
    data = _Data(spectra, knee, per_decade)
    bins = data.bin.max() + 1
    if bins < 6:
        return None

    first_shells = [item.spectrum.psd[item.trusted][:5] for item in spectra]
    level = np.array([np.log(np.median(psd)) for psd in first_shells])
    spread = 1.0  # standard deviation of ln amplitude, updated below

    low = data.log_q.min()
    high = data.log_q.max()

    def objective(parameters: np.ndarray) -> float:
        outside = max(low - parameters[0], 0.0) + max(parameters[0] - high, 0.0)
        outside += max(-parameters[1], 0.0) + max(parameters[1] - MAX_SLOPE, 0.0)
        inside = np.clip(parameters, [low, 0.0], [high, MAX_SLOPE])
        return _deviance(data, inside[0], inside[1], spread, level)[0] + 1e6 * outside

    knees = np.linspace(low, high, 14)[:-1]
    grid = [(log_q0, slope) for log_q0 in knees for slope in (1.0, 2.0, 3.0, 4.0)]
    best = np.array(min(grid, key=lambda point: objective(np.array(point))))
    dispersion = 1.0
    raw = level
    residual = np.ones(bins)
    between = PlaceScatter()
    settled = False
    for _ in range(4):
        minimum = minimize(
            objective, best, method="Nelder-Mead", options={"xatol": 1e-4, "fatol": 1e-3}
        )
        settled = bool(minimum.success)
        best = np.clip(minimum.x, [low, 0.0], [high, MAX_SLOPE])
        _, level, ratio = _deviance(data, best[0], best[1], spread, level)
        raw = np.log(np.bincount(data.scan, data.weight * ratio, data.scans) / data.per_scan)
        residual = np.bincount(data.bin, data.weight * ratio * np.exp(-raw[data.scan]))
        residual /= np.bincount(data.bin, data.weight)
        bin_weight = np.bincount(data.bin, data.weight)
        freedom = max(bins - 2 - data.scans / 2, 2)
        dispersion = float(np.sum(bin_weight * (residual - 1) ** 2) / freedom)
        between = _between(raw, max(dispersion, 1.0) / data.per_scan)
        spread = between.deviation

    scale = max(dispersion, 1.0)
    typical, typical_variance = _typical(raw, scale / data.per_scan, spread)
    covariance = _covariance(data, best, spread, level, scale, typical_variance)
    value = objective(best)
    pure = minimize(lambda p: objective(np.array([low, p[0]])), [best[1]], method="Nelder-Mead").fun
    flat = objective(np.array([best[0], 0.0]))
    return LikelihoodFit(
        plateau=float(np.exp(typical)),
        q0=float(np.exp(best[0])),
        slope=float(best[1]),
        covariance=covariance,
        amplitudes=np.exp(raw),
        between=between,
        dispersion=dispersion,
        misfit=_misfit(residual, np.bincount(data.bin, data.modes)),
        plateau_gain=float(pure - value) / scale,
        power_gain=float(flat - value) / scale,
        names=tuple(item.name for item in spectra),
        settled=settled,
    )


def _deviance(
    data: _Data, log_q0: float, slope: float, spread: float, level: np.ndarray
) -> tuple[float, np.ndarray, np.ndarray]:
    """-2 ln L, marginal over amplitudes (Gaussian); amplitudes; measured over shape."""
    shape, ratio = data.ratio(log_q0, slope, level)
    mean = np.bincount(data.scan, data.weight * ratio, data.scans) / data.per_scan
    raw = np.log(np.maximum(mean, 1e-300))
    distance = 2 * np.sum(data.weight * (shape - np.log(data.psd)))
    per_scan = distance + 2 * np.sum(data.per_scan * (1 + raw))
    variance = 1 / data.per_scan + spread**2
    typical = np.sum(raw / variance) / np.sum(1 / variance)
    # amplitudes at their own optimum cost nothing; the population pulls them together
    population = np.sum((raw - typical) ** 2 / variance)
    return float(per_scan + population), raw, ratio


def _misfit(residual: np.ndarray, modes: np.ndarray) -> float:
    """RMS of ln of the bins' residuals, less the chance of a mean over their modes (Gamma).

    Bins of few modes say little and count little.
    """
    from scipy.special import digamma, polygamma

    chance = polygamma(1, modes) + (digamma(modes) - np.log(modes)) ** 2
    excess = np.log(np.maximum(residual, 1e-12)) ** 2 - chance
    # bins in which chance makes more than 0.3 say little about the shape
    weight = 1 / (chance + 0.3**2)
    return float(np.sqrt(max(np.sum(weight * excess) / weight.sum(), 0.0)))


def _between(raw: np.ndarray, variance: np.ndarray) -> PlaceScatter:
    """Scatter between places of ln amplitudes of error `variance`, by restricted likelihood."""
    if len(raw) < 2:
        return PlaceScatter()
    variances = variance + SCATTERS[:, None] ** 2
    weights = np.sum(1 / variances, axis=1)
    mean = np.sum(raw / variances, axis=1, keepdims=True) / weights[:, None]
    squares = np.log(variances) + (raw - mean) ** 2 / variances
    terms = np.sum(squares, axis=1) + np.log(weights)
    return PlaceScatter.of(-0.5 * terms)


def _typical(raw: np.ndarray, variance: np.ndarray, spread: float) -> tuple[float, float]:
    """Mean ln amplitude of the population and its variance."""
    weight = 1 / (variance + spread**2)
    return float(np.sum(weight * raw) / weight.sum()), float(1 / weight.sum())


def _covariance(
    data: _Data,
    best: np.ndarray,
    spread: float,
    level: np.ndarray,
    scale: float,
    typical_variance: float,
) -> np.ndarray:
    """Covariance of (ln plateau, ln q0, slope) from the curvature of the deviance."""
    steps = np.array([0.05, 0.03])

    def value(point: np.ndarray) -> tuple[float, float]:
        total, raw, _ = _deviance(data, point[0], point[1], spread, level)
        return total, _typical(raw, scale / data.per_scan, spread)[0]

    centre = value(best)[0]
    hessian = np.zeros((2, 2))
    gradient = np.zeros(2)
    for i in range(2):
        up = best.copy()
        down = best.copy()
        up[i] += steps[i]
        down[i] -= steps[i]
        (f_up, l_up) = value(up)
        (f_down, l_down) = value(down)
        hessian[i, i] = (f_up + f_down - 2 * centre) / steps[i] ** 2
        gradient[i] = (l_up - l_down) / (2 * steps[i])
    signs = ((1, 1), (1, -1), (-1, 1), (-1, -1))
    corners = [value(best + steps * np.array(sign))[0] for sign in signs]
    twist = corners[0] - corners[1] - corners[2] + corners[3]
    hessian[0, 1] = hessian[1, 0] = twist / (4 * steps.prod())
    values, vectors = np.linalg.eigh(hessian / (2 * scale))
    shape = vectors @ np.diag(1 / np.maximum(values, 1e-6)) @ vectors.T
    full = np.zeros((3, 3))
    full[1:, 1:] = shape
    full[0, 1:] = full[1:, 0] = gradient @ shape
    full[0, 0] = typical_variance + gradient @ shape @ gradient
    return full


def q0_interval(
    spectra: Sequence[TrustedSpectrum], fitted: LikelihoodFit, reach: float
) -> tuple[float, float]:
    """Ends of q0 (1/nm) where the deviance, lowest over the slope, rises by `reach` deviations.

    The curvature at the minimum does not do: where the knee is gradual (shallow spectra, lines) the
    deviance is far from a parabola, and its ends are up to three times as far away on one side.
    """
    from scipy.optimize import brentq, minimize_scalar

    data = _Data([item for item in spectra if item.trusted.sum() >= 3], fitted.q0)
    level = np.log(fitted.amplitudes)
    best = np.log(fitted.q0)

    def lowest(log_q0: float) -> float:
        slopes = max(fitted.slope - 1.0, 0.0), min(fitted.slope + 1.0, MAX_SLOPE)

        def at_slope(slope: float) -> float:
            return _deviance(data, log_q0, slope, fitted.amplitude_sd, level)[0]

        minimum: Any = minimize_scalar(
            at_slope, bounds=slopes, method="bounded", options={"xatol": 1e-3}
        )
        return float(minimum.fun)

    allowed = lowest(best) + reach**2 * max(fitted.dispersion, 1.0)
    # no plateau within a factor of e^10 is none
    bounds = []
    step = 0.04
    furthest = 10.0
    for side in (-1, 1):
        distance = step
        while lowest(best + side * distance) < allowed and distance < furthest:
            distance *= 2
        if distance >= furthest:
            bounds.append(best + side * furthest)
            continue
        start = distance / 2 if distance > step else 0.0
        end: Any = brentq(
            lambda away, s=side: lowest(best + s * away) - allowed, start, distance, xtol=2e-3
        )
        bounds.append(best + side * end)
    return float(np.exp(bounds[0])), float(np.exp(bounds[1]))


def single_scans(
    spectra: Sequence[TrustedSpectrum], fitted: LikelihoodFit
) -> tuple[np.ndarray, np.ndarray]:
    """q0 of each scan with a knee (at the common slope), slope of each that falls far enough.

    Their range is the scatter between places; it includes the statistical error of single scans.
    """
    log_q0 = np.log(fitted.q0)
    knees = []
    slopes = []
    for item in spectra:
        if item.trusted.sum() < 3:
            continue
        data = _Data([item])
        level = np.array([np.log(fitted.plateau)])

        if item.low < fitted.q0 / 2 and item.high > 1.5 * fitted.q0:
            single = partial(_single_deviance, data, level, slope=fitted.slope)
            knee = _lowest(single, log_q0, 1.0)
            knees.append(float(np.exp(knee)))
        if item.high > 2.2 * max(fitted.q0, item.low):
            single = partial(_single_deviance, data, level, log_q0)
            slopes.append(_lowest(single, fitted.slope, 2.0))
    return np.array(knees), np.array(slopes)


def _single_deviance(data: _Data, level: np.ndarray, log_q0: float, slope: float) -> float:
    """Deviance of one scan whose amplitude (ln) is fitted alone."""
    return _deviance(data, log_q0, slope, 0.0, level)[0]


def _lowest(function: Callable[[float], float], centre: float, reach: float) -> float:
    """Minimum of a function of one variable within `reach` of `centre`."""
    from scipy.optimize import minimize_scalar

    minimum: Any = minimize_scalar(
        function, bounds=(centre - reach, centre + reach), method="bounded"
    )
    return float(minimum.x)
