"""The wave vectors that a line profile is trusted at, and its two-dimensional spectrum there."""

import numpy as np

from mesoscale.errors import InputError
from mesoscale.topography.description.trusted_range import MOST_CURVED, TrustedSpectrum
from mesoscale.topography.measurements.loading import Measurement
from mesoscale.topography.measurements.profiles import Profile
from mesoscale.topography.profile_conversion import binned_line, isotropic_spectrum, line_spectrum

LOWEST_WAVE = 2.5  # wave numbers below are changed by the window and the line taken off
LOWEST_WAVE_BOW = 4.0  # and by a parabola
# of Nyquist: short waves folded back lift C1, which is shallow, by 6 % at the first of these (slope 2.84);
# straight lines between uneven points smooth
EVEN_SHARE, RESAMPLED_SHARE = 0.35, 0.5
NOISE_MARGIN = 20.0
SMOOTHED = 8  # wave numbers to each side, at least: single ones scatter by as much as they are
TIP_MARGIN = 0.5


def trusted_profile(cleaned: Profile, measured: Measurement) -> TrustedSpectrum:
    """Isotropic spectrum of a levelled profile within what its instrument shows.

    Above, the first of pixels, noise (as seen at the Nyquist wave vector, or as stated), the instrument's shortest
    wave, and the tip, by the same measure as for scans (`trusted_range`).

    Raises
    ------
    InputError : hardly a wave between the ends of what is trusted.
    """
    k, c1 = line_spectrum(cleaned)
    step = 2 * np.pi / cleaned.length_nm
    nyquist = np.pi / cleaned.step_nm
    low = (LOWEST_WAVE_BOW if cleaned.bow else LOWEST_WAVE) * step
    limits = {"pixels": (RESAMPLED_SHARE if cleaned.resampled else EVEN_SHARE) * nyquist}
    if measured.shortest_wave_nm:
        limits["filter"] = 2 * np.pi / measured.shortest_wave_nm
    limits.update(_noise_limit(k, c1, low, nyquist, cleaned, measured.noise_nm))
    limit = min(limits, key=lambda key: limits[key])
    reach = limits[limit]
    _check_span(cleaned, low, reach, limit)
    spectrum = isotropic_spectrum(cleaned, low, reach)
    if measured.tip_radius_nm > 0:
        curvature = measured.tip_radius_nm * np.sqrt(2 * np.pi * spectrum.psd) * spectrum.q**3
        if (curvature > TIP_MARGIN).any():
            limit, limits["tip"] = "tip", float(spectrum.q[curvature > TIP_MARGIN][0])
            _check_span(cleaned, low, limits["tip"], limit)
            # what the tip has taken beyond would pull the waves below down with it
            reach = float(spectrum.q[curvature < MOST_CURVED][-1])
            spectrum = isotropic_spectrum(cleaned, low, reach)
    high, radius = limits[limit], measured.tip_radius_nm
    line = binned_line(k, c1, low, high)
    return TrustedSpectrum(cleaned.name, spectrum, low, high, limit, radius, cleaned.rms_nm, reach, line=line)


def _noise_limit(
    k: np.ndarray, c1: np.ndarray, low: float, nyquist: float, profile: Profile, noise_nm: float | None
) -> dict[str, float]:
    """Where C1 meets the noise: a white level seen at Nyquist, or the stated one."""
    # unless it is known: the level at Nyquist; log 2 is the median of an exponential distribution of mean 1
    level = float(np.median(c1[k > 0.93 * nyquist])) / np.log(2)
    if noise_nm is not None:
        level = noise_nm**2 * profile.step_nm / (2 * np.pi)
    width = np.maximum(0.25 * k, SMOOTHED * (k[1] - k[0]))
    first, last = np.searchsorted(k, k - width), np.searchsorted(k, k + width)
    total = np.concatenate([[0.0], np.cumsum(c1)])
    smooth = (total[last] - total[first]) / (last - first)
    noisy = (k > low) & (smooth < NOISE_MARGIN * level)
    return {"noise": float(k[noisy][0])} if noisy.any() else {}


def _check_span(profile: Profile, low: float, high: float, limit: str) -> None:
    if high < 2 * low:
        raise InputError(
            f"{profile.name}: nothing to see: its waves are trusted from {low:.2g} /nm, but the {limit} limit "
            f"ends them at {high:.2g} /nm; give a longer or finer profile, state its own tip "
            "(topography.instruments; 0 for a side view), or leave it out"
        )
