"""A tip beyond blunting: it lifts grains and fills grooves; its radius is uncertain.

A tip rests on the highest point below it, so that its image lies above the surface. On a Gaussian
surface this lift is the same everywhere on average and goes with the mean height. Tall grains are
steep too: there the lift is larger, and all long waves grow by one factor. Grooves are filled
instead, and long waves shrink. A surface z = F(g) (`height_synthesis`) is at g as a Gaussian one
whose short waves are a = F'(g) / sqrt(<F'^2>) times as high, of mean lift L(a). Its long waves in
the image are 1 + Cov(L, F) / Var(F) times as high.

Beside dilated surfaces (14; slopes 2.3 to 3.7, RMS 2 to 10 nm, tips of 2 to 10 nm, skewness 0.35 to
0.9) this lift of ln C, 0.05 to 0.5, is right to 15 % from the true heights; from those of images of
1 um 0.85 of it is found, 0.74 to 1.1; of grooves all of it (python -m evidence topography.coverage
--kinds grooved).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from mesoscale.settings import TopographySettings
from mesoscale.topography.description.doubts import Doubt
from mesoscale.topography.description.likelihood import LikelihoodFit
from mesoscale.topography.description.one_spectrum import OneSpectrum, merge
from mesoscale.topography.description.parameters import MAX_MISFIT, Topography, analyse
from mesoscale.topography.description.trusted_range import TrustedSpectrum, trusted_range
from mesoscale.topography.height_synthesis import Z
from mesoscale.topography.roughness_spectrum import RoughSpectrum, mean_square
from mesoscale.topography.synthesis import synthesize_spectrum
from mesoscale.topography.synthetic_scans import dilate

Array = np.ndarray


@dataclass(frozen=True)
class Lift:
    """How the lift is estimated."""

    further: float = 3.0
    """Roughness goes on with its slope at least to so many times the wave vectors seen."""

    furthest: float = 30.0
    """And at most to so many times."""

    finest_wave: float = 10.0
    """At most to waves of two atoms, 1/nm."""

    largest: float = 2 * np.log(2)
    """Of ln C; where half the height would be lift this theory ends."""

    sites: int = 256
    """A side of the Gaussian surfaces that a tip is set on."""

    amplitudes: Array = field(default_factory=lambda: np.array([0.25, 0.5, 1.0, 2.0, 4.0]))
    """Of their short waves, times those measured."""

    recovered: float = 0.85
    """Share of the lift that is found from images, which lose skewness."""

    error: float = 0.2
    """Share of the lift that this leaves uncertain."""

    radius_error: float = 0.2
    """Relative; a radius is anywhere within, as a maker states it or a worn tip has it."""


LIFT = Lift()
BELL = np.exp(-(Z**2) / 2)
WEIGHT = BELL / np.sum(BELL)


def tip_lift(
    radius_nm: float, fitted: LikelihoodFit, seen: float, cutoff: float, quantiles: Array
) -> tuple[float, float]:
    """ln of the C of grainy or grooved images over the surface's at long waves, and its deviation.

    Parameters
    ----------
    fitted : eq. 9 of the images.
    seen, cutoff : where the trusted spectrum and the images end, 1/nm.
    quantiles : (len(Z),) heights of the images at each normal variable of `Z`, in units of their
        RMS.
    """
    rms = float(np.sqrt(mean_square(fitted.plateau, fitted.q0, fitted.slope, cutoff)))
    image = _smooth(quantiles * rms)
    near = LIFT.further * seen
    far = max(min(LIFT.furthest * seen, LIFT.finest_wave), LIFT.further * seen)
    gains = []
    for end in (near, np.sqrt(near * far), far):
        gain = _gain(image, _mean_lifts(radius_nm, fitted, end))
        gains.append(gain / LIFT.recovered if gain > 0 else gain)
    low, gain, high = gains
    between = 0.5 * (high - low) / np.sqrt(3)  # anywhere between both
    return gain, float(np.hypot(between, LIFT.error * gain))


def _mean_lifts(radius_nm: float, fitted: LikelihoodFit, end: float) -> Array:
    """ln of the mean lift (nm) of Gaussian surfaces, waves up to `end` (1/nm), per amplitude."""
    length = LIFT.sites * np.pi / end
    first = 2 * np.pi / length
    spectrum = RoughSpectrum(fitted.plateau, fitted.q0, fitted.slope, end)
    all_waves = mean_square(fitted.plateau, fitted.q0, fitted.slope, end)
    longer = mean_square(fitted.plateau, fitted.q0, fitted.slope, first)
    rms = float(np.sqrt(all_waves - longer))
    surface = synthesize_spectrum(LIFT.sites, length, spectrum.psd, rms, seed=0)
    step = length / LIFT.sites
    lifts = []
    for amplitude in LIFT.amplitudes:
        heights = amplitude * surface
        lifts.append(float(np.mean(dilate(heights, radius_nm, step) - heights)))
    return np.log(np.maximum(lifts, 1e-6))


def _gain(image: Array, lifts: Array) -> float:
    """ln of what the tip made of C, from the heights of an image (nm at each of `Z`)."""
    surface = image
    lift = np.zeros_like(image)
    scale = LIFT.amplitudes
    for _ in range(4):
        steepness = np.maximum(np.gradient(surface, Z), 0.0)
        left = _covariance(surface, surface) / _covariance(image, image)
        if left < np.exp(-LIFT.largest):
            return float(LIFT.largest)
        amplitude = np.sqrt(left) * steepness / np.sqrt(WEIGHT @ steepness**2)
        log_amplitude = np.log(np.maximum(amplitude, scale[0]))
        lift = np.exp(np.interp(log_amplitude, np.log(scale), lifts))
        surface = _smooth(image - lift)
    grown = _covariance(surface + lift, surface) / max(_covariance(surface, surface), 1e-300)
    log_gain = 2 * np.log(max(grown, 1e-3))
    return float(np.clip(log_gain, -LIFT.largest, LIFT.largest))


def _smooth(heights: Array) -> Array:
    """The best rising sum of Hermite polynomials up to the third: tables are rough."""
    root = np.sqrt(WEIGHT)
    hermite = [np.ones_like(Z), Z, Z**2 - 1, Z**3 - 3 * Z]
    shapes = np.stack(hermite)
    share = np.linalg.lstsq((shapes * root).T, heights * root, rcond=None)[0]
    return np.maximum.accumulate(share @ shapes)


def _covariance(first: Array, second: Array) -> float:
    return float(WEIGHT @ (first * second) - (WEIGHT @ first) * (WEIGHT @ second))


def without_lift(
    spectra: Sequence[TrustedSpectrum], topography: Topography, quantiles: Mapping[str, Array]
) -> tuple[list[TrustedSpectrum], float]:
    """Spectra of grainy or grooved maps without their tips' lift, and the error of ln C it leaves.

    Maps without a tip and line profiles stay as they are; all do where eq. 9 describes the spectra
    too badly to say how rough the surface is under a tip.

    Parameters
    ----------
    quantiles : by name of a map, heights at each normal variable of `Z` in units of its RMS.
    """
    fitted = topography.likelihood
    lifted = [item for item in spectra if item.name in quantiles]
    if (
        fitted is None
        or fitted.misfit > MAX_MISFIT
        or not any(item.tip_radius_nm > 0 for item in lifted)
    ):
        return list(spectra), 0.0
    common = np.mean(list(quantiles.values()), axis=0)
    seen = max(item.high for item in lifted)
    radii = {item.tip_radius_nm for item in lifted if item.tip_radius_nm > 0}
    cutoff = topography.cutoff
    lifts = {radius: tip_lift(radius, fitted, seen, cutoff, common) for radius in radii}
    lowered = []
    for item in spectra:
        if item.name in quantiles and item.tip_radius_nm > 0:
            item = _lowered(item, lifts[item.tip_radius_nm][0])
        lowered.append(item)
    return lowered, max(error for _, error in lifts.values())


def _lowered(item: TrustedSpectrum, gain: float) -> TrustedSpectrum:
    """A spectrum less the lift, which fades by 0.14 and 0.42 where the tip takes 0.15 and 0.5."""
    fading = item.spectrum.psd / item.corrected_psd()
    spectrum = replace(item.spectrum, psd=item.spectrum.psd * np.exp(-gain * fading))
    return replace(item, spectrum=spectrum, rms_nm=item.rms_nm * float(np.exp(-gain / 2)))


def with_lift_error(topography: Topography, error: float) -> Topography:
    """The same estimates; the RMS height's interval holds an error of ln C common to all waves."""
    if error == 0 or "rms" not in topography.estimates:
        return topography
    rms = topography.estimates["rms"].widened(error / 2, log=True)
    return replace(topography, estimates={**topography.estimates, "rms": rms})


