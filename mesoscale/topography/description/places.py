"""How much places of a film differ, beside how well its typical place is known.

Topography takes each measurement's spectrum as the film's times a factor, C_k = C exp(a_k), so all waves of a place
grow together: RMS heights differ, q0 and slope are the film's. The factors' standard deviation is estimated with the
statistical errors of single measurements taken off. It holds what differs between instruments, too.
"""

from typing import Any

import numpy as np

from mesoscale.topography.description.confidence import QUANTILES
from mesoscale.topography.description.one_spectrum import OneSpectrum
from mesoscale.topography.description.parameters import MAX_MISFIT, MOST_APART, Topography


def rms_scatter_row(topography: Topography, one: OneSpectrum | None) -> dict[str, Any]:
    """Distribution of the standard deviation of ln RMS between places, uniform over its interval.

    n normal factors of variance s^2 have (n - 1) s^2 / chi^2 for their true variance (chi-squared, n - 1 degrees of
    freedom). Beyond MOST_APART measurements have no common level.

    Parameters
    ----------
    one : spectrum in use; None: eq. 9.
    """
    fitted = topography.likelihood
    if one is not None:
        count, between = len(one.names), one.place_sd
    elif fitted is not None and fitted.misfit <= MAX_MISFIT:
        count, between = len(fitted.amplitudes), fitted.amplitude_sd
    else:
        count, between = 0, 0.0
    if between == 0:  # one measurement, or places that do not differ
        return {"distribution": "fixed", "a": 0.0}
    from scipy.special import gammaincinv

    chi_squared = 2 * gammaincinv((count - 1) / 2, QUANTILES[::-1])
    low, high = np.minimum(between * np.sqrt((count - 1) / chi_squared), MOST_APART) / 2
    return {"distribution": "uniform", "a": float(low), "b": float(high)}
