"""Fit of the compact law to one branch of a curve.

d_c, C_r and rho_r are nearly degenerate in eq. 13: shifting d_c by x multiplies C_r by exp(-x /
rho_r) and leaves the curve almost as it is. So d_c is not fitted beside the other two but *taken
from the curve* by a stated definition (`contact_separation`), and C_r and rho_r are fitted given
d_c.
"""

import json
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mesoscale.checks import checked_array
from mesoscale.errors import InputError
from mesoscale.law.compact import Law, shielded_hamaker
from mesoscale.law.parameters import PARAMETERS

Array = NDArray[np.float64]


POINTS = 200  # even in separation, to which a branch is resampled
FEWEST_POINTS = 4  # of the curve in contact: two parameters and an error
SHALLOWEST = 0.2  # depth over rho_r; below, a curve shows a straight line
DEEPEST = 200.0  # above, it shows a step
LARGEST_ERROR = 1.0  # relative, of C_r and rho_r; from there on they are not identified
LARGEST_RESIDUAL = 0.15  # misfit over the largest repulsion; from there on a fit is poor


@dataclass(frozen=True)
class LawFit:
    """The law fitted to one branch; parameters that the curve does not determine are NaN.

    Attributes
    ----------
    covariance : covariance of (C_a_GPa_nm, C_r_GPa, rho_r_nm), d_c given, shape (3, 3).
    residual : root mean square misfit of attraction and repulsion over the window, relative to the
        largest repulsive force (1).
    status : `ok`, or why numbers are missing or doubtful.
    """

    d_c_nm: float
    C_a_GPa_nm: float
    C_r_GPa: float
    rho_r_nm: float
    covariance: Array = field(default_factory=lambda: np.full((3, 3), np.nan))
    residual: float = np.nan
    status: str = "ok"

    @property
    def parameters(self) -> Array:
        """The numbers in the order of PARAMETERS."""
        return np.array([getattr(self, name) for name in PARAMETERS])


def contact_separation(
    separation_nm: Array, repulsive_nN: Array, touch_nm: float | None = None
) -> float:
    """Separation d_c of the first touch (opening: the last one); NaN without contact.

    It is an extreme value of the surface, which grows with the sample area.

    Parameters
    ----------
    separation_nm, repulsive_nN : one branch in any order, shape (n,).
    touch_nm : the engine's exact value, if it is known for this branch; else that of the nearest
        point outside.
    """
    order = np.argsort(separation_nm)[::-1]
    h = np.asarray(separation_nm, float)[order]
    f = np.asarray(repulsive_nN, float)[order]
    touching = np.flatnonzero(f > 0)
    if touching.size == 0:
        return np.nan
    if touch_nm is not None and np.isfinite(touch_nm):
        return float(touch_nm)
    return float(h[max(touching[0] - 1, 0)])


def fit_branch(
    separation_nm: ArrayLike,
    repulsive_nN: ArrayLike,
    attractive_nN: ArrayLike,
    cell_area_nm2: float,
    hamaker: float,
    d_c_nm: float | None = None,
) -> LawFit:
    """Fit the law to one branch of a force-separation curve.

    The branch is resampled evenly in separation over [smallest separation, d_c] for the repulsion
    and [smallest separation, d_c + rho_a] for the attraction, so that the engine's choice of steps
    carries no weight. C_a follows linearly. For C_r and rho_r, C_r is eliminated (it is linear
    given rho_r) and the misfit minimised over rho_r alone, which cannot run away along the
    degenerate valley.

    Parameters
    ----------
    separation_nm, repulsive_nN, attractive_nN : the branch, shape (n,), any order; attraction
        negative.
    cell_area_nm2 : area of the cell.
    hamaker : Hamaker constant (1e-18 J).
    d_c_nm : exact separation at contact, where it is known; else it is taken from the curve
        (`contact_separation`).

    Returns
    -------
    LawFit : with status `ok`, `no_contact`, `few_points`, `not_identifiable: why` or `poor_fit`.
        Only `ok` and `poor_fit` carry C_r and rho_r.

    Raises
    ------
    InputError : arrays of unequal length or not finite.
    """
    h = checked_array("law fit: separation_nm", separation_nm, "nm")
    repulsive = checked_array("law fit: repulsive_nN", repulsive_nN, "nN")
    attractive = checked_array("law fit: attractive_nN", attractive_nN, "nN")
    if not (h.ndim == 1 and h.shape == repulsive.shape == attractive.shape):
        raise InputError(
            f"law fit: separation and forces have shapes {h.shape}, {repulsive.shape}, "
            f"{attractive.shape}; one value of each per point is needed"
        )
    order = np.argsort(h, kind="stable")
    h = h[order]
    repulsive = repulsive[order] / cell_area_nm2
    attractive = attractive[order] / cell_area_nm2

    d_c_nm = contact_separation(h, repulsive, d_c_nm)
    if not np.isfinite(d_c_nm) or repulsive.max(initial=0.0) <= 0:
        return LawFit(np.nan, np.nan, np.nan, np.nan, status="no_contact")
    inside = (h < d_c_nm) & (repulsive > 0)
    if inside.sum() < FEWEST_POINTS:
        return LawFit(d_c_nm, np.nan, np.nan, np.nan, status="few_points")
    scale = repulsive.max()

    C_a, C_a_var, misfit_a = _fit_attraction(h, attractive, d_c_nm, hamaker)
    h_r = np.linspace(h.min(), d_c_nm, POINTS, endpoint=False)
    depth = d_c_nm - h_r
    f_r = np.interp(h_r, h, repulsive)
    rho, at_bound = _best_rho(depth, f_r)
    C_r = float(_prefactor(depth, f_r, np.array([rho]))[0][0])
    points = min(int(inside.sum()), POINTS)
    covariance = _covariance(depth, f_r, C_r, rho, C_a_var, points=points)
    misfit_r = np.mean((f_r - C_r * np.expm1(depth / rho)) ** 2)
    residual = float(np.sqrt(misfit_r + misfit_a**2) / scale)

    fit = LawFit(float(d_c_nm), C_a, C_r, rho, covariance, residual)
    if at_bound:
        why = "a step at the end"
        if at_bound > 0:
            why = "the curve is a straight line, only C_r/rho_r is determined"
        return _without_repulsion(fit, f"not_identifiable: {why}")
    relative_error = np.sqrt(np.diag(covariance)[1:]) / np.array([C_r, rho])
    if not np.all(relative_error < LARGEST_ERROR):
        return _without_repulsion(
            fit, "not_identifiable: relative error of C_r or rho_r above the gate"
        )
    if residual > LARGEST_RESIDUAL:
        return replace(fit, status="poor_fit")
    return fit


