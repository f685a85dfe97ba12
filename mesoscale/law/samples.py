"""The band of many samples of the force-separation law."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.law.compact import Law, pressure
from mesoscale.law.parameters import BRANCHES, PARAMETERS

Array = NDArray[np.float64]

QUANTILES = {"pressure_q05_GPa": 0.05, "pressure_q50_GPa": 0.5, "pressure_q95_GPa": 0.95}


def band_rows(columns: Mapping[str, Array], points: int = 301) -> Iterator[dict[str, Any]]:
    """Rows of uncertainty/law.csv: pressure over samples of the law; positive: repulsive.

    Parameters
    ----------
    columns : of uncertainty/samples.csv, shape (samples,) each; samples without a positive C_r and
        rho_r are left out.
    """
    for branch in BRANCHES:
        parameters = [columns[f"{branch}_{name}"] for name in PARAMETERS]
        values = np.array([*parameters, columns["hamaker"]], float)
        C_r, rho_r = values[2:4]
        usable = np.isfinite(values).all(axis=0) & (C_r > 0) & (rho_r > 0)
        if not usable.any():
            continue
        # quantiles are then known to 1 % in probability
        law = Law(*values[:, usable][:, :4000, None])
        touch = float(np.median(np.asarray(law.d_c_nm)))
        decay = float(np.median(np.asarray(law.rho_r_nm)))
        nearest = max(touch - 8.0 * decay, 0.0)
        furthest = touch + law.rho_a_nm + 8.0 * decay
        for gap in np.linspace(nearest, furthest, points):
            attractive, repulsive = pressure(np.array([gap]), law)
            spread = np.quantile(attractive + repulsive, list(QUANTILES.values()))
            quantiles = dict(zip(QUANTILES, spread.tolist(), strict=True))
            yield {"branch": branch, "gap_nm": float(gap), **quantiles}