def lift_doubt(
    before: Sequence[TrustedSpectrum], after: Sequence[TrustedSpectrum], error: float
) -> list[Doubt]:
    """In words what was taken off, where that is worth a word (0.05 of ln C)."""
    pairs = zip(before, after, strict=True)
    rough = [(image.rms_nm, surface.rms_nm) for image, surface in pairs if surface.rms_nm > 0]
    gains = [2 * float(np.log(image_nm / surface_nm)) for image_nm, surface_nm in rough]
    gain = max(gains, key=abs, default=0.0)
    if abs(gain) < 0.05:
        return []
    uncertain = f"uncertain by {error / 2:.0%}"
    text = (
        f"the tip fills grooves: {np.expm1(-gain / 2):.0%} of the RMS height are added, {uncertain}"
    )
    if gain > 0:
        text = (
            f"on tall grains the tip makes long waves higher: {np.expm1(gain / 2):.0%} of the RMS"
            f" height are taken off, {uncertain}"
        )
    return [
        Doubt("tip_on_grains", text, "scan with a sharper tip, or state the radius of yours", "rms")
    ]


def with_radius_error(
    topography: Topography, spectra: Sequence[TrustedSpectrum], settings: TopographySettings
) -> Topography:
    """The same estimates; intervals hold an error of every tip's radius (`Lift.radius_error`).

    All is analysed again with radii smaller and larger by that; half of the difference, as the half
    width of a uniform distribution, is added to the interval in quadrature.
    """
    if not topography.estimates or not any(item.tip_radius_nm > 0 for item in spectra):
        return topography
    sharp, blunt = (analyse(item, settings).estimates for item in _sharper_and_blunter(spectra))
    estimates = {}
    for name, estimate in topography.estimates.items():
        if name in sharp and name in blunt:
            log = name in ("q0", "rms")
            low = sharp[name].value
            high = blunt[name].value
            if log:
                low = np.log(low)
                high = np.log(high)
            half_range = abs(float(high - low)) / 2
            estimate = estimate.widened(half_range / np.sqrt(3), log)
        estimates[name] = estimate
    return replace(topography, estimates=estimates)


