"""What the analysis of one measurement leaves for pooling: arrays with units, and attributes."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from mesoscale.settings import TopographySettings
from mesoscale.topography.description.heights import height_quantiles
from mesoscale.topography.description.trusted_range import (
    TRUST,
    TrustedSpectrum,
    curvature,
    trusted_map,
    trusted_profile,
)
from mesoscale.topography.measurements.cleaning import Scan, alignment_effect, clean
from mesoscale.topography.measurements.loading import Measurement
from mesoscale.topography.measurements.profiles import clean_profile
from mesoscale.topography.profile_conversion import binned_line, line_spectrum
from mesoscale.topography.spectrum import Spectrum

Arrays = dict[str, np.ndarray]
DATASETS = {  # unit, meaning and dimensions of every array of a measurement
    "q": ("1/nm", "wave vector", ("q",)),
    "psd": ("nm^4", "isotropic spectrum, Hann window", ("q",)),
    "modes": ("1", "independent amplitudes behind each value", ("q",)),
    "profile_q": ("1/nm", "wave vector along a line profile", ("profile_q",)),
    "profile_psd": ("nm^3", "spectrum along a line profile", ("profile_q",)),
    "heights": ("nm", "cleaned heights, thinned", ("x", "y")),
    "line": ("nm", "levelled heights along the line, thinned", ("x",)),
    "quantiles": ("1", "height over RMS at the normal variables -5, -4.9, ... 6", ("z",)),
}
KEPT = ("q", "psd", "profile_q", "profile_psd", "heights", "line")
"""What spectra.h5 keeps of each measurement."""


def record(measured: Measurement, settings: TopographySettings) -> tuple[Arrays, dict[str, Any]]:
    """Arrays (keys of `DATASETS`) and attributes of one measurement."""
    data = measured.data
    arrays = {}
    attributes = {}
    if isinstance(data, Scan):
        cleaned = clean(data, settings)
        limits = trusted_map(cleaned, measured)
        (length_x, length_y) = cleaned.lengths_nm
        pixels = cleaned.heights_nm.shape
        share, skewness = alignment_effect(data, settings)
        attributes = {"length_y_nm": length_y, "pixels_y": pixels[1], "form": limits.form}
        attributes |= {
            "alignment_share": share,
            "alignment_skewness": skewness,
            "treatment": limits.treatment,
        }
        arrays["heights"] = _thinned(cleaned.heights_nm, 256)
        if cleaned.rms_nm > 0:
            arrays["quantiles"] = height_quantiles(cleaned.heights_nm)
    else:
        cleaned = clean_profile(data, settings)
        limits = trusted_profile(cleaned, measured)
        length_x = data.length_nm
        pixels = data.heights_nm.shape
        arrays["profile_q"], arrays["profile_psd"] = line_spectrum(cleaned)
        arrays["line"] = _thinned(cleaned.heights_nm, 2000)
    attributes["parabola"] = any(
        "quadratic" in step or "parabola" in step for step in cleaned.steps
    )
    spectrum = limits.spectrum
    arrays |= {"q": spectrum.q, "psd": spectrum.psd, "modes": spectrum.modes}
    return arrays, attributes | {
        "length_x_nm": length_x,
        "pixels_x": pixels[0],
        "rms_nm": cleaned.rms_nm,
        "unfiltered_rms_nm": limits.rms_nm,
        "spacing": spectrum.spacing,
        "nyquist": spectrum.nyquist,
        "trusted_low": limits.low,
        "trusted_high": limits.high,
        "limit": limits.limit,
        "reach": limits.reach,
        "tip_radius_nm": measured.tip_radius_nm,
        "radius_stated": measured.radius_stated or not _tip_matters(limits),
        "steps": "; ".join(cleaned.steps),
    }


def _tip_matters(limits: TrustedSpectrum) -> bool:
    """Would a tip as blunt as many are, four times the radius taken, end what a map shows?"""
    q, psd = limits.spectrum.q, limits.spectrum.psd
    seen = (q >= limits.low) & (q <= limits.high)
    curved = curvature(4 * limits.tip_radius_nm, q[seen], psd[seen])
    return bool((curved > TRUST.curved).any())


def _thinned(heights: np.ndarray, largest: int) -> np.ndarray:
    """Heights thinned to at most `largest` points a side, single precision."""
    stride = max(1, -(-max(heights.shape) // largest))
    return heights[(slice(None, None, stride),) * heights.ndim].astype(np.float32)


def in_order(
    arrays: Mapping[str, Arrays], attributes: Mapping[str, Mapping[str, Any]]
) -> dict[str, Arrays]:
    """Records from the smallest measurement to the largest, as `pool` takes them."""

    def size(name: str) -> tuple[float, str]:
        return attributes[name]["length_x_nm"], name

    return {name: arrays[name] for name in sorted(arrays, key=size)}


def copies(
    arrays: Mapping[str, Mapping[str, np.ndarray]], attributes: Mapping[str, Mapping[str, Any]]
) -> dict[str, str]:
    """Measurements that hold what an earlier file of the same bytes holds, with its name."""
    first: dict[tuple[str, bytes], str] = {}
    alike = {}
    for name, data in arrays.items():
        if digest := attributes[name].get("sha256"):  # a container has several measurements
            other = first.setdefault((digest, data["psd"].tobytes()), name)
            if other != name:
                alike[name] = other
    return alike


def trusted_record(
    name: str, arrays: Mapping[str, np.ndarray], attributes: Mapping[str, Any]
) -> TrustedSpectrum:
    """Spectrum and trusted range of a recorded measurement."""
    line = is_profile(attributes)
    spacing = attributes["spacing"]
    nyquist = attributes["nyquist"]
    spectrum = Spectrum(arrays["q"], arrays["psd"], arrays["modes"], spacing, nyquist, sharp=line)
    trusted = TrustedSpectrum(
        name,
        spectrum,
        low=float(attributes["trusted_low"]),
        high=float(attributes["trusted_high"]),
        limit=str(attributes["limit"]),
        tip_radius_nm=float(attributes["tip_radius_nm"]),
        rms_nm=float(attributes["unfiltered_rms_nm"]),
        reach=float(attributes["reach"]),
        parabola=bool(attributes["parabola"]),
    )
    if line:
        q = arrays["profile_q"]
        psd = arrays["profile_psd"]
        return replace(trusted, line=binned_line(q, psd, trusted.low, trusted.high))
    side = float(np.sqrt(attributes["length_x_nm"] * attributes["length_y_nm"]))
    return replace(trusted, side_nm=side, form=float(attributes["form"]))


def is_profile(attributes: Mapping[str, Any]) -> bool:
    """Is this a record of a line profile?"""
    return "length_y_nm" not in attributes


def longest_nm(attributes: Mapping[str, Mapping[str, Any]]) -> float:
    """Side of the largest map, or length of a longer line."""
    shorter_sides = (
        min(values["length_x_nm"], values.get("length_y_nm", math.inf))
        for values in attributes.values()
    )
    return max(shorter_sides)
