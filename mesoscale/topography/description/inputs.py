"""What a description hands on: the surface, and distributions of q0, hurst, rms, q1, rms_scatter.

Topography takes each measurement's spectrum as the film's times a factor, C_k = C exp(a_k), so all
waves of a place grow together: RMS heights differ, q0 and slope are the film's. The factors'
standard deviation is estimated with the statistical errors of single measurements taken off. It
holds what differs between instruments, too.

`merged` is the measured spectrum, where the description uses it, and None where it uses eq. 9.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from mesoscale.settings import TopographySettings
from mesoscale.topography.description.cell import mean_square_of_cells, share_on_cells
from mesoscale.topography.description.heights import common_heights
from mesoscale.topography.description.intervals import QUANTILES, REACH, PlaceScatter
from mesoscale.topography.description.one_spectrum import OneSpectrum
from mesoscale.topography.description.parameters import MAX_MISFIT, MOST_APART, Topography
from mesoscale.topography.description.tip import LIFT
from mesoscale.topography.description.trusted_range import TrustedSpectrum
from mesoscale.topography.roughness_spectrum import SpectrumTable, hurst_from_slope, mean_square

Row = dict[str, Any]


def surface_of(
    topography: Topography,
    merged: OneSpectrum | None,
    quantiles: Sequence[np.ndarray],
    settings: TopographySettings,
    cell_nm: float,
) -> dict[str, Any]:
    """Entries of `contact.surface` besides q0, hurst and rms; none for eq. 9.

    Parameters
    ----------
    quantiles : of each scan where measured heights are used; else none.
    """
    if merged is None:
        return {}
    q, psd = merged.carried_on(merged.psd)
    low = 2 * np.pi / cell_nm
    if low > q[0]:  # longer waves do not fit on the cell
        log_first = np.interp(np.log(low), np.log(q), np.log(psd))
        fits = q > low
        psd = np.concatenate([[float(np.exp(log_first))], psd[fits]])
        q = np.concatenate([[low], q[fits]])
    pivot_q0, pivot_hurst = _nearest(topography, merged, settings)
    spectrum = {"q": q.tolist(), "psd": psd.tolist(), "q0": pivot_q0, "hurst": pivot_hurst}
    heights = list(common_heights(quantiles)) if len(quantiles) else []
    return {"spectrum": spectrum, "heights": heights}


def rows_of(
    topography: Topography, merged: OneSpectrum | None, settings: TopographySettings, cell_nm: float
) -> dict[str, Row]:
    """Distributions of q0, hurst and rms over the ranges that the settings ask for.

    Those of eq. 9 are uniform, as the paper's. Of a measured spectrum q0 and rms are uniform in the
    logarithm.

    The RMS height is that of the waves of a cell of side `cell_nm`, and of a film whose spectrum is
    flat beyond, as the pad makes it (`pad.cells`). With a measured spectrum q0 and hurst are
    coordinates that bend the spectrum about the eq. 9 nearest to it, as far as its band allows.
    """
    if merged is None:
        estimates = topography.estimates
        names = [name for name in ("q0", "hurst", "rms") if name in estimates]
        ranges = {name: getattr(estimates[name], settings.ranges) for name in names}
        if "rms" in ranges:
            share, _ = share_on_cells(topography, None, cell_nm)
            ranges["rms"] = np.multiply(ranges["rms"], np.sqrt(share))
    else:
        drawn = merged.draws(places=settings.ranges == "scatter")
        pivot_q0, pivot_hurst = _nearest(topography, merged, settings)
        bend_q0, bend_hurst = _bends(merged, pivot_q0, drawn)
        rms_of_cells = np.sqrt(mean_square_of_cells(merged, drawn, cell_nm))
        # a coordinate, the spectrum itself is the measured one
        hurst_range = [pivot_hurst - bend_hurst, pivot_hurst + bend_hurst]
        ranges = {
            "q0": (pivot_q0 * np.exp(-bend_q0), pivot_q0 * np.exp(bend_q0)),
            "hurst": np.clip(hurst_range, 0.05, 1.95),
            "rms": np.quantile(rms_of_cells, QUANTILES),
        }
    kinds = {name: "uniform" for name in ranges}
    if merged is not None:
        kinds |= {"q0": "log_uniform", "rms": "log_uniform"}
    return {name: _over(low, high, kinds[name]) for name, (low, high) in ranges.items()}


def middle(row: Mapping[str, Any]) -> float:
    """The median of a row."""
    low = row["a"]
    high = row.get("b", row["a"])
    if row["distribution"] == "log_uniform":
        return float(np.sqrt(low * high))
    return float(0.5 * (low + high))


def _over(low: float, high: float, kind: str = "uniform") -> Row:
    return {"distribution": kind, "a": float(low), "b": float(high)}


def _nearest(
    topography: Topography, merged: OneSpectrum, settings: TopographySettings
) -> tuple[float, float]:
    """q0 and Hurst exponent about which the spectrum is bent."""
    fitted = topography.likelihood
    if fitted is None:
        return float(np.sqrt(merged.q[0] * merged.q[-1])), 0.8
    hurst = float(np.clip(hurst_from_slope(fitted.slope, settings.convention), 0.2, 1.8))
    return float(np.clip(fitted.q0, merged.q[0], merged.q[-1])), hurst


def _bends(merged: OneSpectrum, q0: float, drawn: np.ndarray) -> tuple[float, float]:
    """How far ln q0 and the Hurst exponent may be from the pivot, at the intervals' level."""
    logs = np.log(drawn)
    log_q = np.log(merged.q)
    long = merged.q <= q0
    short = merged.q >= q0
    slopes = np.array([-3.0, -3.4])
    if short.sum() > 2:
        slopes = np.polyfit(log_q[short], logs[:, short].T, 1)[0]
    bend_hurst = max(REACH * float(np.std(slopes)) / 2, 0.02)
    bend_q0 = 0.1
    if long.sum() > 1 and short.sum() > 2:
        step = logs[:, short].mean(axis=1) - logs[:, long].mean(axis=1)
        bend_q0 = REACH * float(np.std(step))
        bend_q0 /= max(abs(float(np.mean(slopes))), 1.0)
    return float(np.clip(bend_q0, 0.02, 0.7)), bend_hurst


