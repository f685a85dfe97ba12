"""Adhesion of a pad: the energy per area that opening it costs, and how hard it pulls."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mesoscale.pad.curves import PadCurves

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Adhesion:
    """Adhesion of a pad that is opened from one depth.

    Attributes
    ----------
    depth_nm, load_MPa : separation from which it is opened, and its mean repulsion there.
    zero_force_nm : separation at which the net force is first zero on the way out.
    energy_uJ_m2, flats_uJ_m2 : work per area from there to infinity, and that of two flats so far
        apart.
    pull_off_kPa : largest net attraction on the way.
    """

    depth_nm: float
    load_MPa: float
    zero_force_nm: float
    energy_uJ_m2: float
    flats_uJ_m2: float
    pull_off_kPa: float


def adhesion_of(pad: PadCurves) -> list[Adhesion]:
    """Adhesion of a pad from each depth that was computed, the deepest first."""
    rows = []
    for depth, opened in zip(pad.depth_nm.tolist(), pad.opening, strict=True):
        way = np.isfinite(opened[0])
        separation = pad.separation_nm[way]
        net = opened[:, way].sum(axis=0)
        first = int(np.argmax(net < 0.0))
        if first > 0:
            zero = np.interp(0.0, -net[first - 1 : first + 1], separation[first - 1 : first + 1])
            separation = np.insert(separation[first:], 0, zero)
            net = np.insert(net[first:], 0, 0.0)
        energy = pad.flats.energy_J_m2(separation[-1]) - np.trapezoid(net, separation)
        rows.append(
            Adhesion(
                depth,
                1e3 * float(opened[0, way][0]),
                float(separation[0]),
                1e6 * float(energy),
                1e6 * float(pad.flats.energy_J_m2(separation[0])),
                -1e6 * float(net.min()),
            )
        )
    return rows
