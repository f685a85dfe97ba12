"""What a tip adds to the long waves of tall grains and takes from those of grooves, and the surface without it.

A tip rests on the highest point below it, so that its image lies above the surface. On a Gaussian surface this lift
is the same everywhere on average and goes with the mean height. Tall grains are steep too: there the lift is larger,
and all long waves grow by one factor. Grooves are filled instead, and long waves shrink. A surface z = F(g)
(`height_synthesis`) is at g as a Gaussian one whose short waves are a = F'(g) / sqrt(<F'^2>) times as high, of mean
lift L(a). Its long waves in the image are 1 + Cov(L, F) / Var(F) times as high.

Beside dilated surfaces (14; slopes 2.3 to 3.7, RMS 2 to 10 nm, tips of 2 to 10 nm, skewness 0.35 to 0.9) this lift of
ln C, 0.05 to 0.5, is right to 15 % from the true heights;
from those of images of 1 um 0.85 of it is found, 0.74 to 1.1; of grooves all of it
(python -m evidence topography.coverage --kinds grooved).
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from mesoscale.topography.description.confidence import REACH
from mesoscale.topography.description.doubts import Doubt
from mesoscale.topography.description.likelihood import LikelihoodFit
from mesoscale.topography.description.parameters import MAX_MISFIT, Estimate, Topography
from mesoscale.topography.description.trusted_range import TrustedSpectrum
from mesoscale.topography.height_synthesis import Z
from mesoscale.topography.roughness_spectrum import RoughSpectrum, mean_square
from mesoscale.topography.synthesis import synthesize_spectrum
from mesoscale.topography.synthetic_scans import dilate

Array = np.ndarray
# roughness goes on with its slope beyond what is seen: to between three and thirty times, at most to waves of two atoms
FURTHER, FURTHEST, FINEST_WAVE = 3.0, 30.0, 10.0  # 1, 1, 1/nm
MOST_TAKEN_OFF = 2 * np.log(2)  # of ln C; where half the height would be lift this theory ends
SITES = 256  # of the Gaussian surfaces that a tip is set on
AMPLITUDES = np.array([0.25, 0.5, 1.0, 2.0, 4.0])  # of their short waves, times those measured
LEAST_LIFT_NM = 1e-6
ROUNDS = 4
# share of the lift that is found from images, which lose skewness, and what that leaves uncertain (see above)
FOUND, THEORY_ERROR = 0.85, 0.2
CLEAR_LIFT = 0.05  # of ln C; less is not worth a word
WEIGHT = np.exp(-(Z**2) / 2) / np.sum(np.exp(-(Z**2) / 2))
SHAPES = np.stack([np.ones_like(Z), Z, Z**2 - 1, Z**3 - 3 * Z])  # Hermite polynomials: tables of few grains are rough


def tip_lift(
    radius_nm: float, fitted: LikelihoodFit, seen: float, cutoff: float, quantiles: Array
) -> tuple[float, float]:
    """ln of the C of grainy or grooved images over the surface's at long waves, and its standard deviation.

    Parameters
    ----------
    fitted : eq. 9 of the images.
    seen, cutoff : where the trusted spectrum and the images end, 1/nm.
    quantiles : (len(Z),) heights of the images at each normal variable of `Z`, in units of their RMS.
    """
    rms = float(np.sqrt(mean_square(fitted.plateau, fitted.q0, fitted.slope, cutoff)))
    image = _smooth(quantiles * rms)
    ends = FURTHER * seen, max(min(FURTHEST * seen, FINEST_WAVE), FURTHER * seen)
    low, gain, high = (
        gain / FOUND if (gain := _gain(image, _mean_lifts(radius_nm, fitted, end))) > 0 else gain
        for end in (ends[0], np.sqrt(ends[0] * ends[1]), ends[1])
    )
    between = 0.5 * (high - low) / np.sqrt(3)  # anywhere between both
    return gain, float(np.hypot(between, THEORY_ERROR * gain))


def _mean_lifts(radius_nm: float, fitted: LikelihoodFit, end: float) -> Array:
    """ln of the mean lift (nm) of Gaussian surfaces with waves up to `end` (1/nm), for each of AMPLITUDES."""
    length = SITES * np.pi / end
    first = 2 * np.pi / length
    spectrum = RoughSpectrum(fitted.plateau, fitted.q0, fitted.slope, end)
    whole, longer = (mean_square(fitted.plateau, fitted.q0, fitted.slope, q) for q in (end, first))
    surface = synthesize_spectrum(SITES, length, spectrum.psd, float(np.sqrt(whole - longer)), seed=0)
    lifts = [float(np.mean(dilate(a * surface, radius_nm, length / SITES) - a * surface)) for a in AMPLITUDES]
    return np.log(np.maximum(lifts, LEAST_LIFT_NM))


def _gain(image: Array, lifts: Array) -> float:
    """ln of what the tip made of C, from the heights of an image (nm at each of `Z`)."""
    surface, lift = image, np.zeros_like(image)
    for _ in range(ROUNDS):
        steepness = np.maximum(np.gradient(surface, Z), 0.0)
        left = _covariance(surface, surface) / _covariance(image, image)
        if left < np.exp(-MOST_TAKEN_OFF):
            return float(MOST_TAKEN_OFF)
        amplitude = np.sqrt(left) * steepness / np.sqrt(WEIGHT @ steepness**2)
        lift = np.exp(np.interp(np.log(np.maximum(amplitude, AMPLITUDES[0])), np.log(AMPLITUDES), lifts))
        surface = _smooth(image - lift)
    grown = _covariance(surface + lift, surface) / max(_covariance(surface, surface), 1e-300)
    return float(np.clip(2 * np.log(max(grown, 1e-3)), -MOST_TAKEN_OFF, MOST_TAKEN_OFF))


def _smooth(heights: Array) -> Array:
    """The best sum of Hermite polynomials up to the third, rising."""
    root = np.sqrt(WEIGHT)
    share = np.linalg.lstsq((SHAPES * root).T, heights * root, rcond=None)[0]
    return np.maximum.accumulate(share @ SHAPES)


def _covariance(first: Array, second: Array) -> float:
    return float(WEIGHT @ (first * second) - (WEIGHT @ first) * (WEIGHT @ second))


def without_lift(
    spectra: Sequence[TrustedSpectrum], topography: Topography, quantiles: Mapping[str, Array]
) -> tuple[list[TrustedSpectrum], float]:
    """Spectra of grainy or grooved maps without what their tips changed, and the error of ln C that this leaves.

    Maps without a tip and line profiles stay as they are; all do where eq. 9 describes the spectra too badly to say
    how rough the surface is under a tip.

    Parameters
    ----------
    quantiles : by name of a map, heights at each normal variable of `Z` in units of its RMS.
    """
    fitted = topography.likelihood
    if fitted is None or fitted.misfit > MAX_MISFIT or not quantiles:
        return list(spectra), 0.0
    common = np.mean(list(quantiles.values()), axis=0)
    seen = max((item.high for item in spectra if item.name in quantiles), default=0.0)
    lifts = {
        radius: tip_lift(radius, fitted, seen, topography.cutoff, common)
        for radius in {item.tip_radius_nm for item in spectra if item.name in quantiles}
        if radius > 0
    }
    if not lifts:
        return list(spectra), 0.0
    lowered = [
        _lowered(item, lifts[item.tip_radius_nm][0]) if item.name in quantiles and item.tip_radius_nm in lifts else item
        for item in spectra
    ]
    return lowered, max(error for _, error in lifts.values())


def _lowered(item: TrustedSpectrum, gain: float) -> TrustedSpectrum:
    """A spectrum less the lift, which fades where the tip takes waves: by 0.14 and 0.42 where it takes 0.15 and 0.5."""
    fading = item.spectrum.psd / item.corrected_psd()
    spectrum = replace(item.spectrum, psd=item.spectrum.psd * np.exp(-gain * fading))
    return replace(item, spectrum=spectrum, rms_nm=item.rms_nm * float(np.exp(-gain / 2)))


def with_lift_error(topography: Topography, error: float) -> Topography:
    """The same estimates; the interval of the RMS height holds an error of ln C common to all waves."""
    rms = topography.estimates.get("rms")
    if rms is None or error == 0:
        return topography
    reach = REACH * error / 2
    low, high = (np.log(rms.value / rms.interval[0]), np.log(rms.interval[1] / rms.value))
    interval = (rms.value * float(np.exp(-np.hypot(low, reach))), rms.value * float(np.exp(np.hypot(high, reach))))
    scatter = min(interval[0], rms.scatter[0]), max(interval[1], rms.scatter[1])
    estimates = {**topography.estimates, "rms": Estimate(rms.value, interval, scatter)}
    return replace(topography, estimates=estimates)


def lift_doubt(before: Sequence[TrustedSpectrum], after: Sequence[TrustedSpectrum], error: float) -> list[Doubt]:
    """In words what was taken off, where that is worth a word."""
    rough = [(a.rms_nm, b.rms_nm) for a, b in zip(before, after, strict=True) if b.rms_nm > 0]
    gain = max((2 * float(np.log(a / b)) for a, b in rough), key=abs, default=0.0)
    if abs(gain) < CLEAR_LIFT:
        return []
    grains = f"on tall grains the tip makes long waves higher: {np.expm1(gain / 2):.0%} of the RMS height are taken off"
    grooves = f"the tip fills grooves: {np.expm1(-gain / 2):.0%} of the RMS height are added"
    text = f"{grains if gain > 0 else grooves}, uncertain by {error / 2:.0%}"
    return [Doubt("tip_on_grains", text, "scan with a sharper tip, or state the radius of yours", "rms")]
