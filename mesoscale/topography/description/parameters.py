"""Roughness parameters of a set of scans: q0, q1, slope, Hurst exponent and RMS, with ranges and a gate."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from mesoscale.settings import TopographySettings
from mesoscale.topography.description import likelihood, line_fits
from mesoscale.topography.description.confidence import REACH, student_reach
from mesoscale.topography.description.doubts import Doubt
from mesoscale.topography.description.likelihood import LikelihoodFit
from mesoscale.topography.description.line_fits import LineFit
from mesoscale.topography.description.trusted_range import TrustedSpectrum
from mesoscale.topography.roughness_spectrum import Convention, hurst_from_slope, mean_square

MAX_MISFIT = 0.3  # RMS logarithmic residual of pooled bins above which equation 9 does not describe them
MIN_GAIN = 12.0  # improvement of 2 ln L that a plateau or a power law must bring
# standard deviation of ln C between measurements; where RMS heights of places scatter by 40 % it is 0.8
MOST_APART = 1.5
MIN_SPAN = 2.5  # the trusted range must reach this multiple of q0


@dataclass(frozen=True)
class Estimate:
    """A parameter with its confidence interval and its scatter between scans."""

    value: float
    interval: tuple[float, float]
    scatter: tuple[float, float]

    def plain(self) -> dict[str, Any]:
        """As a result file has it."""
        return {"value": self.value, "interval": list(self.interval), "scatter": list(self.scatter)}


@dataclass(frozen=True)
class Topography:
    """Everything known about the roughness of a set of scans.

    Attributes
    ----------
    likelihood, line_fit : the two fits; None where impossible.
    q1, q1_limited : end of the power law (1/nm), or of what the finest trusted scan resolves.
    cutoff : wave vector up to which RMS heights are integrated: the finest Nyquist wave vector, 1/nm.
    estimates : q0 (1/nm), slope, hurst, rms (nm) of the method in use; empty where not identifiable.
    doubts : why the parameters of eq. 9 should not be used; none when they describe the surface.
    """

    likelihood: LikelihoodFit | None
    line_fit: LineFit | None
    q1: float
    q1_limited: bool
    cutoff: float
    estimates: dict[str, Estimate]
    doubts: tuple[Doubt, ...]

    @property
    def reasons(self) -> tuple[str, ...]:
        """The doubts in words."""
        return tuple(doubt.text for doubt in self.doubts)


def analyse(spectra: Sequence[TrustedSpectrum], settings: TopographySettings) -> Topography:
    """Parameters of the surface behind the trusted spectra of its scans."""
    cutoff = max((item.spectrum.nyquist for item in spectra), default=0.0)
    fitted = likelihood.fit(spectra)
    if fitted is not None:
        spectra = likelihood.skip_blurred_shells(spectra, fitted.q0)
        fitted = likelihood.fit(spectra, knee=fitted.q0) or fitted
    line_fit = line_fits.fit_lines(spectra)
    doubts = _doubts(spectra, fitted, line_fit, settings)
    estimates: dict[str, Estimate] = {}
    if fitted is not None and fitted.misfit > MAX_MISFIT:
        estimates = _separate_estimates(spectra, cutoff, settings)
    elif settings.method == "likelihood" and fitted is not None:
        estimates = _likelihood_estimates(spectra, fitted, cutoff, settings)
    elif settings.method == "lines" and line_fit is not None:
        estimates = _line_estimates(spectra, line_fit, cutoff, settings)
    q1 = line_fit.q1 if line_fit else max((item.high for item in spectra), default=0.0)
    limited = line_fit.q1_limited if line_fit else True
    return Topography(fitted, line_fit, q1, limited, cutoff, estimates, doubts)


def inputs(topography: Topography, settings: TopographySettings) -> dict[str, dict[str, Any]]:
    """Distributions of q0, hurst and rms for Table 1: uniform over the range the settings ask for."""
    rows: dict[str, dict[str, Any]] = {}
    for name in ("q0", "hurst", "rms"):
        if name in topography.estimates:
            low, high = getattr(topography.estimates[name], settings.ranges)
            rows[name] = {"distribution": "uniform", "a": low, "b": high}
    return rows


def _doubts(
    spectra: Sequence[TrustedSpectrum],
    fitted: LikelihoodFit | None,
    line_fit: LineFit | None,
    settings: TopographySettings,
) -> tuple[Doubt, ...]:
    """Why the parameters are not identifiable or not to be trusted, in words with numbers."""
    if fitted is None:
        text = "not identifiable: too few wave vectors between the scan's size and what the instrument resolves"
        return (Doubt("too_few_waves", text, "scan more pixels or a larger area, or state a sharper tip", fatal=True),)
    doubts = []
    highest = max(item.high for item in spectra)
    lowest = min(item.low for item in spectra)
    if fitted.power_gain < MIN_GAIN or fitted.slope < 0.5:
        text = "not identifiable: no power law, the spectrum is flat (noise, or pixels too coarse)"
        doubts.append(Doubt("flat_spectrum", text, "scan with less noise and finer pixels", "slope", fatal=True))
    if fitted.plateau_gain < MIN_GAIN or fitted.q0 < 1.2 * lowest:
        text = f"q0 is not identifiable: no plateau down to {lowest:.2g} /nm; add scans of a larger area"
        doubts.append(Doubt("no_plateau", text, "add scans of a larger area", "q0"))
    if highest < MIN_SPAN * fitted.q0:
        text = (
            f"slope is not identifiable: the trusted range ends at {highest:.2g} /nm, less than "
            f"{MIN_SPAN:g} times q0 ({fitted.q0:.2g} /nm); add finer scans or use a sharper tip"
        )
        doubts.append(Doubt("short_range", text, "add finer scans or use a sharper tip", "slope"))
    if fitted.misfit > MAX_MISFIT:
        text = (
            f"no plateau with a power law common to the scans: the fit misses the spectra by a factor "
            f"{np.exp(fitted.misfit):.2g} (RMS); the ranges are those of the scans, each on its own"
        )
        doubts.append(Doubt("no_common_power_law", text, "use the measured spectrum (topography.description)"))
    if fitted.amplitude_sd > MOST_APART:
        text = (
            f"no level common to the measurements: about a power law of one shape their C scatters by a factor of "
            f"{np.exp(fitted.amplitude_sd):.2g} (standard deviation)"
        )
        remedy = "use the measured spectrum (topography.description), check units and height scales"
        doubts.append(Doubt("levels_differ", text, remedy, "rms"))
    hurst = hurst_from_slope(fitted.slope, settings.convention)
    if not 0 < hurst < 1:
        other: Convention = "profile" if settings.convention == "areal" else "areal"
        inside = 0 < hurst_from_slope(fitted.slope, other) < 1
        hint = f" (with topography.convention and contact.reading.convention: {other} it is in)" if inside else ""
        text = f"H = {hurst:.2f} is outside 0 ... 1 in convention {settings.convention}{hint}"
        doubts.append(Doubt("hurst_outside", text, "use the measured spectrum (topography.description)", "slope"))
    if settings.method == "lines" and line_fit is None:
        text = "not identifiable by line fits: no plateau followed by a power law"
        doubts.append(Doubt("no_line_fit", text, "set topography.method to likelihood"))
    return tuple(doubts)


def _likelihood_estimates(
    spectra: Sequence[TrustedSpectrum], fitted: LikelihoodFit, cutoff: float, settings: TopographySettings
) -> dict[str, Estimate]:
    centre = np.array([np.log(fitted.plateau), np.log(fitted.q0), fitted.slope])
    error = np.minimum(np.sqrt(np.diag(fitted.covariance)), 10.0)  # unidentified: a factor of e^10 is wide enough
    reach = REACH
    q0_interval = likelihood.q0_interval(spectra, fitted, reach)
    slope_interval = tuple(centre[2] + reach * error[2] * np.array([-1, 1]))

    def log_rms(at: np.ndarray) -> float:
        return 0.5 * float(np.log(mean_square(np.exp(at[0]), np.exp(at[1]), at[2], cutoff)))

    step = 1e-4
    gradient = np.array([(log_rms(centre + step * e) - log_rms(centre - step * e)) / (2 * step) for e in np.eye(3)])
    rms_error = min(float(np.sqrt(gradient @ fitted.covariance @ gradient)), 10.0)
    rms = float(np.exp(log_rms(centre)))
    if fitted.amplitude_sd > 0:  # the typical place is then the mean of few: Student's distribution
        reach = student_reach(max(len(fitted.amplitudes) - 1, 1))
    rms_interval = tuple(rms * np.exp(reach * rms_error * np.array([-1, 1])))
    own_q0, own_slope = likelihood.single_scans(spectra, fitted)
    own_rms = fitted.scan_rms(cutoff)
    # where places differ, the range of RMS is theirs; otherwise it is the statistical one
    rms_scatter = _union([rms], own_rms) if fitted.amplitude_sd > 0 else _union(rms_interval, own_rms)
    return _with_hurst(
        q0=Estimate(fitted.q0, q0_interval, _union(q0_interval, own_q0)),
        slope=Estimate(fitted.slope, _pair(slope_interval), _union(slope_interval, own_slope)),
        rms=Estimate(rms, _pair(rms_interval), rms_scatter),
        settings=settings,
    )


def _separate_estimates(
    spectra: Sequence[TrustedSpectrum], cutoff: float, settings: TopographySettings
) -> dict[str, Estimate]:
    """Scans that share no spectrum: each described alone; values are means, every range is the scans'."""
    fits = [fitted for item in spectra if (fitted := likelihood.fit([item])) is not None]
    if not fits:
        return {}
    heights = np.array([item.rms_nm for item in spectra])
    q0 = np.array([fitted.q0 for fitted in fits])
    slope = np.array([fitted.slope for fitted in fits])

    def estimate(values: np.ndarray, errors: np.ndarray, log: bool) -> Estimate:
        middle = float(np.exp(np.mean(np.log(values)))) if log else float(np.mean(values))
        reach = REACH * errors
        low, high = (values * np.exp(-reach), values * np.exp(reach)) if log else (values - reach, values + reach)
        around = (float(low.min()), float(high.max()))
        return Estimate(middle, around, around)

    q0_error = np.array([np.sqrt(fitted.covariance[1, 1]) for fitted in fits])
    slope_error = np.array([np.sqrt(fitted.covariance[2, 2]) for fitted in fits])
    return _with_hurst(
        q0=estimate(q0, q0_error, log=True),
        slope=estimate(slope, slope_error, log=False),
        rms=estimate(heights, np.full(len(heights), 0.05), log=True),  # levelling takes up to 5 %
        settings=settings,
    )


