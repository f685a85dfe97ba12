"""What a description hands on: distributions of q0, hurst, rms, q1 and of the scatter between
places, and the surface.

Topography takes each measurement's spectrum as the film's times a factor, C_k = C exp(a_k), so all
waves of a place grow together: RMS heights differ, q0 and slope are the film's. The factors'
standard deviation is estimated with the statistical errors of single measurements taken off. It
holds what differs between instruments, too.

`one` is the measured spectrum everywhere, where the description uses it, and None where it uses eq.
9."""

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
    one: OneSpectrum | None,
    quantiles: Sequence[np.ndarray],
    settings: TopographySettings,
    cell_nm: float,
) -> dict[str, Any]:
    """What random surfaces are made from besides q0, hurst and rms: entries of `contact.surface`;
    none for eq. 9.

    Parameters
    ----------
    quantiles : of each scan where measured heights are used; else none.
    """
    if one is None:
        return {}
    q, psd = one.carried_on(one.psd)
    low = 2 * np.pi / cell_nm
    if low > q[0]:  # longer waves do not fit on the cell
        first = float(np.exp(np.interp(np.log(low), np.log(q), np.log(psd))))
        q, psd = np.concatenate([[low], q[q > low]]), np.concatenate([[first], psd[q > low]])
    pivot_q0, pivot_hurst = _nearest(topography, one, settings)
    return {
        "spectrum": {"q": q.tolist(), "psd": psd.tolist(), "q0": pivot_q0, "hurst": pivot_hurst},
        "heights": list(common_heights(quantiles)) if len(quantiles) else [],
    }


def rows_of(
    topography: Topography, one: OneSpectrum | None, settings: TopographySettings, cell_nm: float
) -> dict[str, Row]:
    """Distributions of q0, hurst and rms over the ranges that the settings ask for.

    Those of eq. 9 are uniform, as the paper's. Of a measured spectrum q0 and rms are uniform in the
    logarithm.

    The RMS height is that of the waves of a cell of side `cell_nm`, and of a film whose spectrum is
    flat beyond, as the pad makes it (`pad.cells`). With a measured spectrum q0 and hurst are
    coordinates that bend the spectrum about the eq. 9 nearest to it, as far as its band allows."""
    if one is None:
        estimates = topography.estimates
        ranges = {
            name: getattr(estimates[name], settings.ranges)
            for name in ("q0", "hurst", "rms")
            if name in estimates
        }
        if "rms" in ranges:
            ranges["rms"] = np.multiply(
                ranges["rms"], np.sqrt(share_on_cells(topography, None, cell_nm)[0])
            )
    else:
        drawn = one.draws(places=settings.ranges == "scatter")
        pivot_q0, pivot_hurst = _nearest(topography, one, settings)
        bend_q0, bend_hurst = _bends(one, pivot_q0, drawn)
        ranges = {
            "q0": (pivot_q0 * np.exp(-bend_q0), pivot_q0 * np.exp(bend_q0)),
            # a coordinate, the spectrum itself is the measured one
            "hurst": np.clip([pivot_hurst - bend_hurst, pivot_hurst + bend_hurst], 0.05, 1.95),
            "rms": np.quantile(np.sqrt(mean_square_of_cells(one, drawn, cell_nm)), QUANTILES),
        }
    by_logarithm = () if one is None else ("q0", "rms")
    return {
        name: _over(ends[0], ends[1], "log_uniform" if name in by_logarithm else "uniform")
        for name, ends in ranges.items()
    }


def middle(row: Mapping[str, Any]) -> float:
    """The median of a row."""
    low = row["a"]
    high = row.get("b", row["a"])
    return float(
        np.sqrt(low * high) if row["distribution"] == "log_uniform" else 0.5 * (low + high)
    )


def _over(low: float, high: float, kind: str = "uniform") -> Row:
    return {"distribution": kind, "a": float(low), "b": float(high)}


