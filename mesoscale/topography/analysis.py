"""From one cleaned scan to its spectra, and from all spectra to the curves of figures 9 and 10."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mesoscale.errors import InputError
from mesoscale.settings import TopographySettings
from mesoscale.topography.description.likelihood import TrustedSpectrum, trusted_range
from mesoscale.topography.description.parameters import Topography, analyse, inputs
from mesoscale.topography.measurements.cleaning import Scan, clean
from mesoscale.topography.roughness_spectrum import RoughSpectrum, hurst_from_slope, mean_square
from mesoscale.topography.spectrum import (
    Spectrum,
    autocorrelation,
    log_bins,
    profile_spectrum,
    radial_spectrum,
)

HANN_SECTIONS = 25  # Hann-windowed sections overlap more than flat ones; more than this adds nothing
THUMBNAIL = 256  # pixels per side of the picture of a scan
CURVE_POINTS = 200


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
    sections, fraction = settings.sections, settings.section_fraction
    spectrum = radial_spectrum(heights, lengths, min(sections, HANN_SECTIONS), fraction, flat=0.0, skip_lines=True)
    flat = radial_spectrum(heights, lengths, sections, fraction, settings.window_flat)
    profile_q, profile_psd = profile_spectrum(heights, lengths)
    lag, correlation = autocorrelation(heights, lengths)
    return ScanAnalysis(cleaned, scan.rms_nm, spectrum, flat, profile_q, profile_psd, lag, correlation)


def trusted(name: str, spectrum: Spectrum, rms_nm: float, settings: TopographySettings) -> TrustedSpectrum:
    """The spectrum of a scan of known RMS height with its trusted range for the tip of the settings."""
    return trusted_range(name, spectrum, settings.tip_radius_nm, rms_nm=rms_nm)


def trusted_scan(scan: Scan, settings: TopographySettings) -> TrustedSpectrum:
    """Spectrum and trusted range of a raw scan."""
    result = analyse_scan(scan, settings)
    return trusted(scan.name, result.spectrum, result.cleaned.rms_nm, settings)


def thumbnail(heights: np.ndarray) -> np.ndarray:
    """Heights thinned to at most THUMBNAIL pixels a side, single precision."""
    stride = max(1, -(-max(heights.shape) // THUMBNAIL))
    return heights[::stride, ::stride].astype(np.float32)


def pooled_curve(spectra: Sequence[Spectrum]) -> dict[str, np.ndarray]:
    """Geometric mean, lowest and highest C of all scans on common bins of log q, with the number of scans."""
    per_decade = 12
    rows: dict[int, list[tuple[float, float]]] = {}
    for spectrum in spectra:
        binned = log_bins(spectrum, per_decade)
        for q, psd in zip(binned.q, binned.psd, strict=True):
            rows.setdefault(int(np.floor(np.log10(q) * per_decade)), []).append((q, psd))
    keys = sorted(rows)
    return {
        "q": np.array([np.exp(np.mean([np.log(q) for q, _ in rows[key]])) for key in keys]),
        "psd": np.array([np.exp(np.mean([np.log(psd) for _, psd in rows[key]])) for key in keys]),
        "psd_low": np.array([min(psd for _, psd in rows[key]) for key in keys]),
        "psd_high": np.array([max(psd for _, psd in rows[key]) for key in keys]),
        "scans": np.array([len(rows[key]) for key in keys]),
    }


def fit_curves(topography: Topography, lowest_q: float, truth: RoughSpectrum | None = None) -> Mapping[str, np.ndarray]:
    """The fits of figure 10 on a common grid of q (1/nm), C in nm^4; bounds are those of the line fits."""
    q = np.geomspace(lowest_q, max(topography.cutoff, 2 * lowest_q), CURVE_POINTS)
    curves = {"q": q}
    if topography.likelihood is not None:
        curves["likelihood"] = topography.likelihood.spectrum(topography.cutoff).psd(q)
    line = topography.line_fit
    if line is not None:
        end = topography.cutoff
        curves["lines"] = RoughSpectrum(line.plateau, line.q0, line.slope, end).psd(q)
        curves["shallow_bound"] = RoughSpectrum(line.plateau, line.q0, line.slope_low, end).psd(q)
        curves["steep_bound"] = RoughSpectrum(line.plateau, line.q0, line.slope_high, end).psd(q)
        curves["plateau_low"] = np.where(q <= line.q0, line.plateau_low, np.nan)
        curves["plateau_high"] = np.where(q <= line.q0, line.plateau_high, np.nan)
    if truth is not None:
        curves["truth"] = truth.psd(q)
    return curves


def measure_roughness(scans: Sequence[Scan], settings: TopographySettings | None = None) -> dict[str, Any]:
    """Roll-off wave vector q0 (1/nm), Hurst exponent and RMS height (nm) of raw scans of one surface.

    Returns
    -------
    content : as topography/parameters.json: `estimates` by name with value, interval and scatter, `inputs` (what the
        table of inputs takes) and `gate` (`passed`, `reasons`: why not to trust them).

    Raises
    ------
    InputError : no scan, or one that cannot be used.
    """
    settings = settings or TopographySettings()
    if not scans:
        raise InputError("scans: none given; at least one is needed")
    topography = analyse([trusted_scan(scan, settings) for scan in scans], settings)
    return parameters(topography, [], settings, None)


UNITS = {"q0": "1/nm", "slope": "1", "hurst": "1", "rms": "nm"}
CURVES = {  # unit and meaning of every curve in spectra.h5
    "q": ("1/nm", "wave vector"),
    "psd": ("nm^4", "geometric mean of the scans' spectra"),
    "psd_low": ("nm^4", "lowest scan"),
    "psd_high": ("nm^4", "highest scan"),
    "scans": ("1", "scans that reach this wave vector"),
    "likelihood": ("nm^4", "maximum-likelihood fit of equation 9"),
    "lines": ("nm^4", "line fits of the paper's procedure"),
    "shallow_bound": ("nm^4", "shallowest line that bounds the scatter"),
    "steep_bound": ("nm^4", "steepest line that bounds the scatter"),
    "plateau_low": ("nm^4", "lowest plateau of a scan"),
    "plateau_high": ("nm^4", "highest plateau of a scan"),
    "truth": ("nm^4", "spectrum of the typical place of the synthetic surface"),
}


def scan_rows(
    spectra: Sequence[TrustedSpectrum],
    topography: Topography,
    attributes: Mapping[str, Mapping[str, Any]],
    truth: Mapping[str, Any] | None,
) -> list[dict[str, Any]]:
    """One row per scan: size, RMS from heights and from the spectrum, trusted range and what limits it."""
    spectrum_rms = {}
    fitted = topography.likelihood
    if fitted is not None:
        used = [item.name for item in spectra if item.trusted.sum() >= 3]
        spectrum_rms = dict(zip(used, fitted.scan_rms(topography.cutoff), strict=True))
    rows = []
    for item in spectra:
        loaded = attributes[item.name]
        row = {
            "name": item.name,
            "file": loaded["file"],
            "sha256": loaded["sha256"],
            "length_nm": min(loaded["length_x_nm"], loaded["length_y_nm"]),
            "pixels": f"{loaded['pixels_x']} x {loaded['pixels_y']}",
            "rms_heights_nm": loaded["rms_nm"],
            "rms_spectrum_nm": spectrum_rms.get(item.name, float("nan")),
            "trusted_low": item.low,
            "trusted_high": item.high,
            "limit": item.limit,
            "steps": loaded["steps"],
        }
        if truth is not None:
            row["true_rms_nm"] = truth["scans"][item.name]["rms_nm"]
        rows.append(row)
    return rows


def parameters(
    topography: Topography,
    rows: Sequence[Mapping[str, Any]],
    settings: TopographySettings,
    truth: Mapping[str, Any] | None,
) -> dict[str, Any]:
    """Content of topography/parameters.json."""
    doubts = list(topography.reasons)
    passed = bool(topography.estimates) and (not doubts or settings.on_doubt == "warn")
    likelihood, line = topography.likelihood, topography.line_fit
    content: dict[str, Any] = {
        "synthetic": truth is not None,
        "convention": settings.convention,
        "method": settings.method,
        "ranges": settings.ranges,
        "confidence": settings.confidence,
        "tip_radius_nm": settings.tip_radius_nm,
        "estimates": {
            name: {**estimate.plain(), "unit": UNITS[name]} for name, estimate in topography.estimates.items()
        },
        "q1": {"value": topography.q1, "unit": "1/nm", "instrument_limited": topography.q1_limited},
        "integrated_to_q": topography.cutoff,
        "likelihood": None,
        "lines": None,
        "scans": list(rows),
        "inputs": inputs(topography, settings) if passed else {},
        "gate": {"passed": passed, "reasons": doubts},
    }
    if likelihood is not None:
        fitted = likelihood.spectrum(topography.cutoff)
        content["likelihood"] = {
            "plateau_nm4": likelihood.plateau,
            "q0": likelihood.q0,
            "slope": likelihood.slope,
            "rms_nm": fitted.rms_nm,
            "rms_slope": fitted.rms_slope,
            "covariance": likelihood.covariance,
            "amplitude_sd": likelihood.amplitude_sd,
            "dispersion": likelihood.dispersion,
            "misfit": likelihood.misfit,
            "plateau_gain": likelihood.plateau_gain,
            "power_gain": likelihood.power_gain,
            "hurst_profile": hurst_from_slope(likelihood.slope, "profile"),
            "hurst_areal": hurst_from_slope(likelihood.slope, "areal"),
        }
    if line is not None:
        scale = mean_square(1.0, line.q0, line.slope, topography.cutoff)
        content["lines"] = {
            "plateau_nm4": line.plateau,
            "q0": line.q0,
            "q0_departure": line.departure,
            "q1": line.q1,
            "slope": line.slope,
            "slope_bounds": [line.slope_low, line.slope_high],
            "hurst_bounds": [
                hurst_from_slope(value, settings.convention) for value in (line.slope_low, line.slope_high)
            ],
            "rms_nm": line.rms(topography.cutoff),
            "rms_bounds_nm": [float(np.sqrt(level * scale)) for level in (line.plateau_low, line.plateau_high)],
            "hurst_profile": hurst_from_slope(line.slope, "profile"),
            "hurst_areal": hurst_from_slope(line.slope, "areal"),
        }
    if truth is not None:
        content["truth"] = {
            **truth["truth"],
            "hurst": hurst_from_slope(truth["truth"]["slope"], settings.convention),
        }
    return content
