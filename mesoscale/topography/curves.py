"""The curves of figure 10: all spectra pooled, the fits, and the one spectrum with its band."""

from collections.abc import Sequence

import numpy as np

from mesoscale.topography.pooling import Pooled
from mesoscale.topography.roughness_spectrum import RoughSpectrum
from mesoscale.topography.spectrum import Spectrum, log_bins

CURVES = {  # unit and meaning of every curve in spectra.h5
    "q": ("1/nm", "wave vector"),
    "psd": ("nm^4", "geometric mean of the scans' spectra"),
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
Curves = dict[str, np.ndarray]


def result_curves(pooled: Pooled, typical: RoughSpectrum | None) -> dict[str, Curves]:
    """Groups of curves over q for spectra.h5; `typical` is the truth of synthetic scans."""
    groups = {"pooled": _pooled([item.spectrum for item in pooled.spectra])}
    groups["fits"] = _fits(pooled, typical)
    merged = pooled.merged
    if merged is not None and typical is None:
        low, high = merged.band()
        curves = {"q": merged.q, "psd": merged.psd, "band_low": low, "band_high": high}
        curves["measurements"] = merged.count
        seen = merged.q >= merged.first
        groups["one_spectrum"] = {key: values[seen] for key, values in curves.items()}
    return groups


def _pooled(spectra: Sequence[Spectrum]) -> Curves:
    """Geometric mean C of all scans on common bins of log q."""
    per_decade = 12
    binned = [log_bins(spectrum, per_decade) for spectrum in spectra]
    q = np.concatenate([item.q for item in binned])
    psd = np.concatenate([item.psd for item in binned])
    bins = np.floor(np.log10(q) * per_decade)
    _, index, count = np.unique(bins, return_inverse=True, return_counts=True)
    mean_log_q = np.bincount(index, np.log(q)) / count
    mean_log_psd = np.bincount(index, np.log(psd)) / count
    return {"q": np.exp(mean_log_q), "psd": np.exp(mean_log_psd)}


def _fits(pooled: Pooled, typical: RoughSpectrum | None) -> Curves:
    """The fits on a common grid of q (1/nm), C in nm^4; bounds are those of the line fits."""
    lowest = min(item.spectrum.q[0] for item in pooled.spectra)
    end = pooled.topography.cutoff
    q = np.geomspace(lowest, max(end, 2 * lowest), 200)
    curves = {"q": q}
    line = pooled.topography.line_fit
    if pooled.topography.likelihood is not None:
        curves["likelihood"] = pooled.topography.likelihood.spectrum(end).psd(q)
    if line is not None:
        slopes = {
            "lines": line.slope,
            "shallow_bound": line.slope_low,
            "steep_bound": line.slope_high,
        }
        for name, slope in slopes.items():
            curves[name] = RoughSpectrum(line.plateau, line.q0, slope, end).psd(q)
        curves["plateau_low"] = np.where(q <= line.q0, line.plateau_low, np.nan)
        curves["plateau_high"] = np.where(q <= line.q0, line.plateau_high, np.nan)
    if typical is not None:
        curves["truth"] = typical.psd(q)
    return curves