def _line_estimates(
    spectra: Sequence[TrustedSpectrum], fitted: LineFit, cutoff: float, settings: TopographySettings
) -> dict[str, Estimate]:
    """Intervals by jackknife over scans; scatter by the lines that bound the points (the paper's way)."""
    values = np.array([np.log(fitted.q0), fitted.slope, np.log(fitted.rms(cutoff))])
    left_out = []
    for k in range(len(spectra)):
        other = line_fits.fit_lines([item for i, item in enumerate(spectra) if i != k])
        if other is not None:
            left_out.append([np.log(other.q0), other.slope, np.log(other.rms(cutoff))])
    n = len(left_out)
    error = np.full(3, np.inf)
    if n >= 2:
        error = np.sqrt((n - 1) / n * np.sum((np.array(left_out) - np.mean(left_out, axis=0)) ** 2, axis=0))
    reach = np.zeros(3)  # one scan says nothing about scatter between scans
    if n >= 2:
        freedom = _decisive(np.array(left_out))
        reach = np.array([student_reach(k) for k in freedom]) * error
    low, high = values - reach, values + reach
    level = np.sqrt(np.array([fitted.plateau_low, fitted.plateau_high]) / fitted.plateau) * fitted.rms(cutoff)
    intervals = [
        _pair((np.exp(low[0]), np.exp(high[0]))),
        _pair((low[1], high[1])),
        _pair((np.exp(low[2]), np.exp(high[2]))),
    ]
    return _with_hurst(
        q0=Estimate(fitted.q0, intervals[0], _union(intervals[0], [fitted.q0, fitted.departure])),
        slope=Estimate(fitted.slope, intervals[1], _union(intervals[1], [fitted.slope_low, fitted.slope_high])),
        rms=Estimate(fitted.rms(cutoff), intervals[2], _union(intervals[2], level)),
        settings=settings,
    )


