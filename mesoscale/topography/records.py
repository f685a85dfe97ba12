"""What the analysis of one measurement leaves for the pooling of all: arrays with their units, and attributes."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from mesoscale.settings import TopographySettings
from mesoscale.topography.analysis import analyse_scan, limited_spectrum, thumbnail, trusted
from mesoscale.topography.description.heights import height_quantiles
from mesoscale.topography.description.profile_range import trusted_profile
from mesoscale.topography.description.trusted_range import TrustedSpectrum
from mesoscale.topography.measurements.cleaning import Scan, alignment_effect
from mesoscale.topography.measurements.loading import Measurement
from mesoscale.topography.measurements.profiles import Profile, clean_profile
from mesoscale.topography.profile_conversion import binned_line, line_spectrum
from mesoscale.topography.spectrum import Spectrum

Arrays = dict[str, np.ndarray]
DATASETS = {  # unit, meaning and dimensions of every array of a measurement
    "q": ("1/nm", "wave vector", ("q",)),
    "psd": ("nm^4", "isotropic spectrum, Hann window", ("q",)),
    "modes": ("1", "independent amplitudes behind each value", ("q",)),
    "flat_q": ("1/nm", "wave vector", ("flat_q",)),
    "flat_psd": ("nm^4", "isotropic spectrum, nearly flat window", ("flat_q",)),
    "flat_modes": ("1", "independent amplitudes behind each value", ("flat_q",)),
    "profile_q": ("1/nm", "wave vector along scan lines", ("profile_q",)),
    "profile_psd": ("nm^3", "spectrum along scan lines", ("profile_q",)),
    "lag": ("nm", "distance along scan lines", ("lag",)),
    "autocorrelation": ("nm^2", "height autocorrelation", ("lag",)),
    "heights": ("nm", "cleaned heights, thinned", ("x", "y")),
    "line": ("nm", "levelled heights along the line, thinned", ("x",)),
    "quantiles": ("1", "height over RMS at the normal variables -5, -4.9, ... 6", ("z",)),
}
# what spectra.h5 keeps of each measurement
KEPT = ("q", "psd", "flat_q", "flat_psd", "profile_q", "profile_psd", "lag", "autocorrelation", "heights", "line")
LINE_POINTS = 2000


def record(measured: Measurement, settings: TopographySettings) -> tuple[Arrays, dict[str, Any]]:
    """Arrays (keys of `DATASETS`) and attributes of one measurement.

    Synthetic scans, known to be Gaussian and seen by the tip of the settings, leave neither quantiles nor limits.
    """
    if isinstance(measured.data, Profile):
        arrays, attributes = _profile(measured.data, measured, settings)
    else:
        arrays, attributes = _scan(measured.data, measured, settings)
    if settings.scans:
        attributes["tip_radius_nm"] = measured.tip_radius_nm
        attributes["radius_stated"] = measured.radius_stated
    return arrays, attributes


def _scan(scan: Scan, measured: Measurement, settings: TopographySettings) -> tuple[Arrays, dict[str, Any]]:
    result = analyse_scan(scan, settings)
    spectrum, flat, cleaned = result.spectrum, result.flat_spectrum, result.cleaned
    arrays = {
        "q": spectrum.q,
        "psd": spectrum.psd,
        "modes": spectrum.modes,
        "flat_q": flat.q,
        "flat_psd": flat.psd,
        "flat_modes": flat.modes,
        "profile_q": result.profile_q,
        "profile_psd": result.profile_psd,
        "lag": result.lag_nm,
        "autocorrelation": result.autocorrelation_nm2,
        "heights": thumbnail(cleaned.heights_nm),
    }
    attributes: dict[str, Any] = {
        "length_x_nm": cleaned.lengths_nm[0],
        "length_y_nm": cleaned.lengths_nm[1],
        "pixels_x": cleaned.heights_nm.shape[0],
        "pixels_y": cleaned.heights_nm.shape[1],
        "raw_rms_nm": result.raw_rms_nm,
        "rms_nm": cleaned.rms_nm,
        "spacing": spectrum.spacing,
        "nyquist": spectrum.nyquist,
        "flat_spacing": flat.spacing,
        "steps": "; ".join(cleaned.steps),
    }
    if settings.scans:
        if cleaned.rms_nm > 0:
            arrays["quantiles"] = height_quantiles(cleaned.heights_nm)
        share, skewness = alignment_effect(scan, settings)
        attributes |= {"alignment_share": share, "alignment_skewness": skewness}
        limits = limited_spectrum(cleaned.name, spectrum, cleaned, measured)
        attributes |= _range(limits) | {"form": limits.form}
    return arrays, attributes


def _profile(profile: Profile, measured: Measurement, settings: TopographySettings) -> tuple[Arrays, dict[str, Any]]:
    cleaned = clean_profile(profile, settings)
    limits = trusted_profile(cleaned, measured)
    spectrum = limits.spectrum
    profile_q, profile_psd = line_spectrum(cleaned)
    stride = max(1, -(-len(cleaned.heights_nm) // LINE_POINTS))
    arrays = {
        "q": spectrum.q,
        "psd": spectrum.psd,
        "modes": spectrum.modes,
        "profile_q": profile_q,
        "profile_psd": profile_psd,
        "line": cleaned.heights_nm[::stride].astype(np.float32),
    }
    attributes = {
        "length_x_nm": cleaned.length_nm,
        "pixels_x": len(cleaned.heights_nm),
        "raw_rms_nm": profile.rms_nm,
        "rms_nm": cleaned.rms_nm,
        "spacing": spectrum.spacing,
        "nyquist": spectrum.nyquist,
        "steps": "; ".join(cleaned.steps),
    }
    return arrays, attributes | _range(limits)


def _range(limits: TrustedSpectrum) -> dict[str, Any]:
    return {"trusted_low": limits.low, "trusted_high": limits.high, "limit": limits.limit, "reach": limits.reach}


def in_order(arrays: Mapping[str, Arrays], attributes: Mapping[str, Mapping[str, Any]]) -> dict[str, Arrays]:
    """Records from the smallest measurement to the largest, as `pool` takes them."""
    return dict(sorted(arrays.items(), key=lambda item: (attributes[item[0]]["length_x_nm"], item[0])))


def trusted_record(
    name: str, arrays: Mapping[str, np.ndarray], attributes: Mapping[str, Any], settings: TopographySettings
) -> TrustedSpectrum:
    """Spectrum and trusted range of a recorded measurement."""
    line = is_profile(attributes)
    ends = attributes["spacing"], attributes["nyquist"]
    spectrum = Spectrum(arrays["q"], arrays["psd"], arrays["modes"], *ends, sharp=line)
    if "reach" not in attributes:
        return trusted(name, spectrum, attributes["rms_nm"], settings)
    low, high, limit = (attributes[key] for key in ("trusted_low", "trusted_high", "limit"))
    radius, rms, reach = (float(attributes[key]) for key in ("tip_radius_nm", "rms_nm", "reach"))
    result = TrustedSpectrum(name, spectrum, float(low), float(high), str(limit), radius, rms, reach)
    if line:
        return replace(result, line=binned_line(arrays["profile_q"], arrays["profile_psd"], result.low, result.high))
    side = float(np.sqrt(attributes["length_x_nm"] * attributes["length_y_nm"]))
    # results of earlier versions do not state the form
    return replace(result, side_nm=side, form=float(attributes.get("form", 0.0)))


def is_profile(attributes: Mapping[str, Any]) -> bool:
    """Is this a record of a line profile?"""
    return "length_y_nm" not in attributes
