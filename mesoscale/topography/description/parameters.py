"""Roughness parameters of a set of scans: q0, q1, slope, Hurst exponent and RMS, with doubts."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mesoscale.settings import TopographySettings
from mesoscale.topography.description import likelihood, line_fits
from mesoscale.topography.description.doubts import Doubt
from mesoscale.topography.description.intervals import REACH, Estimate, union
from mesoscale.topography.description.likelihood import LikelihoodFit
from mesoscale.topography.description.line_fits import LineFit
from mesoscale.topography.description.trusted_range import TrustedSpectrum
from mesoscale.topography.roughness_spectrum import Convention, hurst_from_slope, mean_square

MAX_MISFIT = 0.3
"""RMS logarithmic residual of pooled bins above which equation 9 does not describe them."""
MOST_APART = 1.5
"""Standard deviation of ln C between measurements; where RMS heights of places scatter by 40 % it
is 0.8.
"""


@dataclass(frozen=True)
class Topography:
    """Everything known about the roughness of a set of scans.

    Attributes
    ----------
    likelihood, line_fit : the two fits; None where impossible.
    q1, q1_limited : end of the power law (1/nm), or of what the finest trusted scan resolves.
    cutoff : wave vector up to which RMS heights are integrated: the finest Nyquist wave vector,
        1/nm.
    estimates : q0 (1/nm), slope, hurst, rms (nm) by maximum likelihood; empty where not
        identifiable.
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
    lowest = min((item.low for item in spectra), default=0.0)
    fitted = likelihood.fit(spectra)
    if fitted is not None:
        spectra = likelihood.skip_blurred_shells(spectra, fitted.q0)
        fitted = likelihood.fit(spectra, knee=fitted.q0) or fitted
    line_fit = line_fits.fit_lines(spectra)
    estimates = {}
    if fitted is not None:
        estimates = _estimates(spectra, fitted, cutoff, settings)
    q1 = max((item.high for item in spectra), default=0.0)
    limited = True
    if line_fit is not None:
        q1 = line_fit.q1
        limited = line_fit.q1_limited
    return Topography(
        fitted, line_fit, q1, limited, cutoff, estimates, _doubts(spectra, fitted, lowest, settings)
    )


def _doubts(
    spectra: Sequence[TrustedSpectrum],
    fitted: LikelihoodFit | None,
    lowest: float,
    settings: TopographySettings,
) -> tuple[Doubt, ...]:
    """Why the parameters are not identifiable or not to be trusted, in words with numbers.

    Parameters
    ----------
    lowest : smallest wave vector that any measurement shows undisturbed, 1/nm.
    """
    if fitted is None:
        text = (
            "not identifiable: too few wave vectors between the scan's size and what the instrument"
            " resolves"
        )
        return (
            Doubt(
                "too_few_waves",
                text,
                "scan more pixels or a larger area, or state a sharper tip",
                fatal=True,
            ),
        )
    doubts = []
    highest = max(item.high for item in spectra)
    least_gain = 12.0  # of 2 ln L by a plateau or a power law
    least_span = 2.5  # of the trusted range over q0
    if fitted.power_gain < least_gain or fitted.slope < 0.5:
        text = "not identifiable: no power law, the spectrum is flat (noise, or pixels too coarse)"
        doubts.append(
            Doubt(
                "flat_spectrum", text, "scan with less noise and finer pixels", "slope", fatal=True
            )
        )
    # six maps of eq. 9 with 6.4 waves of the knee a side (1.9): plateau 27 % too low, RMS 7 %; with
    # 9.5 (2.9) right
    if fitted.plateau_gain < least_gain or fitted.q0 < 2.4 * lowest:
        text = (
            f"the knee q0 of eq. 9 cannot be told: waves are seen undisturbed from {lowest:.2g} /nm"
            " on, which shows no plateau below it, or too little of one"
        )
        doubts.append(Doubt("no_plateau", text, "scans of a larger area would tell q0", "q0"))
    if highest < least_span * fitted.q0:
        text = (
            f"slope is not identifiable: the trusted range ends at {highest:.2g} /nm, less than "
            f"{least_span:g} times q0 ({fitted.q0:.2g} /nm); add finer scans or use a sharper tip"
        )
        doubts.append(Doubt("short_range", text, "add finer scans or use a sharper tip", "slope"))
    use_measured = "use the measured spectrum (topography.description)"
    if not fitted.settled:
        text = "the fit of eq. 9 ended before it settled: q0 and slope are those of its last step"
        doubts.append(Doubt("fit_unsettled", text, use_measured))
    if fitted.misfit > MAX_MISFIT:
        text = (
            "no plateau with a power law common to the scans: the fit misses the spectra by a"
            f" factor {np.exp(fitted.misfit):.2g} (RMS)"
        )
        doubts.append(Doubt("no_common_power_law", text, use_measured))
    if fitted.amplitude_sd > MOST_APART:
        text = (
            "no level common to the measurements: about a power law of one shape their C scatters"
            f" by a factor of {np.exp(fitted.amplitude_sd):.2g} (standard deviation)"
        )
        doubts.append(
            Doubt("levels_differ", text, f"{use_measured}, check units and height scales", "rms")
        )
    hurst = hurst_from_slope(fitted.slope, settings.convention)
    if not 0 < hurst < 1:
        other: Convention = "profile" if settings.convention == "areal" else "areal"
        hint = ""
        if 0 < hurst_from_slope(fitted.slope, other) < 1:
            hint = f" (with topography.convention and contact.reading.convention: {other} it is in)"
        text = f"H = {hurst:.2f} is outside 0 ... 1 in convention {settings.convention}{hint}"
        doubts.append(Doubt("hurst_outside", text, use_measured, "slope"))
    return tuple(doubts)


