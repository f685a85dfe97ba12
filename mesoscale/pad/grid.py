"""Separations that all cells of a pad share."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

STEP_RMS = 0.04
"""Step of separation in and near contact, in units of the RMS height."""
LONGEST_STEP_NM = 0.2
"""And the longest such step."""
DEPTHS = 8
"""Depths of closing from which a pad is opened, at loads in even ratios up to the largest. With 4
the releases of scene `paper` are 0.5 V too low, since wells of single cells move with the depth;
more than 8 move them by 0.1 V."""
LIGHT = 0.02
"""Part of the largest load from which the pad is opened at least; a flat electrode presses with 0.3
to 0.4 of it."""
GROWN = 2.0
"""Steps where only rough places touch, in units of their RMS height: a release is that of half of
it to 1e-6 V."""
BRIDGED = 20
"""Separations at which liquid bridges sites that do not touch."""
FAR_NM = 200.0
"""Beyond, the attraction of the pad is that of two flats to 1 %: 1 + 6 (rms / separation)^2."""
FAR_POINTS = 24
"""Separations up to there."""


@dataclass(frozen=True)
class PadGrid:
    """Separations that all cells of a pad share.

    Attributes
    ----------
    separation_nm : from far to near, shape (n,).
    depths : positions in `separation_nm` from which the pad is opened, shape (k,).
    """

    separation_nm: Array
    depths: NDArray[np.int_]

    @property
    def depth_nm(self) -> Array:
        """Separations from which the pad is opened, falling, shape (k,)."""
        return self.separation_nm[self.depths]


def usual_step_nm(rms_nm: float) -> float:
    """Step of separation in and near contact on surfaces of this RMS height."""
    return min(STEP_RMS * rms_nm, LONGEST_STEP_NM)


def far_nm(top_nm: float) -> Array:
    """Separations, rising, from that of no contact to where a pad attracts as two flats."""
    return np.geomspace(top_nm, max(FAR_NM, 2.0 * top_nm), FAR_POINTS)[1:]


def near_nm(
    lowest_nm: float, touching_nm: Array, step_nm: float, rough_places: bool, reach_nm: float
) -> Array:
    """Separations, rising, from the nearest to where nothing touches and no liquid bridges sites.

    Parameters
    ----------
    touching_nm : first contacts of the cells.
    rough_places : whether places differ: rougher ones touch farther out, and their lengths grow in
        proportion.
    reach_nm : of the liquid; 0: none.
    """
    top_nm = float(touching_nm.max()) + step_nm
    steps = np.ceil((top_nm - lowest_nm) / step_nm) + 1
    near = lowest_nm + step_nm * np.arange(steps)
    if rough_places:
        typical_nm = float(np.median(touching_nm))
        close = near[near < max(typical_nm, lowest_nm + step_nm)]
        near = np.concatenate([close, _growing_nm(close[-1], top_nm, step_nm)])
    if reach_nm:
        bridged = float(near[-1]) + reach_nm * np.arange(1, BRIDGED + 1) / BRIDGED
        near = np.append(near, bridged)
    return near


def _growing_nm(start_nm: float, top_nm: float, step_nm: float) -> Array:
    """Separations beyond a start whose steps grow in proportion."""
    ratio = top_nm / start_nm
    steps = int(np.ceil(np.log(ratio) * start_nm / (GROWN * step_nm)))
    return np.geomspace(start_nm, top_nm, steps + 1)[1:]


def opened_at_loads(
    separation_nm: Array, closed_nm: Sequence[float], loads_GPa: Sequence[float], depths: int
) -> PadGrid:
    """A grid that is opened from depths at loads in even ratios.

    Parameters
    ----------
    separation_nm : from far to near.
    closed_nm, loads_GPa : separations of a closing, falling, and the loads there, rising.
    """
    levels = np.geomspace(LIGHT * loads_GPa[-1], loads_GPa[-1], depths)
    depths_nm = np.interp(levels, loads_GPa, closed_nm)
    places = np.searchsorted(-separation_nm, -depths_nm).clip(max=separation_nm.size - 1)
    return PadGrid(separation_nm, np.unique(places))
