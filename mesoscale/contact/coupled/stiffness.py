"""Pressures that close gaps, nearly: short waves by the nearest neighbours, long ones on a coarser
grid.

The stiffness of a half-space grows with the wave number. Between neighbours alone it levels off
for waves of many sites, which then take the more steps the finer the grid is. So the difference
is added for the waves that a coarser grid holds, as in a two-grid method (Briggs, Henson and
McCormick, A Multigrid Tutorial, 2000). It costs the transforms of the coarser grid.
"""

import math

import numpy as np
from numba import njit
from scipy import fft

from mesoscale.contact.coupled import dense
from mesoscale.contact.coupled.base import Base

COARSER = 4  # sites a side for one of the coarser grid: its transforms cost a sixteenth

Array = np.ndarray


class Stiffness:
    """What closes the gaps of some sites of a map, in single precision."""

    def __init__(self, base: Base):
        rows, columns = (max(2, -(-sites // COARSER)) for sites in base.shape)  # one has no wave
        self.shape = (rows, columns)
        self.stencil = base.stencil.astype(np.float32)
        self.rows = _between(base.shape[0], self.shape[0])
        self.columns = _between(base.shape[1], self.shape[1])
        self.excess = self._excess(base)

    def _excess(self, base: Base) -> Array:
        """Stiffness of long waves less that between neighbours, of the coarser grid's waves."""
        soft = base.long_waves(self.shape).astype(float)
        soft[0, 0] = soft[0, 1]  # the mean has none of its own: as the longest wave
        x = np.fft.fftfreq(self.shape[0], base.shape[0] / self.shape[0] / (2.0 * np.pi))[:, None]
        y = np.fft.rfftfreq(self.shape[1], base.shape[1] / self.shape[1] / (2.0 * np.pi))
        corner, side, _, _, centre = base.stencil[:5]
        near = centre + 2.0 * side * (np.cos(x) + np.cos(y)) + 4.0 * corner * np.cos(x) * np.cos(y)
        share = math.prod(self.shape) / math.prod(base.shape)
        return (share * (1.0 / soft - near)).astype(np.float32)

    def close(self, sites: Array, gap: Array) -> Array:
        """Pressures of some sites from the gaps of all (nx * ny,), which are 0 elsewhere."""
        long = np.zeros(self.shape, np.float32)
        pool(sites, gap, *self.rows, *self.columns, long)
        spectrum = np.asarray(fft.rfft2(long))
        spectrum *= self.excess
        long = np.asarray(fft.irfft2(spectrum, s=long.shape, overwrite_x=True))
        return spread(sites, gap, self.stencil, *self.rows, *self.columns, long)


def _between(sites: int, coarse: int) -> tuple[Array, Array]:
    """The coarse row before each row, and how far the row is from it to the next."""
    place = np.arange(sites) * (coarse / sites)
    before = place.astype(np.int32)
    return before, (place - before).astype(np.float32)


@njit(cache=True)
def pool(sites, gap, row_before, down_share, column_before, over_share, long):
    """Add the gaps of sites to the four coarse sites around each."""
    columns = column_before.size
    for site in sites:
        row = site // columns
        column = site - row * columns
        low = row_before[row]
        high = dense.wrapped(low + 1, long.shape[0])
        left = column_before[column]
        right = dense.wrapped(left + 1, long.shape[1])
        down = down_share[row] * gap[site]
        up = gap[site] - down
        over = over_share[column]
        long[low, left] += up * (np.float32(1.0) - over)
        long[low, right] += up * over
        long[high, left] += down * (np.float32(1.0) - over)
        long[high, right] += down * over


@njit(cache=True, fastmath=dense.FAST)
def spread(sites, gap, stencil, row_before, down_share, column_before, over_share, long):
    """Pressures of sites from the gaps of their neighbours and from the coarse sites around."""
    rows = row_before.size
    columns = column_before.size
    pressure = np.empty(sites.size, np.float32)
    for k in range(sites.size):
        site = sites[k]
        row = site // columns
        column = site - row * columns
        before = dense.wrapped(column - 1, columns)
        after = dense.wrapped(column + 1, columns)
        total = np.float32(0.0)
        for i in range(3):
            start = dense.wrapped(row + i - 1, rows) * columns
            total += stencil[3 * i] * gap[start + before]
            total += stencil[3 * i + 1] * gap[start + column]
            total += stencil[3 * i + 2] * gap[start + after]
        low = row_before[row]
        high = dense.wrapped(low + 1, long.shape[0])
        left = column_before[column]
        right = dense.wrapped(left + 1, long.shape[1])
        over = over_share[column]
        upper = long[low, left] + over * (long[low, right] - long[low, left])
        lower = long[high, left] + over * (long[high, right] - long[high, left])
        pressure[k] = total + upper + down_share[row] * (lower - upper)
    return pressure
