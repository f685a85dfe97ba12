"""Topography results as plain rows and mappings for the result files."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from mesoscale.settings import TopographySettings
from mesoscale.topography.likelihood import TrustedSpectrum
from mesoscale.topography.model import hurst_from_slope, mean_square
from mesoscale.topography.parameters import Topography, inputs

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
    own = {}
    fitted = topography.likelihood
    if fitted is not None:
        used = [item.name for item in spectra if item.trusted.sum() >= 3]
        own = dict(zip(used, fitted.scan_rms(topography.cutoff), strict=True))
    rows = []
    for item in spectra:
        facts = attributes[item.name]
        row = {
            "name": item.name,
            "file": facts["file"],
            "sha256": facts["sha256"],
            "length_nm": min(facts["length_x_nm"], facts["length_y_nm"]),
            "pixels": f"{facts['pixels_x']} x {facts['pixels_y']}",
            "rms_heights_nm": facts["rms_nm"],
            "rms_spectrum_nm": own.get(item.name, float("nan")),
            "trusted_low": item.low,
            "trusted_high": item.high,
            "limit": item.limit,
            "steps": facts["steps"],
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
