"""Many samples of the force-separation law at once, and their total pressure."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mesoscale.law.compact import Law, pressure
from mesoscale.law.parameters import BRANCHES, PARAMETERS

Array = NDArray[np.float64]

QUANTILES = {"pressure_q05_GPa": 0.05, "pressure_q50_GPa": 0.5, "pressure_q95_GPa": 0.95}
SAMPLED = (*PARAMETERS, "hamaker")  # what differs between samples; the lengths rho_a and shield are fixed


def pressure_GPa(separation_nm: ArrayLike, law: Law) -> Array:
    """Total contact pressure, positive when the electrode is pushed away."""
    attractive, repulsive = pressure(separation_nm, law)
    return attractive + repulsive


def column(law: Law) -> Law:
    """Samples as column vectors, ready to meet rows of separations."""
    return _map(law, lambda value: value[:, None] if value.ndim == 1 else value)


def law_from_columns(columns: Mapping[str, Any], branch: str) -> Law:
    """Law of one branch from columns named `<branch>_<parameter>` and `hamaker`."""
    d_c, C_a, C_r, rho_r = (np.asarray(columns[f"{branch}_{name}"], dtype=float) for name in PARAMETERS)
    return Law(d_c, C_a, C_r, rho_r, np.asarray(columns["hamaker"], dtype=float))


def _map(law: Law, function: Callable[[Array], Array]) -> Law:
    return replace(law, **{name: function(np.asarray(getattr(law, name), float)) for name in SAMPLED})


def band_rows(columns: Mapping[str, Array], points: int = 301) -> Iterator[dict[str, Any]]:
    """Rows of uq/law.csv: the pressure over samples of the law, branch by branch.

    Parameters
    ----------
    columns : of uq/samples.csv, shape (samples,) each; samples without a positive C_r and rho_r are left out.
    """
    for branch in BRANCHES:
        law = law_from_columns(columns, branch)
        usable = np.logical_and.reduce([np.isfinite(getattr(law, name)) for name in SAMPLED])
        usable &= (np.asarray(law.C_r_GPa) > 0) & (np.asarray(law.rho_r_nm) > 0)
        law = _map(
            law, lambda value, usable=usable: value[usable][:4000]
        )  # quantiles are then known to 1 % in probability
        if not usable.any():
            continue
        touch, decay = (float(np.median(getattr(law, name))) for name in ("d_c_nm", "rho_r_nm"))
        gaps = np.linspace(max(touch - 8.0 * decay, 0.0), touch + law.rho_a_nm + 8.0 * decay, points)
        many = column(law)
        for gap in gaps:
            spread = np.quantile(pressure_GPa(np.array([gap]), many), list(QUANTILES.values()))
            yield {"branch": branch, "gap_nm": float(gap), **dict(zip(QUANTILES, spread.tolist(), strict=True))}
