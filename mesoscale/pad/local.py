"""The pressure of a pad at many places at once, each with a deepest closing of its own.

A place that comes closer than ever follows the closing curve of the pad. One that rises again
follows an opening from its deepest closing. A table holds openings from `MEMORY_DEPTHS` of these,
at `MEMORY_RISES` rises above each.
"""

from copy import copy

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mesoscale.pad.curves import PadCurves, attracting

Array = NDArray[np.float64]

FADE_NM = 1.0
"""Rise over which a difference between the end of closing and the start of opening fades, where
push and pull nearly cancel."""
MEMORY_DEPTHS = 96
"""Deepest closings of the table, evenly between those that were computed: some 0.1 nm apart."""
MEMORY_RISES = 1200
"""Rises above a deepest closing in the table."""
HIGHEST_RISE_NM = 60.0
"""Largest rise in the table. Beyond it closing and opening are the same attraction, but for coarse
films."""
COARSE_NM = 120.0
"""Shallowest computed depth from which a film counts as coarse: its table goes on for as long as
closing and opening differ. Films of scene `paper` have 90 nm at most."""
SAME = 1e-7
"""Difference of closing and opening, over the largest repulsion, below which they are the same:
1 Pa of 10 MPa, the accuracy of a beam's balance."""


class LocalPad:
    """Net pressure (GPa) and its slope (GPa/nm) of places of a pad that remember how deep they were
    closed.
    """

    def __init__(self, curves: PadCurves):
        self.curves = curves
        # in a row in memory, whichever way the curves came: the loops are compiled once
        self.at_nm = np.ascontiguousarray(curves.separation_nm)
        self.closing = curves.closing.sum(axis=0)
        deepest_nm, shallowest_nm = curves.depth_nm[[0, -1]]
        self.depth_nm = np.linspace(deepest_nm, shallowest_nm, MEMORY_DEPTHS)
        highest_nm = HIGHEST_RISE_NM
        if shallowest_nm > COARSE_NM:
            highest_nm = max(HIGHEST_RISE_NM, _reach_nm(curves))
        highest_nm = min(curves.separation_nm[-1] - shallowest_nm, highest_nm)
        self.rise_nm = np.linspace(0.0, highest_nm, MEMORY_RISES)
        self.opening = curves.opened(self.rise_nm, self.depth_nm).sum(axis=1)

    @property
    def tables(self) -> tuple[Array, Array, Array, Array, Array, float, float]:
        """What `pad_pressure` takes of the pad."""
        flats = self.curves.flats
        return (
            self.at_nm,
            self.closing,
            self.depth_nm,
            self.rise_nm,
            self.opening,
            flats.hamaker,
            flats.offset_nm,
        )

    def attracting(self, times: float, bare: "LocalPad") -> "LocalPad":
        """The pad with `times` its attraction, from that without any: pressures are linear in
        it.
        """
        pad = copy(self)
        pad.curves = attracting(self.curves, times)
        pad.closing = bare.closing + times * (self.closing - bare.closing)
        pad.opening = bare.opening + times * (self.opening - bare.opening)
        return pad

    def __call__(self, separation_nm: Array, deepest_nm: Array) -> tuple[Array, Array]:
        """Pressure and slope, of the shape (e, p) of both; continued in a line below the computed
        closing.
        """
        pressure = np.empty_like(separation_nm)
        slope = np.empty_like(separation_nm)
        pad_pressure(separation_nm, deepest_nm, pressure, slope, *self.tables)
        return pressure, slope


def _reach_nm(curves: PadCurves) -> float:
    """Largest rise above a computed depth at which opening and closing still differ."""
    same_GPa = SAME * float(curves.closing[0].max())
    difference_GPa = np.abs(curves.opening.sum(axis=1) - curves.closing.sum(axis=0))
    differ = difference_GPa > same_GPa  # not so below the depth, where there is no number
    last = differ.shape[1] - 1 - differ[:, ::-1].argmax(axis=1)
    rises_nm = np.where(differ.any(axis=1), curves.separation_nm[last] - curves.depth_nm, 0.0)
    return float(rises_nm.max())


