"""The curves of figure 10: all spectra pooled, and what is fitted to them."""

from collections.abc import Mapping, Sequence

import numpy as np

from mesoscale.topography.description.parameters import Topography
from mesoscale.topography.roughness_spectrum import RoughSpectrum
from mesoscale.topography.spectrum import Spectrum, log_bins

CURVE_POINTS = 200
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
    "band_low": ("nm^4", "lower end of the spectrum's band"),
    "band_high": ("nm^4", "upper end of the spectrum's band"),
    "measurements": ("1", "measurements that see this band; 0: bridged"),
    "truth": ("nm^4", "spectrum of the typical place of the synthetic surface"),
}


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
