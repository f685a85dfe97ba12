"""Morris' elementary effects over many trajectories (SALib), beside the paper's one star."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mesoscale.extras import needs
from mesoscale.uncertainty.designs import MORRIS_LEVELS, morris_points, morris_problem

Array = NDArray[np.float64]

CONFIDENCE = 0.9


@dataclass(frozen=True)
class Effects:
    """Elementary effects of one output, inputs scaled to [0, 1]; each of shape (n,).

    Attributes
    ----------
    mu_star : mean of their sizes.
    half_width : half of the 90 % interval of mu_star (bootstrap over trajectories).
    sigma : their standard deviation: interaction, curvature and, through an engine, the surface.
    trajectories : those in use; a trajectory with a missing number is left out.
    """

    mu_star: Array
    half_width: Array
    sigma: Array
    trajectories: int


def trajectory_points(inputs: int, trajectories: int, seed: int) -> Array:
    """Trajectories in the unit cube, shape (trajectories, n + 1, n)."""
    return np.array([morris_points(inputs, k, seed) for k in range(trajectories)])


def trajectory_effects(points: Array, y: Array, seed: int, resamples: int = 200) -> Effects:
    """Morris' measures of one output.

    Parameters
    ----------
    points : trajectories in the unit cube, shape (t, n + 1, n).
    y : output along them, shape (t, n + 1).
    """
    with needs("uncertainty"):
        from SALib.analyze import morris  # 2 s to import, needed here alone

    known = np.isfinite(y).all(axis=1)
    inputs = points.shape[2]
    if known.sum() < 2:
        nothing = np.full(inputs, np.nan)
        return Effects(nothing, nothing, nothing, int(known.sum()))
    result = morris.analyze(
        morris_problem(inputs),
        points[known].reshape(-1, inputs),
        y[known].ravel(),
        num_levels=MORRIS_LEVELS,
        num_resamples=resamples,
        conf_level=CONFIDENCE,
        seed=seed,
    )
    mu_star, half_width, sigma = (
        np.ma.filled(result[key], np.nan).astype(float) for key in ("mu_star", "mu_star_conf", "sigma")
    )
    return Effects(mu_star, half_width, sigma, int(known.sum()))
