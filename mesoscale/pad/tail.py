"""The highest of many cells: distribution of first contact, from the cells that are computed.

First contact of a cell is the largest of many heights, so Gumbel's distribution is expected (Fisher and Tippett,
doi:10.1017/S0305004100015681). A pad of N cells then touches first beta ln N further out.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mesoscale.errors import InputError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Tail:
    """Gumbel's distribution of the first contacts of cells.

    Attributes
    ----------
    location_nm : mode.
    scale_nm : beta: the first contact of a pad rises by it per factor e of area.
    covariance : of location and scale, from a bootstrap over cells (nm^2), shape (2, 2).
    cells : cells fitted.
    p_value : of the Cramer-von Mises test with fitted parameters, by a parametric bootstrap; small: not Gumbel.
    """

    location_nm: float
    scale_nm: float
    covariance: Array
    cells: int
    p_value: float

    def first_contact_nm(self, cells: ArrayLike) -> Array:
        """Mean separation at which the first of so many cells touches, and its deviation over pads, shape (2, ...)."""
        count = np.asarray(cells, float)
        mean = self.location_nm + self.scale_nm * (np.euler_gamma + np.log(count))
        return np.stack([mean, np.broadcast_to(np.pi / np.sqrt(6.0) * self.scale_nm, mean.shape)])

    def standard_error_nm(self, cells: ArrayLike) -> Array:
        """Error of that mean by the finite number of cells fitted."""
        arm = np.euler_gamma + np.log(np.asarray(cells, float))
        return np.sqrt(self.covariance[0, 0] + 2 * arm * self.covariance[0, 1] + arm**2 * self.covariance[1, 1])


def fit_tail(first_contact_nm: ArrayLike, resamples: int = 200, seed: int = 0) -> Tail:
    """Gumbel's distribution fitted to the first contacts of cells by maximum likelihood (scipy.stats.gumbel_r).

    Raises
    ------
    InputError : fewer than eight cells, or all alike.
    """
    from scipy import stats  # slow to import

    values = np.asarray(first_contact_nm, float)
    if values.size < 8 or np.ptp(values) == 0:
        raise InputError(f"{values.size} first contacts: accepted are at least 8 different ones; raise pad.cells")
    rng = np.random.default_rng(np.random.SeedSequence([seed, 0x7A11]))
    location, scale = stats.gumbel_r.fit(values)
    statistic = stats.cramervonmises(values, "gumbel_r", (location, scale)).statistic
    drawn, as_large = np.empty((resamples, 2)), 0
    for k in range(resamples):
        drawn[k] = stats.gumbel_r.fit(rng.choice(values, values.size))
        made_up = stats.gumbel_r.rvs(location, scale, values.size, random_state=rng)
        fitted = stats.gumbel_r.fit(made_up)
        as_large += stats.cramervonmises(made_up, "gumbel_r", fitted).statistic >= statistic
    return Tail(
        float(location), float(scale), np.cov(drawn.T), int(values.size), float((as_large + 1) / (resamples + 1))
    )


def tail_summary(tail: Tail, cell_area_nm2: float) -> dict[str, Any]:
    """Content of pad/tail.json: the fit, its test, and first contact of pads of several areas."""
    sizes = 10.0 ** np.arange(6)
    mean, scatter = tail.first_contact_nm(sizes)
    error = tail.standard_error_nm(sizes)
    return {
        "distribution": "gumbel",
        "location_nm": tail.location_nm,
        "scale_nm": tail.scale_nm,
        "covariance_nm2": tail.covariance,
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
