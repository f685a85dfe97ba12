"""The highest of many cells: distribution of first contact, from the cells that are computed.

First contact of a cell is the largest of many heights, so a generalised extreme value distribution is expected (Fisher
and Tippett, doi:10.1017/S0305004100015681). The largest of N such numbers follows one of the same shape.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.special import gamma

from mesoscale.errors import InputError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Tail:
    """Generalised extreme value distribution of the first contacts of cells.

    Attributes
    ----------
    shape : k of exp(-(1 - k (x - location)/scale)^(1/k)): above 0 there is a highest first contact, 0 is Gumbel's.
    location_nm, scale_nm : its other parameters.
    resampled : the three of cells drawn anew, shape (resamples, 3).
    cells : cells fitted.
    p_value : of the Cramer-von Mises test with fitted parameters, by a parametric bootstrap; small: another
        distribution.
    """

    shape: float
    location_nm: float
    scale_nm: float
    resampled: Array
    cells: int
    p_value: float

    def first_contact_nm(self, cells: ArrayLike) -> Array:
        """Mean separation at which the first of so many cells touches, and its deviation over pads, shape (2, ...)."""
        return _largest_nm((self.shape, self.location_nm, self.scale_nm), np.asarray(cells, float))

    def standard_error_nm(self, cells: ArrayLike) -> Array:
        """Error of that mean by the finite number of cells fitted."""
        count = np.asarray(cells, float)
        return np.std([_largest_nm(tuple(drawn), count)[0] for drawn in self.resampled], axis=0, ddof=1)


def fit_tail(first_contact_nm: ArrayLike, resamples: int = 200, seed: int = 0) -> Tail:
    """Generalised extreme value distribution of the first contacts of cells, by L-moments.

    Raises
    ------
    InputError : fewer than eight cells, or all alike.
    """
    from scipy import stats  # slow to import

    values = np.asarray(first_contact_nm, float)
    if values.size < 8 or np.ptp(values) == 0:
        raise InputError(f"{values.size} first contacts: accepted are at least 8 different ones; raise pad.cells")

    def misfit(numbers: Array, parameters: tuple[float, float, float]) -> float:
        return stats.cramervonmises(numbers, stats.genextreme(*parameters).cdf).statistic

    rng = np.random.default_rng(np.random.SeedSequence([seed, 0x7A11]))
    parameters = _by_l_moments(values)
    here, drawn, as_large = misfit(values, parameters), np.empty((resamples, 3)), 0
    for k in range(resamples):
        drawn[k] = _by_l_moments(rng.choice(values, values.size))
        made_up = np.asarray(stats.genextreme.rvs(*parameters, size=values.size, random_state=rng))
        as_large += misfit(made_up, _by_l_moments(made_up)) >= here
    return Tail(*parameters, drawn, int(values.size), float((as_large + 1) / (resamples + 1)))


def _by_l_moments(values: Array) -> tuple[float, float, float]:
    """Shape, location and scale (Hosking, Wallis and Wood 1985, doi:10.1080/00401706.1985.10488049)."""
    from scipy import stats

    mean, spread, skewness = stats.lmoment(values, order=[1, 2, 3])
    c = 2.0 / (3.0 + skewness) - np.log(2.0) / np.log(3.0)
    shape = 7.8590 * c + 2.9554 * c**2
    scale = spread * shape / ((1.0 - 2.0**-shape) * gamma(1.0 + shape))
    return float(shape), float(mean - scale * (1.0 - gamma(1.0 + shape)) / shape), float(scale)


def _largest_nm(parameters: tuple[float, float, float], count: Array) -> Array:
    """Mean and deviation of the largest of `count` numbers, shape (2, ...)."""
    shape, location, scale = parameters
    narrowed = scale * count**-shape
    mean = location + (scale - narrowed * gamma(1.0 + shape)) / shape
    deviation = narrowed / abs(shape) * np.sqrt(gamma(1.0 + 2.0 * shape) - gamma(1.0 + shape) ** 2)
    return np.stack([mean, deviation])


def tail_summary(tail: Tail, cell_area_nm2: float) -> dict[str, Any]:
    """Content of pad/tail.json: the fit, its test, and first contact of pads of several areas."""
    sizes = 10.0 ** np.arange(6)
    mean, scatter = tail.first_contact_nm(sizes)
    error = tail.standard_error_nm(sizes)
    return {
        "distribution": "generalised extreme value",
        "shape": tail.shape,
        "location_nm": tail.location_nm,
        "scale_nm": tail.scale_nm,
        "covariance": np.cov(tail.resampled.T),
        "cells": tail.cells,
        "p_value": tail.p_value,
        "accepted": tail.p_value > 0.05,
        "pads": [
            {
                "cells": int(size),
                "area_um2": float(size * cell_area_nm2 * 1e-6),
                "first_contact_nm": float(mean[k]),
                "pad_scatter_nm": float(scatter[k]),
                "standard_error_nm": float(error[k]),
            }
            for k, size in enumerate(sizes)
        ],
    }