@njit(cache=True)
def pad_pressure(
    separation_nm,
    deepest_nm,
    pressure,
    slope,
    at_nm,
    closing,
    depth_nm,
    rise_nm,
    opening,
    hamaker,
    offset_nm,
):
    """Set net pressure (GPa) and slope (GPa/nm) of a pad at places with a deepest closing of their
    own; all (e, p).

    A place that was closed and has risen since opens along its own curve. All others close: along
    the curve, and beyond its end with the attraction of the flats.
    """
    for e in range(separation_nm.shape[0]):
        for g in range(separation_nm.shape[1]):
            s = separation_nm[e, g]
            deep = deepest_nm[e, g]
            risen = s - deep
            if risen > 0.0 and deep <= depth_nm[-1] and risen < rise_nm[-1]:
                ended = _closed(deep, at_nm, closing)
                pressure[e, g], slope[e, g] = _opened(
                    deep, risen, ended, depth_nm, rise_nm, opening
                )
            elif s > at_nm[-1]:
                pressure[e, g] = -hamaker / (6.0 * np.pi * (s + offset_nm) ** 3)
                slope[e, g] = -3.0 * pressure[e, g] / (s + offset_nm)
            else:
                k = _piece(s, at_nm)
                slope[e, g] = (closing[k + 1] - closing[k]) / (at_nm[k + 1] - at_nm[k])
                pressure[e, g] = closing[k] + slope[e, g] * (s - at_nm[k])


@njit(cache=True)
def _piece(s, at_nm):
    """First node of the straight piece at a separation; beyond the ends, of the nearest piece."""
    return min(max(np.searchsorted(at_nm, s) - 1, 0), at_nm.size - 2)


@njit(cache=True)
def _closed(s, at_nm, closing):
    """Pressure (GPa) of a pad that closes, at a separation."""
    k = _piece(s, at_nm)
    share = (s - at_nm[k]) / (at_nm[k + 1] - at_nm[k])
    return closing[k] + share * (closing[k + 1] - closing[k])


@njit(cache=True)
def _opened(deep, risen, ended, depth_nm, rise_nm, opening):
    """Pressure (GPa) and slope of a place that has risen (nm) from its deepest closing.

    Between the nodes of the table the pressure p is bilinear. It starts where closing `ended`, to
    the last digit: a step there would never come to rest. So p is multiplied by
    ended / p(risen = 0). A ratio says nothing where push and pull nearly cancel. There the
    difference is added, and fades over `FADE_NM`.
    """
    depth_step = max(depth_nm[1] - depth_nm[0], 1e-9)  # 1e-9: a pad of one depth
    rise_step = rise_nm[1] - rise_nm[0]
    x = min(max((deep - depth_nm[0]) / depth_step, 0.0), depth_nm.size - 1 - 1e-9)
    y = min(max(risen / rise_step, 0.0), rise_nm.size - 1 - 1e-9)
    i = int(x)
    j = int(y)
    u = x - i
    v = y - j

    # along the depths, at the start of opening and at the rises below and above
    start = (1 - u) * opening[i, 0] + u * opening[i + 1, 0]
    low = (1 - u) * opening[i, j] + u * opening[i + 1, j]
    high = (1 - u) * opening[i, j + 1] + u * opening[i + 1, j + 1]

    if start > 0.0 and 0.5 * start < ended < 2.0 * start:
        scale = ended / start
        difference = 0.0
    else:
        scale = 1.0
        difference = ended - start
    if risen >= FADE_NM:
        difference = 0.0
    pressure = scale * (low + v * (high - low)) + difference * (1.0 - risen / FADE_NM)
    slope = scale * (high - low) / rise_step - difference / FADE_NM
    return pressure, slope
