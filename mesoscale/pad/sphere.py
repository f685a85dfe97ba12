"""A sphere on a rough film, by Derjaguin's integral over the film's curves.

At the distance r from its lowest point a sphere of radius R is r^2 / 2R higher, so rings of equal steps of separation
have equal areas 2 pi R ds. The force is 2 pi R times the integral of the pressure over separation, each ring with a
deepest closing of its own. The sphere keeps its shape: Hertz's flattening is left out.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mesoscale.pad.memory import PadLaw

Array = NDArray[np.float64]

STEP_NM = 0.05
HIGHEST_RISE_NM = 60.0
"""The sphere is lifted this far in search of its largest pull."""


@dataclass(frozen=True)
class PressedSphere:
    """A sphere that was pressed on a film and pulled off.

    Attributes
    ----------
    load_nN : largest repulsion less attraction while it was pressed.
    pull_off_nN : largest net attraction on the way out.
    work_J_m2 : pull-off over 2 pi R, the work of adhesion that Derjaguin, Muller and Toporov would read from it.
    """

    load_nN: float
    pull_off_nN: float
    work_J_m2: float


def press_sphere(law: PadLaw, deepest_nm: float, radius_nm: float, beyond_J_m2: float) -> PressedSphere:
    """Press a sphere until its lowest point is at a separation of the film, and pull it off.

    Rings farther out than the shallowest computed depth have not touched, and open as they closed.

    Parameters
    ----------
    deepest_nm : that separation, of those from which the pad was opened or between them.
    beyond_J_m2 : energy per area of the attraction from the last separation of the law to infinity.

    Raises
    ------
    InputError : a separation that was not computed.
    """
    ends = float(law.separation_nm[-1])
    rings = np.arange(deepest_nm, ends, STEP_NM)
    load = float(np.trapezoid(law.closing_GPa(rings), rings)) - beyond_J_m2
    rises = np.arange(0.0, min(HIGHEST_RISE_NM, ends - deepest_nm), STEP_NM)
    touched = rings[rings <= law.depth_nm[-1]]
    held = np.array([law.opening_GPa(ring + rises, ring) for ring in touched])
    inner = np.trapezoid(held, touched, axis=0) if touched.size > 1 else np.zeros(rises.size)
    outer = _integral_to_end(law, touched[-1] + rises)
    per_area = inner + outer - beyond_J_m2
    pull = max(-float(per_area.min()), 0.0)
    return PressedSphere(2 * np.pi * radius_nm * load, 2 * np.pi * radius_nm * pull, pull)


def _integral_to_end(law: PadLaw, starts_nm: Array) -> Array:
    """Integral of the closing pressure (nN/nm) from each start to the last separation of the law."""
    at = np.arange(starts_nm.min(), law.separation_nm[-1] + STEP_NM, STEP_NM).clip(max=law.separation_nm[-1])
    pressure = law.closing_GPa(at)
    pieces = 0.5 * (pressure[1:] + pressure[:-1]) * np.diff(at)
    remaining = np.append(np.cumsum(pieces[::-1])[::-1], 0.0)
    return np.interp(starts_nm, at, remaining)
