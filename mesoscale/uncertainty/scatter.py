"""The surface's own randomness put back: from the mean over surfaces to single cells."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mesoscale.uncertainty.surrogate import Surrogate, evaluate

Array = NDArray[np.float64]

FEWEST_RUNS = 20


def with_scatter(
    outputs: Array, surfaces: Sequence[Surrogate | None], direct: tuple[Array, Array], fitted: bool, seed: int
) -> Array:
    """Outputs of single cells: those of the response surfaces times residuals drawn from direct runs.

    Residuals of all outputs of a run are drawn together, which keeps their dependence. They are ratios where a
    response surface is positive throughout (all lengths scale with RMS), else differences.

    Parameters
    ----------
    outputs : closing and opening parameters by the surfaces, shape (m, 8).
    direct : inputs (r, n) and closing and opening parameters (r, 8) of direct runs.
    fitted : whether the surfaces were fitted to these runs; residuals are then widened by the terms' number.

    Returns
    -------
    shape (m, 8); NaN without surface or with fewer than 20 complete runs.
    """
    x, y = direct
    predicted = evaluate(surfaces, x)
    has_surface = np.array([surface is not None for surface in surfaces])
    complete = np.isfinite(y[:, has_surface]).all(axis=1)
    cells = np.full_like(outputs, np.nan)
    if complete.sum() < FEWEST_RUNS:
        return cells
    picks = np.random.default_rng(np.random.SeedSequence([seed, 0x5C])).integers(complete.sum(), size=len(outputs))
    for k, surface in enumerate(surfaces):
        if surface is None:
            continue
        terms = len(surface.degrees) if fitted else 0
        widening = np.sqrt(complete.sum() / max(complete.sum() - terms, 1))
        truth, smooth = y[complete, k], predicted[complete, k]
        if (smooth > 0).all() and (outputs[:, k] > 0).all():
            ratio = truth / smooth
            cells[:, k] = outputs[:, k] * (ratio.mean() + widening * (ratio - ratio.mean()))[picks]
        else:
            difference = truth - smooth
            cells[:, k] = outputs[:, k] + (difference.mean() + widening * (difference - difference.mean()))[picks]
    return cells