def _estimates(
    spectra: Sequence[TrustedSpectrum],
    fitted: LikelihoodFit,
    cutoff: float,
    settings: TopographySettings,
) -> dict[str, Estimate]:
    """Values of the fit; intervals of the typical place; scatter between the scans."""
    log_plateau = np.log(fitted.plateau)
    centre = np.array([log_plateau, np.log(fitted.q0), fitted.slope])
    slope_error = min(float(np.sqrt(fitted.covariance[2, 2])), 10.0)
    q0_interval = likelihood.q0_interval(spectra, fitted, REACH)
    slope_interval = (
        float(fitted.slope - REACH * slope_error),
        float(fitted.slope + REACH * slope_error),
    )

    def log_rms(point: np.ndarray) -> float:
        square = mean_square(np.exp(point[0]), np.exp(point[1]), point[2], cutoff)
        return 0.5 * float(np.log(square))

    step = 1e-4
    steps = step * np.eye(3)
    gradient = np.array([log_rms(centre + e) - log_rms(centre - e) for e in steps]) / (2 * step)
    # unidentified: a factor of e^10 is wide enough
    rms_error = min(float(np.sqrt(gradient @ fitted.covariance @ gradient)), 10.0)
    rms = float(np.exp(log_rms(centre)))
    low, high = rms * np.exp(REACH * rms_error * np.array([-1, 1]))
    own_q0, own_slope = likelihood.single_scans(spectra, fitted)
    slope = Estimate(fitted.slope, slope_interval, union(slope_interval, own_slope))
    rms_interval = (float(low), float(high))
    rms_scatter = union(rms_interval, fitted.scan_rms(cutoff))
    return {
        "q0": Estimate(fitted.q0, q0_interval, union(q0_interval, own_q0)),
        "slope": slope,
        "hurst": _hurst(slope, settings.convention),
        "rms": Estimate(rms, rms_interval, rms_scatter),
    }


def _hurst(slope: Estimate, convention: Convention) -> Estimate:
    """H of a slope; ranges are clipped to 0.05 ... 1 where H lies inside (paper: 1.20 to 1.0)."""
    value = hurst_from_slope(slope.value, convention)
    ranges = []
    for low, high in (slope.interval, slope.scatter):
        hurst_low = hurst_from_slope(low, convention)
        hurst_high = hurst_from_slope(high, convention)
        if 0.05 < value < 1:
            hurst_low = max(hurst_low, 0.05)
            hurst_high = min(hurst_high, 1.0)
        ranges.append((hurst_low, hurst_high))
    return Estimate(value, *ranges)