def _decisive(left_out: np.ndarray) -> np.ndarray:
    """Degrees of freedom of a jackknife in which few scans decide, from the estimates (n, k) without each scan.

    Satterthwaite's, (sum s^2)^2 / sum s^4 for contributions of variance s^2. For normal d of variance s^2 the mean of
    3 (sum d^2)^2 is 3 (sum s^2)^2 + 6 sum s^4, that of sum d^4 is 3 sum s^4: hence the 3 and the 2.
    """
    square = (left_out - left_out.mean(axis=0)) ** 2
    fourth = np.maximum(np.sum(square**2, axis=0), 1e-300)
    return np.clip(3 * np.sum(square, axis=0) ** 2 / fourth - 2, 1, len(left_out) - 1)


def _with_hurst(q0: Estimate, slope: Estimate, rms: Estimate, settings: TopographySettings) -> dict[str, Estimate]:
    def convert(pair: tuple[float, float]) -> tuple[float, float]:
        low, high = (hurst_from_slope(value, settings.convention) for value in pair)
        return low, high

    value = hurst_from_slope(slope.value, settings.convention)
    hurst = Estimate(value, convert(slope.interval), _usable(convert(slope.scatter), value))
    if value > 0:
        hurst = replace(hurst, interval=_usable(hurst.interval, value))
    return {"q0": q0, "slope": slope, "hurst": hurst, "rms": rms}


def _usable(pair: tuple[float, float], value: float) -> tuple[float, float]:
    """Clip a range of H to 0.05 ... 1 where the value itself lies inside (the paper clips 1.20 to 1.0)."""
    if not 0.05 < value < 1:
        return pair
    return max(pair[0], 0.05), min(pair[1], 1.0)


def _union(interval: Sequence[float], values: Sequence[float] | np.ndarray) -> tuple[float, float]:
    """Smallest range that holds the interval and all values."""
    every = np.concatenate([np.asarray(interval, dtype=float), np.asarray(values, dtype=float)])
    return float(every.min()), float(every.max())


def _pair(values: Sequence[float]) -> tuple[float, float]:
    return float(values[0]), float(values[1])
