"""Pressures that close gaps, nearly: short waves by the nearest sites in contact, long ones on a
coarser grid.

Each site and those just before it that touch have an exact stiffness. From these a factor of the
stiffness of all sites is made, row by row (Kolotilina and Yeremin, doi:10.1137/0614004). It knows
the edges of the contact, but it levels off for waves of many sites, which then take the more steps
the finer the grid is. So the difference is added for the waves that a coarser grid holds, as in a
two-grid method (Briggs, Henson and McCormick, A Multigrid Tutorial, 2000). It costs the transforms
of the coarser grid.
"""

import math

import numpy as np
from numba import njit
from scipy import fft

from mesoscale.contact.coupled import dense
from mesoscale.contact.coupled.base import Base

COARSER = 4  # sites a side for one of the coarser grid: its transforms cost a sixteenth
WIDTH = 5  # sites a side of the window around a site
BEFORE = np.array(
    [(row, column) for row in (-2, -1, 0) for column in range(-2, 3) if (row, column) < (0, 0)]
)
"""Sites of the window before the middle one, row by row, from it: a bit each of a pattern."""
LEAST_PIVOT = 1e-6  # of a site's own displacement: all sites of a tiny map have no stiffness alike

Array = np.ndarray


class Stiffness:
    """What closes the gaps of some sites of a map, in single precision.

    Attributes
    ----------
    factors : rows of the factor, one a pattern of sites that touch, (4096, 13); the last column is
        the site's own.
    """

    def __init__(self, base: Base):
        rows, columns = (max(2, -(-sites // COARSER)) for sites in base.shape)  # one has no wave
        self.shape = (rows, columns)
        self.rows = _between(base.shape[0], self.shape[0])
        self.columns = _between(base.shape[1], self.shape[1])
        self.repeats = base.repeats
        self.near = base.near
        patterns = 2 ** len(BEFORE)
        self.factors = np.zeros((patterns, len(BEFORE) + 1), np.float32)
        self.made = np.zeros(patterns, np.bool_)
        self.excess = self._excess(base)
        self.sites: Array | None = None

    def _excess(self, base: Base) -> Array:
        """Stiffness of long waves less that between near sites, of the coarser grid's waves."""
        soft = base.long_waves(self.shape).astype(float)
        soft[0, 0] = soft[0, 1]  # the mean has none of its own: as the longest wave
        x = np.fft.fftfreq(self.shape[0], base.shape[0] / self.shape[0] / (2.0 * np.pi))
        y = np.fft.rfftfreq(self.shape[1], base.shape[1] / self.shape[1] / (2.0 * np.pi))
        surrounded = len(self.factors) - 1
        make_factors(np.array([surrounded], np.uint16), self.near, self.factors, self.made)
        factor = np.zeros((3, WIDTH))  # the middle site is the third of the last row
        factor.flat[: len(BEFORE) + 1] = self.factors[surrounded]
        along_x = np.exp(1j * np.outer(x, np.arange(-2, 1)))
        along_y = np.exp(1j * np.outer(np.arange(-2, 3), y))
        wave = along_x @ factor @ along_y
        near = np.abs(wave) ** 2
        share = math.prod(self.shape) / math.prod(base.shape)
        return (share * (1.0 / soft - near)).astype(np.float32)

    def close(self, sites: Array, gap: Array) -> Array:
        """Pressures of some sites, rising, from the gaps of all (nx * ny,), 0 elsewhere."""
        columns = self.columns[0].size
        if sites is not self.sites:
            self.sites = sites
            self.first = np.searchsorted(sites, np.arange(self.rows[0].size + 1) * columns)
            self.patterns = touching_before(sites, self.first, columns, self.repeats)
            make_factors(self.patterns, self.near, self.factors, self.made)
        long = np.zeros(self.shape, np.float32)
        pool(sites, self.first, gap, *self.rows, *self.columns, long)
        spectrum = np.asarray(fft.rfft2(long))
        spectrum *= self.excess
        long = np.asarray(fft.irfft2(spectrum, s=long.shape, overwrite_x=True))
        near = spread_near(sites, self.first, self.patterns, self.factors, gap, columns)
        return spread_long(sites, self.first, near, *self.rows, *self.columns, long)


def _between(sites: int, coarse: int) -> tuple[Array, Array]:
    """The coarse row before each row, and how far the row is from it to the next."""
    place = np.arange(sites) * (coarse / sites)
    before = place.astype(np.int32)
    return before, (place - before).astype(np.float32)


@njit(cache=True)
def place_before(row, column, rows, columns, place):
    """Places of the sites of the window before one that lies near the edge of a map."""
    for bit in range(BEFORE.shape[0]):
        other = dense.wrapped(row + BEFORE[bit, 0], rows) * columns
        place[bit] = other + dense.wrapped(column + BEFORE[bit, 1], columns)


@njit(cache=True)
def touching_before(sites, first, columns, repeats):
    """Patterns of the sites that touch before each one; beyond the edge none, unless it repeats."""
    rows = first.size - 1
    touches = np.zeros(rows * columns, np.uint8)
    for site in sites:
        touches[site] = 1
    place = np.empty(BEFORE.shape[0], np.int64)
    patterns = np.empty(sites.size, np.uint16)
    for row in range(rows):
        for k in range(first[row], first[row + 1]):
            site = sites[k]
            column = site - row * columns
            pattern = 0
            if row >= 2 and 2 <= column < columns - 2:
                for i in range(WIDTH):
                    pattern |= touches[site - 2 * columns + i - 2] << i
                    pattern |= touches[site - columns + i - 2] << (WIDTH + i)
                pattern |= touches[site - 2] << 10 | touches[site - 1] << 11
            else:
                place_before(row, column, rows, columns, place)
                for bit in range(place.size):
                    beside = column + BEFORE[bit, 1]
                    inside = row + BEFORE[bit, 0] >= 0 and 0 <= beside < columns
                    if repeats or inside:
                        pattern |= touches[place[bit]] << bit
            patterns[k] = pattern
    return patterns


@njit(cache=True)
def make_factors(patterns, near, factors, made):
    """Rows of the factor that some patterns need, where they are not made."""
    width = factors.shape[1]
    place = np.empty(width, np.int64)
    lower = np.empty((width, width))
    row = np.empty(width)
    for pattern in patterns:
        if made[pattern]:
            continue
        made[pattern] = True
        count = 0
        for bit in range(width):
            if bit == width - 1 or pattern >> bit & 1:
                place[count] = bit
                count += 1
        _triangle(place, count, near, lower)
        for i in range(count - 1, -1, -1):
            row[i] = 1.0 if i == count - 1 else 0.0
            for j in range(i + 1, count):
                row[i] -= lower[j, i] * row[j]
            row[i] /= lower[i, i]
            factors[pattern, place[i]] = row[i]


@njit(cache=True)
def _triangle(place, count, near, lower):
    """Lower triangle (Cholesky) of the displacements of a few sites by each other's pressures."""
    for i in range(count):
        for j in range(i + 1):
            rows = abs(place[i] // WIDTH - place[j] // WIDTH)
            columns = abs(place[i] % WIDTH - place[j] % WIDTH)
            total = near[rows, columns]
            for k in range(j):
                total -= lower[i, k] * lower[j, k]
            if i == j:
                lower[i, i] = math.sqrt(max(total, LEAST_PIVOT * near[0, 0]))
            else:
                lower[i, j] = total / lower[j, j]


@njit(cache=True, fastmath=dense.FAST)
def pool(sites, first, gap, row_before, down_share, column_before, over_share, long):
    """Add the gaps of sites to the four coarse sites around each."""
    columns = column_before.size
    line = np.empty(long.shape[1], np.float32)
    for row in range(row_before.size):
        if first[row] == first[row + 1]:
            continue
        line[:] = 0.0
        for k in range(first[row], first[row + 1]):
            column = sites[k] - row * columns
            left = column_before[column]
            over = over_share[column] * gap[sites[k]]
            line[left] += gap[sites[k]] - over
            line[dense.wrapped(left + 1, line.size)] += over
        low = row_before[row]
        high = dense.wrapped(low + 1, long.shape[0])
        down = down_share[row]
        for column in range(line.size):
            long[low, column] += (np.float32(1.0) - down) * line[column]
            long[high, column] += down * line[column]


@njit(cache=True, fastmath=dense.FAST)
def spread_near(sites, first, patterns, factors, gap, columns):
    """Pressures of all sites (nx * ny,) from the gaps of those that touch: the factor, then its
    transpose.
    """
    rows = first.size - 1
    place = np.empty(BEFORE.shape[0], np.int64)
    pressure = np.zeros(gap.size, np.float32)
    for row in range(rows):
        for k in range(first[row], first[row + 1]):
            site = sites[k]
            column = site - row * columns
            factor = factors[patterns[k]]
            total = factor[12] * gap[site]
            if row >= 2 and 2 <= column < columns - 2:
                far = site - 2 * columns - 2
                near = site - columns - 2
                total += factor[10] * gap[site - 2] + factor[11] * gap[site - 1]
                for i in range(WIDTH):
                    total += factor[i] * gap[far + i] + factor[WIDTH + i] * gap[near + i]
                for i in range(WIDTH):
                    pressure[far + i] += factor[i] * total
                    pressure[near + i] += factor[WIDTH + i] * total
                pressure[site - 2] += factor[10] * total
                pressure[site - 1] += factor[11] * total
            else:
                place_before(row, column, rows, columns, place)
                for bit in range(place.size):
                    total += factor[bit] * gap[place[bit]]
                for bit in range(place.size):
                    pressure[place[bit]] += factor[bit] * total
            pressure[site] += factor[12] * total
    return pressure


@njit(cache=True, fastmath=dense.FAST)
def spread_long(sites, first, near, row_before, down_share, column_before, over_share, long):
    """Pressures of sites from those by near sites and from the coarse sites around."""
    columns = column_before.size
    pressure = np.empty(sites.size, np.float32)
    for row in range(row_before.size):
        if first[row] == first[row + 1]:
            continue
        low = row_before[row]
        high = dense.wrapped(low + 1, long.shape[0])
        line = long[low] + down_share[row] * (long[high] - long[low])
        for k in range(first[row], first[row + 1]):
            column = sites[k] - row * columns
            left = column_before[column]
            right = dense.wrapped(left + 1, line.size)
            over = over_share[column] * (line[right] - line[left])
            pressure[k] = near[sites[k]] + line[left] + over
    return pressure
