"""The pressure of a pad at many places at once, each with a deepest closing of its own."""

import numpy as np
from numpy.typing import NDArray

from mesoscale.pad.memory import PadLaw

Array = NDArray[np.float64]

DEPTHS = 96
"""Deepest closings between those that were computed: 8 nm in steps of 0.1 nm."""
RISES = 1200
"""Separations above the deepest closing."""


class LocalPad:
    """Net pressure (GPa) and its slope (GPa/nm) of places of a pad that remember how deep they were closed."""

    def __init__(self, law: PadLaw):
        self.law = law
        self.depth_nm = np.linspace(law.depth_nm[0], law.depth_nm[-1], DEPTHS)
        self.rise_nm = np.linspace(0.0, law.separation_nm[-1] - law.depth_nm[-1], RISES)
        self.opening = np.array([law.opening_GPa(depth + self.rise_nm, depth) for depth in self.depth_nm])

    def __call__(self, separation_nm: Array, deepest_nm: Array) -> tuple[Array, Array]:
        """Pressure and slope, shape of `separation_nm`; places below the computed closing are continued in a line."""
        pressure, slope = self._closing(separation_nm)
        risen = separation_nm - deepest_nm
        remembers = (risen > 0) & (deepest_nm <= self.depth_nm[-1]) & (risen < self.rise_nm[-1])
        if remembers.any():
            pressure[remembers], slope[remembers] = self._opening(risen[remembers], deepest_nm[remembers])
        return pressure, slope

    def _closing(self, separation_nm: Array) -> tuple[Array, Array]:
        s, net = self.law.separation_nm, self.law.closing.sum(axis=0)
        place = np.clip(np.searchsorted(s, separation_nm) - 1, 0, s.size - 2)
        slope = (net[place + 1] - net[place]) / (s[place + 1] - s[place])
        pressure = net[place] + slope * (separation_nm - s[place])
        far = separation_nm > s[-1]
        flats = -self.law.hamaker / (6.0 * np.pi * np.maximum(separation_nm, 1.0) ** 3)
        return np.where(far, flats, pressure), np.where(far, -3.0 * flats / np.maximum(separation_nm, 1.0), slope)

    def _opening(self, risen: Array, deepest_nm: Array) -> tuple[Array, Array]:
        """Linear in depth and rise."""
        depth_step, rise_step = self.depth_nm[1] - self.depth_nm[0], self.rise_nm[1]
        deep = np.clip((deepest_nm - self.depth_nm[0]) / depth_step, 0.0, DEPTHS - 1.0 - 1e-9)
        rise = np.clip(risen / rise_step, 0.0, RISES - 1.0 - 1e-9)
        i, j = deep.astype(int), rise.astype(int)
        share, part = deep - i, rise - j
        low = (1 - share) * self.opening[i, j] + share * self.opening[i + 1, j]
        high = (1 - share) * self.opening[i, j + 1] + share * self.opening[i + 1, j + 1]
        return low + part * (high - low), (high - low) / rise_step