def _nearest(
    topography: Topography, one: OneSpectrum, settings: TopographySettings
) -> tuple[float, float]:
    """q0 and Hurst exponent about which the spectrum is bent."""
    fitted = topography.likelihood
    if fitted is None:
        return float(np.sqrt(one.q[0] * one.q[-1])), 0.8
    hurst = float(np.clip(hurst_from_slope(fitted.slope, settings.convention), 0.2, 1.8))
    return float(np.clip(fitted.q0, one.q[0], one.q[-1])), hurst


def _bends(one: OneSpectrum, q0: float, drawn: np.ndarray) -> tuple[float, float]:
    """How far ln q0 and the Hurst exponent may be from the pivot, at the intervals' level."""
    logs = np.log(drawn)
    log_q = np.log(one.q)
    long = one.q <= q0
    short = one.q >= q0
    slopes = (
        np.polyfit(log_q[short], logs[:, short].T, 1)[0]
        if short.sum() > 2
        else np.array([-3.0, -3.4])
    )
    bend_hurst = max(REACH * float(np.std(slopes)) / 2, 0.02)
    bend_q0 = 0.1
    if long.sum() > 1 and short.sum() > 2:
        step = logs[:, short].mean(axis=1) - logs[:, long].mean(axis=1)
        bend_q0 = REACH * float(np.std(step)) / max(abs(float(np.mean(slopes))), 1.0)
    return float(np.clip(bend_q0, 0.02, 0.7)), bend_hurst


def trusted_end(spectra: Sequence[TrustedSpectrum]) -> dict[str, Any]:
    """Where the measured spectrum ends: the largest trusted wave vector, what ends it, and how sure
    that is.

    The interval holds the ends of the other measurements of that kind, and for a tip what an error
    of its radius makes of the wave vector at which the roughness is as curved as the tip."""
    finest = max(spectra, key=lambda item: item.high)
    ends = [item.high for item in spectra if item.high > 0.5 * finest.high]
    shift = 1.0
    if finest.limit == "tip":
        q, psd = finest.spectrum.q, finest.spectrum.psd
        near = (q > 0.6 * finest.high) & (q < 1.2 * finest.high)
        slope = np.polyfit(np.log(q[near]), np.log(psd[near]), 1)[0] if near.sum() > 3 else -3.0
        shift = (1 + LIFT.radius_error) ** (1 / max(3 + slope / 2, 0.5))  # R q^3 sqrt(C) is held
    return {
        "value": finest.high,
        "unit": "1/nm",
        "interval": [min(ends) / shift, finest.high * shift],
        "limit": finest.limit,
        "measurement": finest.name,
    }


def cutoff_row(topography: Topography, spectra: Sequence[TrustedSpectrum]) -> Row:
    """Distribution of the short-wave cut-off q1: where the power law is seen to end, else where the
    instrument does.

    In the second case the surface goes on beyond: such a q1 says which roughness is known, and not
    where it ends."""
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
        wave vector, or,
        with a measured spectrum, that of all of it.
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
        before, all_of_it = (
            mean_square(1.0, fitted.q0, fitted.slope, end) for end in (cut, topography.cutoff)
        )
        share = min(before / all_of_it, 1.0)
    return {**rms, **{key: float(rms[key] * np.sqrt(share)) for key in ("a", "b") if key in rms}}


def rms_scatter_row(topography: Topography, one: OneSpectrum | None) -> Row:
    """Distribution of the standard deviation of ln RMS between places.

    Uniform over its interval; half of a normal distribution of the same upper end where it is not
    told from 0. Beyond MOST_APART measurements have no common level."""
    fitted = topography.likelihood
    most = MOST_APART / 2
    if one is not None:
        between = one.between
    else:
        between = (
            fitted.between if fitted is not None and fitted.misfit <= MAX_MISFIT else PlaceScatter()
        )
    low, high = (min(end / 2, most) for end in between.interval())
    if high == 0:  # one measurement
        return {"distribution": "fixed", "a": 0.0}
    if low > 0.1 * high:
        return _over(low, high)
    deviation = (
        high / 1.9599639845400545
    )  # of the normal distribution, of whose half 95 % lie below `high`
    return {"distribution": "truncated_normal", "a": 0.0, "b": deviation, "low": 0.0, "high": most}
