"""What an error of the tips' radii makes of the parameters and of the spectrum: part of their intervals."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mesoscale.settings import TopographySettings
from mesoscale.topography.description.confidence import REACH
from mesoscale.topography.description.one_spectrum import OneSpectrum, merge
from mesoscale.topography.description.parameters import Estimate, Topography, analyse
from mesoscale.topography.description.trusted_range import TrustedSpectrum, trusted_range

RADIUS_ERROR = 0.2  # relative; a radius is anywhere within, as a maker states it or a worn tip has it
WIDTH_OF_UNIFORM = np.sqrt(3.0)  # half the width of a uniform distribution over its standard deviation


def with_radius_error(
    topography: Topography, spectra: Sequence[TrustedSpectrum], settings: TopographySettings
) -> Topography:
    """The same estimates with intervals that hold an error of RADIUS_ERROR in every tip's radius.

    All is analysed again with radii smaller and larger by that; half of the difference, as the half width of a uniform
    distribution, is added to the interval in quadrature.
    """
    if not topography.estimates or not any(item.tip_radius_nm > 0 for item in spectra):
        return topography
    other = [
        analyse([_with_radius(item, factor) for item in spectra], settings).estimates
        for factor in (1 - RADIUS_ERROR, 1 + RADIUS_ERROR)
    ]
    estimates = {}
    for name, estimate in topography.estimates.items():
        values = [entry[name].value for entry in other if name in entry]
        estimates[name] = _widened(name, estimate, values) if len(values) == 2 else estimate
    return replace(topography, estimates=estimates)


def spectrum_with_radius_error(one: OneSpectrum | None, spectra: Sequence[TrustedSpectrum]) -> OneSpectrum | None:
    """The same spectrum whose band holds an error of RADIUS_ERROR in every tip's radius, alike for all of them."""
    if one is None or not any(item.tip_radius_nm > 0 for item in spectra):
        return one
    blunt, sharp = (merge([_with_radius(item, f) for item in spectra]) for f in (1 + RADIUS_ERROR, 1 - RADIUS_ERROR))
    if blunt is None or sharp is None:
        return one
    log_q = np.log(one.q)
    ends = [
        np.interp(log_q, np.log(other.q), other.log_psd - np.interp(np.log(other.q), log_q, one.log_psd))
        for other in (blunt, sharp)
    ]
    return one.with_error((ends[0] - ends[1]) / 2 / WIDTH_OF_UNIFORM)


def _with_radius(item: TrustedSpectrum, factor: float) -> TrustedSpectrum:
    """A measurement as trusted with another radius of its tip."""
    radius = factor * item.tip_radius_nm
    high = min(trusted_range(item.name, item.spectrum, radius).high, item.reach) if radius > 0 else item.high
    return replace(item, tip_radius_nm=radius, high=max(high, 2 * item.low))


def _widened(name: str, estimate: Estimate, values: Sequence[float]) -> Estimate:
    log = name in ("q0", "rms")
    centre, ends, shifted = (np.log(v) if log else np.asarray(v) for v in (estimate.value, estimate.interval, values))
    error = REACH * abs(float(shifted[1] - shifted[0])) / 2 / WIDTH_OF_UNIFORM
    low = centre - np.hypot(centre - ends[0], error)
    high = centre + np.hypot(ends[1] - centre, error)
    interval = (float(np.exp(low)), float(np.exp(high))) if log else (float(low), float(high))
    scatter = min(interval[0], estimate.scatter[0]), max(interval[1], estimate.scatter[1])
    return Estimate(estimate.value, interval, scatter)