def spectrum_with_radius_error(
    merged: OneSpectrum | None, spectra: Sequence[TrustedSpectrum]
) -> OneSpectrum | None:
    """The same spectrum whose band holds an error of every tip's radius, alike for all of them."""
    if merged is None or not any(item.tip_radius_nm > 0 for item in spectra):
        return merged
    sharp, blunt = (merge(item) for item in _sharper_and_blunter(spectra))
    if blunt is None or sharp is None:
        return merged
    log_q = np.log(merged.q)
    changes = []
    for other in (blunt, sharp):
        other_log_q = np.log(other.q)
        change = other.log_psd - np.interp(other_log_q, log_q, merged.log_psd)
        changes.append(np.interp(log_q, other_log_q, change))
    return merged.with_error((changes[0] - changes[1]) / 2 / np.sqrt(3))


def _sharper_and_blunter(spectra: Sequence[TrustedSpectrum]) -> list[list[TrustedSpectrum]]:
    """The measurements as trusted with tips of smaller and of larger radius."""
    factors = [1 + side * LIFT.radius_error for side in (-1, 1)]
    return [[_with_radius(item, factor) for item in spectra] for factor in factors]


def _with_radius(item: TrustedSpectrum, factor: float) -> TrustedSpectrum:
    radius = factor * item.tip_radius_nm
    high = item.high
    if radius > 0:
        high = min(trusted_range(item.name, item.spectrum, radius).high, item.reach)
    return replace(item, tip_radius_nm=radius, high=max(high, 2 * item.low))
