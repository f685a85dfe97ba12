"""Outputs of the law not to be trusted: explained too little by responses, or against physics."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.inputs.distributions import InputTable
from mesoscale.law.parameters import CLOSING, OPENING
from mesoscale.settings.uncertainty import RESAMPLES
from mesoscale.uncertainty.designs import SAMPLE_SEED
from mesoscale.uncertainty.surrogate import Response, evaluate

Array = NDArray[np.float64]

TOLERANCE = 0.05
"""Relative violation of physics that is put down to the scatter of the fit."""
SHARES = np.array([0.1, 0.25, 0.5, 1.0])
"""Of the largest pressure of the fits, at which curves are compared."""


def explained(
    first: Array, second: Array, predicted: Array, rng: np.random.Generator
) -> dict[str, Any]:
    """What a response explains of what inputs can explain, by pairs of runs at equal inputs.

    The covariance of a pair about the mean is the variance that the inputs explain; about the
    prediction it is the mean square error of the response. Scatter between surfaces is in neither.

    Parameters
    ----------
    first, second : an output on the two surfaces, shape (m,).
    predicted : by a response that saw neither, shape (m,).
    """
    middle = np.concatenate([first, second]).mean()
    variance = np.concatenate([first, second]).var()
    explicable = (first - middle) * (second - middle)
    wrong = (first - predicted) * (second - predicted)
    picks = rng.integers(len(first), size=(RESAMPLES, len(first)))
    explicables = explicable[picks].mean(axis=1)
    wrongs = wrong[picks].mean(axis=1)
    known = np.quantile(explicables, 0.05) > 0.0
    shares = 1.0 - wrongs / np.where(explicables > 0.0, explicables, np.nan)
    row: dict[str, Any] = {"surface_share": np.nan, "doubt": "", "explained": np.nan}
    if variance > 0:
        row["surface_share"] = 1.0 - explicable.mean() / variance
    if known:
        row["explained"] = 1.0 - wrong.mean() / explicable.mean()
    if not known:
        row["doubt"] = (
            f"nothing but scatter between surfaces is seen in {len(first)} pairs at equal inputs"
        )
    elif np.nanquantile(shares, 0.95) < 0.8:  # of runs left out; less than it with 95 % fails
        row["doubt"] = (
            f"the response explains {max(row['explained'], 0.0):.0%} of what the inputs explain"
        )
    return row


SYMBOLS = {"e_star": "E*", "h_macro": "H_macro", "h_prime": "H′", "h_film": "H_film"}
"""Inputs with which a contact presses harder, and their symbols in messages."""


def against_physics(
    responses: Sequence[Response | None], table: InputTable, largest_GPa: float
) -> dict[str, str]:
    """Outputs whose response contradicts physics, by name, each with a line that says how.

    On closing, the repulsion at equal separation rises with E* and hardness, and the attraction
    goes with the Hamaker constant. At equal separation opening presses no harder than closing.

    Parameters
    ----------
    largest_GPa : largest pressure of the curves that the law was fitted to.
    """
    if any(response is None for response in responses):
        return {}
    base = table.sample(256, SAMPLE_SEED)
    low, high = table.ranges().T
    base = np.clip(base, low, high)
    reasons = {}
    for name, symbol in SYMBOLS.items():
        if name not in table.names:
            continue
        k = table.names.index(name)
        if high[k] <= low[k]:
            continue
        moved = [_moved(base, k, value) for value in np.linspace(low[k], high[k], 7)]
        laws = [evaluate(responses, x)[:, CLOSING] for x in moved]
        separations = _separations(laws[len(laws) // 2], largest_GPa)
        pressures = np.array([_repulsion(law, separations).mean(axis=0) for law in laws])
        course = pressures / (SHARES * largest_GPa)
        fall = float((np.maximum.accumulate(course) - course).max())
        if fall > TOLERANCE:
            line = (
                f"on closing, the pressure at equal separation falls by {fall:.0%} where {symbol}"
                " rises"
            )
            reasons |= {"C_r_GPa": line, "rho_r_nm": line}
    if "hamaker" in table.names and high[k := table.names.index("hamaker")] > low[k]:
        lowest = evaluate(responses, _moved(base, k, low[k]))[:, CLOSING][:, 1].mean()
        highest = evaluate(responses, _moved(base, k, high[k]))[:, CLOSING][:, 1].mean()
        rise = highest / lowest - 1.0
        due = high[k] / low[k] - 1.0
        if abs((1.0 + rise) / (1.0 + due) - 1.0) > TOLERANCE:
            reasons["C_a_GPa_nm"] = (
                f"it changes by {rise:.0%} where the Hamaker constant rises by {due:.0%}"
            )
    both = evaluate(responses, base)
    closing = both[:, CLOSING]
    opening = both[:, OPENING]
    separations = _separations(closing, largest_GPa)
    limit = (1.0 + TOLERANCE) * SHARES * largest_GPa
    harder = (_repulsion(opening, separations) > limit).any(axis=1).mean()
    if harder > TOLERANCE:
        line = (
            f"opening presses harder than closing at equal separation at {harder:.0%} of the inputs"
        )
        reasons |= {"delta_C_r_GPa": line, "delta_rho_r_nm": line}
    return reasons


def _moved(base: Array, k: int, value: float) -> Array:
    x = base.copy()
    x[:, k] = value
    return x


def _separations(laws: Array, largest_GPa: float) -> Array:
    """Separations (nm) at which laws (m, 4) repel with shares of a pressure, (m, len(SHARES))."""
    d_c, _, C_r, rho_r = laws.T[:, :, None]
    return d_c - rho_r * np.log1p(SHARES * largest_GPa / C_r)


def _repulsion(laws: Array, separation_nm: Array) -> Array:
    d_c, _, C_r, rho_r = laws.T[:, :, None]
    return C_r * np.expm1(np.maximum(d_c - separation_nm, 0.0) / rho_r)