def _without_repulsion(fit: LawFit, status: str) -> LawFit:
    return replace(fit, C_r_GPa=np.nan, rho_r_nm=np.nan, status=status)


def _fit_attraction(
    h: Array, attractive: Array, d_c: float, hamaker: float
) -> tuple[float, float, float]:
    """C_a (GPa/nm), its variance and the rms misfit (GPa); NaN without a point below the kink."""
    kink = d_c + Law.rho_a_nm
    top = min(kink, h.max())
    if top <= h.min():
        return np.nan, np.nan, 0.0
    grid = np.linspace(h.min(), top, POINTS)
    excess = shielded_hamaker(grid, hamaker, Law.shield_nm) - np.interp(grid, h, attractive)
    arm = np.maximum(kink - grid, 0.0)
    C_a = float(arm @ excess / (arm @ arm))
    misfit = excess - C_a * arm
    points = max(2, min(POINTS, int((h <= top).sum())))
    square = np.mean(misfit**2)
    variance = float(square * len(grid) / (points - 1) / (arm @ arm))
    return C_a, variance, float(np.sqrt(square))


def _prefactor(depth: Array, f: Array, rho: Array) -> tuple[Array, Array]:
    """Best C_r for each rho (shape (k,)) and the sum of squares left."""
    # dividing by the largest value keeps exp finite for any rho
    basis = np.expm1(depth / rho[:, None])
    largest = basis.max(axis=1, keepdims=True)
    basis /= largest
    amplitude = np.maximum(basis @ f, 0.0) / np.einsum("ij,ij->i", basis, basis)
    misfit = ((f - amplitude[:, None] * basis) ** 2).sum(axis=1)
    return amplitude / largest[:, 0], misfit


def _best_rho(depth: Array, f: Array) -> tuple[float, int]:
    """rho_r of least misfit, and -1 or +1 if it lies at the lower or upper end of its range."""
    span = depth.max()
    low = np.log(span / DEEPEST)
    high = np.log(span / SHALLOWEST)
    grid = np.linspace(low, high, 48)
    misfit = _prefactor(depth, f, np.exp(grid))[1]
    best = int(np.argmin(misfit))
    if best in (0, len(grid) - 1):
        side = -1 if best == 0 else 1
        return float(np.exp(grid[best])), side
    left = grid[best - 1]
    right = grid[best + 1]
    for _ in range(9):  # each round shrinks the bracket 5-fold: 2e6 in all
        trial = np.linspace(left, right, 11)
        k = int(np.argmin(_prefactor(depth, f, np.exp(trial))[1]))
        left = trial[max(k - 1, 0)]
        right = trial[min(k + 1, 10)]
    return float(np.exp((left + right) / 2)), 0


def _covariance(
    depth: Array, f: Array, C_r: float, rho: float, C_a_var: float, points: int
) -> Array:
    """Covariance of (C_a, C_r, rho_r) from the misfit, as if `points` were independent."""
    covariance = np.zeros((3, 3))
    covariance[0, 0] = C_a_var
    growth = np.expm1(depth / rho)
    jacobian = np.stack([growth, -C_r * (growth + 1) * depth / rho**2], axis=1)
    misfit = f - C_r * growth
    variance = float(misfit @ misfit) / max(points - 2, 1)
    # scaled columns: C_r and rho differ by many orders of magnitude
    norms = np.linalg.norm(jacobian, axis=0)
    if not np.all(norms > 0):
        return np.full((3, 3), np.nan)
    inverse = np.linalg.pinv((jacobian / norms).T @ (jacobian / norms))
    covariance[1:, 1:] = variance * inverse / np.outer(norms, norms)
    return covariance


def _plain(value: float) -> float | None:
    """Six digits of a number; None of none."""
    return float(f"{value:.6g}") if np.isfinite(value) else None


def row_of(fit: LawFit) -> dict[str, Any]:
    """One row of law/parameters.csv (without run, seed and branch); the covariance as JSON."""
    covariance = [[_plain(value) for value in line] for line in fit.covariance]
    row: dict[str, Any] = dict(zip(PARAMETERS, fit.parameters.tolist(), strict=True))
    row["covariance"] = json.dumps(covariance)
    row["residual"] = fit.residual
    row["status"] = fit.status
    return row
