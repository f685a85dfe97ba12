"""What a device needs from the force-separation law: total pressure, its slope, and many samples at once."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mesoscale.law.compact import Law, pressure
from mesoscale.law.parameters import PARAMETERS

Array = NDArray[np.float64]

SAMPLED = (*PARAMETERS, "hamaker")  # what differs between samples; the lengths rho_a and shield are fixed


def pressure_GPa(separation_nm: ArrayLike, law: Law) -> Array:
    """Total contact pressure, positive when the electrode is pushed away."""
    attractive, repulsive = pressure(separation_nm, law)
    return attractive + repulsive


def slope_GPa_nm(separation_nm: ArrayLike, law: Law) -> Array:
    """dp/ds of the total pressure; at the law's two kinks the side of smaller separation is taken."""
    separation = np.asarray(separation_nm, dtype=float)
    d_c, rho_r = np.asarray(law.d_c_nm), np.asarray(law.rho_r_nm)
    cube = np.maximum(separation, 0.0) ** 3 + law.shield_nm**3
    far = np.where(separation > 0, np.asarray(law.hamaker) * separation**2 / (2 * np.pi * cube**2), 0.0)
    near = np.where(separation <= onset_nm(law), np.asarray(law.C_a_GPa_nm), 0.0)
    depth = np.maximum(d_c - separation, 0.0)
    stiffness = np.where(separation <= d_c, np.asarray(law.C_r_GPa) / rho_r * np.exp(depth / rho_r), 0.0)
    return far + near - stiffness


def onset_nm(law: Law) -> Array:
    """Separation d_c + rho_a where the near attraction begins."""
    return np.asarray(law.d_c_nm, dtype=float) + law.rho_a_nm


def scale_adhesion(law: Law, factor: float) -> Law:
    """The law with both attractive terms multiplied by `factor`; 0 leaves the repulsion alone."""
    return replace(law, hamaker=np.asarray(law.hamaker) * factor, C_a_GPa_nm=np.asarray(law.C_a_GPa_nm) * factor)


def samples_of(law: Law) -> int:
    """Number of samples that the law's parameters hold."""
    return np.broadcast(*(np.atleast_1d(getattr(law, name)) for name in SAMPLED)).size


def flat(law: Law, samples: int) -> Law:
    """Every parameter repeated to shape (samples,)."""
    return _map(law, lambda value: np.broadcast_to(value, (samples,)))


def column(law: Law) -> Law:
    """Samples as column vectors, ready to meet rows of separations."""
    return _map(law, lambda value: value[:, None] if value.ndim == 1 else value)


def take(law: Law, index: Any) -> Law:
    """The samples at `index` (indices or a boolean mask)."""
    return _map(law, lambda value: value[index] if value.ndim == 1 else value)


def physical(law: Law) -> NDArray[np.bool_]:
    """Which samples can be used: all parameters finite, C_r and rho_r positive, C_a not negative.

    A response that is linear in the inputs does not know the signs; samples that break them are
    counted and left out, never clipped.
    """
    law = flat(law, samples_of(law))
    finite = np.logical_and.reduce([np.isfinite(getattr(law, name)) for name in PARAMETERS])
    positive = (np.asarray(law.C_r_GPa) > 0) & (np.asarray(law.rho_r_nm) > 0)
    return finite & positive & (np.asarray(law.C_a_GPa_nm) >= 0)


def law_from_columns(columns: Mapping[str, Any], branch: str, rho_a_nm: float, shield_nm: float) -> Law:
    """Law of one branch from columns named `<branch>_<parameter>` and `hamaker`."""
    values = {name: np.asarray(columns[f"{branch}_{name}"], dtype=float) for name in PARAMETERS}
    return Law(**values, hamaker=np.asarray(columns["hamaker"], dtype=float), rho_a_nm=rho_a_nm, shield_nm=shield_nm)


def _map(law: Law, function: Callable[[Array], Array]) -> Law:
    return replace(law, **{name: function(np.asarray(getattr(law, name), float)) for name in SAMPLED})
