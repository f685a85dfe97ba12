"""Where the measured roughness ends, and what of the RMS height lies before."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from mesoscale.topography.description.parameters import Topography
from mesoscale.topography.description.tip_error import RADIUS_ERROR
from mesoscale.topography.description.trusted_range import TrustedSpectrum
from mesoscale.topography.roughness_spectrum import SpectrumTable, mean_square


def trusted_end(spectra: Sequence[TrustedSpectrum]) -> dict[str, Any]:
    """Where the measured spectrum ends: the largest trusted wave vector, what ends it, and how sure that is.

    The interval holds the ends of the other measurements of that kind, and for a tip what an error of its radius
    makes of the wave vector at which the roughness is as curved as the tip.
    """
    finest = max(spectra, key=lambda item: item.high)
    ends = [item.high for item in spectra if item.high > 0.5 * finest.high]
    shift = 1.0
    if finest.limit == "tip":
        q, psd = finest.spectrum.q, finest.spectrum.psd
        near = (q > 0.6 * finest.high) & (q < 1.2 * finest.high)
        slope = np.polyfit(np.log(q[near]), np.log(psd[near]), 1)[0] if near.sum() > 3 else -3.0
        shift = (1 + RADIUS_ERROR) ** (1 / max(3 + slope / 2, 0.5))  # R q^3 sqrt(C) is held
    return {
        "value": finest.high,
        "unit": "1/nm",
        "interval": [min(ends) / shift, finest.high * shift],
        "limit": finest.limit,
        "measurement": finest.name,
    }


def cutoff_row(topography: Topography, spectra: Sequence[TrustedSpectrum]) -> dict[str, Any]:
    """Distribution of the short-wave cut-off q1: where the power law is seen to end, else where the instrument does.

    In the second case the surface goes on beyond: such a q1 says which roughness is known, and not where it ends.
    """
    if topography.line_fit is not None and not topography.q1_limited:
        return {"distribution": "fixed", "a": topography.q1}
    low, high = trusted_end(spectra)["interval"]
    return {"distribution": "uniform", "a": low, "b": high} if low < high else {"distribution": "fixed", "a": high}


def rms_before(
    q1: Mapping[str, Any], rms: Mapping[str, Any], topography: Topography, surface: Mapping[str, Any]
) -> dict[str, Any]:
    """Distribution of the RMS height of the waves up to the middle of the cut-off.

    Parameters
    ----------
    q1, rms : distributions, uniform or fixed; the RMS height is that up to the finest Nyquist wave vector, or, with a
        measured spectrum, that of all of it.
    surface : entries of `contact.surface`; empty: eq. 9 as fitted.
    """
    cut = 0.5 * (q1["a"] + q1.get("b", q1["a"]))
    if surface:
        table = SpectrumTable(surface["spectrum"]["q"], surface["spectrum"]["psd"])
        share = table.mean_square(cut) / table.mean_square(np.inf)
    else:
        fitted = topography.likelihood or topography.line_fit
        if fitted is None:
            return dict(rms)
        before, all_of_it = (mean_square(1.0, fitted.q0, fitted.slope, end) for end in (cut, topography.cutoff))
        share = min(before / all_of_it, 1.0)
    return {**rms, **{key: float(rms[key] * np.sqrt(share)) for key in ("a", "b") if key in rms}}