def trusted_end(spectra: Sequence[TrustedSpectrum]) -> dict[str, Any]:
    """End of the measured spectrum: the largest trusted wave vector, its cause and its interval.

    The interval holds the ends of the other measurements of that kind, and for a tip what an error
    of its radius makes of the wave vector at which the roughness is as curved as the tip.
    """
    finest = max(spectra, key=lambda item: item.high)
    high_ends = [item.high for item in spectra if item.high > 0.5 * finest.high]
    shift = 1.0
    if finest.limit == "tip":
        q, psd = finest.spectrum.q, finest.spectrum.psd
        near = (q > 0.6 * finest.high) & (q < 1.2 * finest.high)
        slope = -3.0
        if near.sum() > 3:
            slope = np.polyfit(np.log(q[near]), np.log(psd[near]), 1)[0]
        shift = (1 + LIFT.radius_error) ** (1 / max(3 + slope / 2, 0.5))  # R q^3 sqrt(C) is held
    interval = [min(high_ends) / shift, finest.high * shift]
    return {
        "value": finest.high,
        "unit": "1/nm",
        "interval": interval,
        "limit": finest.limit,
        "measurement": finest.name,
    }


def cutoff_row(topography: Topography, spectra: Sequence[TrustedSpectrum]) -> Row:
    """Distribution of the cut-off q1: the seen end of the power law, else that of the instrument.

    In the second case the surface goes on beyond: such a q1 says which roughness is known, and not
    where it ends.
    """
    if topography.line_fit is not None and not topography.q1_limited:
        return {"distribution": "fixed", "a": topography.q1}
    low, high = trusted_end(spectra)["interval"]
    return _over(low, high) if low < high else {"distribution": "fixed", "a": high}


def rms_before(
    q1: Mapping[str, Any],
    rms: Mapping[str, Any],
    topography: Topography,
    surface: Mapping[str, Any],
) -> Row:
    """Distribution of the RMS height of the waves up to the middle of the cut-off.

    Parameters
    ----------
    q1, rms : distributions, over a range or fixed; the RMS height is that up to the finest Nyquist
        wave vector, or, with a measured spectrum, that of all of it.
    surface : entries of `contact.surface`; empty: eq. 9 as fitted.
    """
    cut = middle(q1)
    if surface:
        table = SpectrumTable(surface["spectrum"]["q"], surface["spectrum"]["psd"])
        share = table.mean_square(cut) / table.mean_square(np.inf)
    else:
        fitted = topography.likelihood
        if fitted is None:
            return dict(rms)
        before = mean_square(1.0, fitted.q0, fitted.slope, cut)
        all_waves = mean_square(1.0, fitted.q0, fitted.slope, topography.cutoff)
        share = min(before / all_waves, 1.0)
    cut_rms = dict(rms)
    for key in ("a", "b"):
        if key in rms:
            cut_rms[key] = float(rms[key] * np.sqrt(share))
    return cut_rms


def rms_scatter_row(topography: Topography, merged: OneSpectrum | None) -> Row:
    """Distribution of the standard deviation of ln RMS between places.

    Uniform over its interval; half of a normal distribution of the same upper end where it is not
    told from 0. Beyond MOST_APART measurements have no common level.
    """
    fitted = topography.likelihood
    largest = MOST_APART / 2
    between = PlaceScatter()
    if merged is not None:
        between = merged.between
    elif fitted is not None and fitted.misfit <= MAX_MISFIT:
        between = fitted.between
    low, high = (min(end / 2, largest) for end in between.interval())
    if high == 0:  # one measurement
        return {"distribution": "fixed", "a": 0.0}
    if low > 0.1 * high:
        return _over(low, high)
    # of the normal distribution, of whose half 95 % lie below `high`
    deviation = high / 1.9599639845400545
    return {
        "distribution": "truncated_normal",
        "a": 0.0,
        "b": deviation,
        "low": 0.0,
        "high": largest,
    }
