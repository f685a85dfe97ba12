"""From one measurement, a scan or a line profile, to its spectra."""

from dataclasses import dataclass, replace

import numpy as np

from mesoscale.settings import TopographySettings
from mesoscale.topography.description.trusted_range import TrustedSpectrum, trusted_range
from mesoscale.topography.measurements.cleaning import Scan, clean, form_share
from mesoscale.topography.measurements.loading import Measurement
from mesoscale.topography.spectrum import (
    FLAT_SHARE,
    HANN_SECTIONS,
    SECTION_SIDE,
    SECTIONS,
    Spectrum,
    autocorrelation,
    profile_spectrum,
    radial_spectrum,
)

THUMBNAIL = 256  # pixels per side of the picture of a scan


@dataclass(frozen=True)
class ScanAnalysis:
    """Spectra of one scan.

    Attributes
    ----------
    cleaned : the scan after levelling, with the steps taken.
    raw_rms_nm : RMS height before any step.
    spectrum : isotropic spectrum, Hann window, without the lowest wave numbers along the scan lines; the fits
        use it.
    flat_spectrum : isotropic spectrum by the paper's sections and nearly flat window.
    profile_q, profile_psd : one-dimensional spectrum along the scan lines, 1/nm and nm^3.
    lag_nm, autocorrelation_nm2 : height autocorrelation along the scan lines.
    """

    cleaned: Scan
    raw_rms_nm: float
    spectrum: Spectrum
    flat_spectrum: Spectrum
    profile_q: np.ndarray
    profile_psd: np.ndarray
    lag_nm: np.ndarray
    autocorrelation_nm2: np.ndarray


def analyse_scan(scan: Scan, settings: TopographySettings) -> ScanAnalysis:
    """Clean a scan and compute its spectra."""
    cleaned = clean(scan, settings)
    heights, lengths = cleaned.heights_nm, cleaned.lengths_nm
    spectrum = hann_spectrum(cleaned)
    flat = radial_spectrum(heights, lengths, SECTIONS, SECTION_SIDE, FLAT_SHARE)
    profile_q, profile_psd = profile_spectrum(heights, lengths)
    lag, correlation = autocorrelation(heights, lengths)
    return ScanAnalysis(cleaned, scan.rms_nm, spectrum, flat, profile_q, profile_psd, lag, correlation)


def hann_spectrum(cleaned: Scan, sections: int = HANN_SECTIONS, flat: float = 0.0) -> Spectrum:
    """The spectrum of a cleaned scan that the fits use, without what line offsets disturb."""
    return radial_spectrum(cleaned.heights_nm, cleaned.lengths_nm, sections, SECTION_SIDE, flat, skip_lines=True)


def trusted(name: str, spectrum: Spectrum, rms_nm: float, settings: TopographySettings) -> TrustedSpectrum:
    """The spectrum of a scan of known RMS height with its trusted range for the tip of the settings."""
    return trusted_range(name, spectrum, settings.tip_radius_nm, rms_nm=rms_nm)


def limited_spectrum(name: str, spectrum: Spectrum, cleaned: Scan, measured: Measurement) -> TrustedSpectrum:
    """The spectrum of a cleaned scan with the range that its instrument allows."""
    noise = (measured.noise_nm or 0.0) ** 2 * float(np.prod(cleaned.pixel_nm)) / (2 * np.pi) ** 2
    radius, rms, shortest = measured.tip_radius_nm, cleaned.rms_nm, measured.shortest_wave_nm
    limits = trusted_range(name, spectrum, radius, rms_nm=rms, shortest_wave_nm=shortest, noise_psd=noise)
    return replace(limits, side_nm=float(np.sqrt(np.prod(cleaned.lengths_nm))), form=form_share(cleaned.heights_nm))


def trusted_scan(scan: Scan, settings: TopographySettings) -> TrustedSpectrum:
    """Spectrum and trusted range of a raw scan."""
    cleaned = clean(scan, settings)
    return trusted(scan.name, hann_spectrum(cleaned), cleaned.rms_nm, settings)


def thumbnail(heights: np.ndarray) -> np.ndarray:
    """Heights thinned to at most THUMBNAIL pixels a side, single precision."""
    stride = max(1, -(-max(heights.shape) // THUMBNAIL))
    return heights[::stride, ::stride].astype(np.float32)
