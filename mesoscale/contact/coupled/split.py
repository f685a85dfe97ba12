"""Influences of some sites of a half-space on each other, without a transform of the whole grid.

The Green's function is split as in an Ewald sum. A table has its short range, 1/q times erf(q s),
which falls off with the distance r as exp(-r^2 / 4 s^2). Transforms of a coarser grid have the
rest, between cubic splines around the sites (the particle-mesh method of Essmann et al.,
doi:10.1063/1.470117).
"""

import math
from functools import lru_cache

import numpy as np
from numba import njit
from scipy import fft
from scipy.special import erf

from mesoscale.contact.coupled import dense, half_space
from mesoscale.settings.contact import Body

COARSER = 3  # sites for each of the coarser grid
# the same where few sites press many: their short range costs less than a fine grid
COARSER_AFAR = 4
WIDTH = 0.7  # s over the distance of coarse sites
# over the distance of coarse sites: farther ones have no short range; with this and the width
# displacements err by some 1e-3 of the largest
REACH = 7 / 3
PAIRS_PER_SITE = 2  # of the whole grid: more pairs of near sites cost more than its transform

Array = np.ndarray


class Mesh:
    """A half-space in two parts: a table of its short range, and a coarser grid for the rest.

    Attributes
    ----------
    pixels, coarse : sites a side of the grid and of the coarser one.
    table : short range, nm/GPa, (reach + 1, reach + 1).
    rest : compliance of the modes of the coarser grid, over the transform of the splines.
    nodes, weights : coarse sites around each row or column, and their splines, (pixels, 4).
    """

    def __init__(self, compliance: Array, scale: float, coarser: int = COARSER):
        """Take the compliance (nm/GPa) of the modes of a grid, shape (N, N // 2 + 1), L / E*
        (nm/GPa), and the sites for each of the coarser grid.
        """
        self.pixels = pixels = len(compliance)
        self.coarse: int = fft.next_fast_len(max(pixels // coarser, 4), real=True)  # pyright: ignore[reportAttributeAccessIssue]
        narrow = 2.0 * math.pi * WIDTH / self.coarse
        short = compliance * erf(narrow * half_space.wave_numbers(pixels))
        short[0, 0] = 2.0 * scale * narrow / math.pi**1.5  # the limit of small q
        reach = round(REACH * coarser)
        near = np.asarray(fft.irfft2(short, s=(pixels, pixels)))[: reach + 1, : reach + 1]
        self.table = near.astype(np.float32)
        # the long range on the coarse grid, divided by the transform of the splines
        modes = np.fft.fftfreq(self.coarse, 1 / self.coarse).astype(int)
        half_of_modes = modes[: self.coarse // 2 + 1]
        spline = ((2.0 + np.cos(2.0 * np.pi * modes / self.coarse)) / 3.0) ** 2 * (
            pixels / self.coarse
        )
        long_range = (compliance - short)[modes][:, np.abs(half_of_modes)]
        # layers have tails beyond the reach: what they carry on the mean stays in the rest
        long_range[0, 0] = -self._sum_of_table()
        rest = long_range / spline[:, None] / spline[: half_of_modes.size]
        self.rest = rest.astype(np.float32)
        # cubic splines between a site and the four coarse ones around it
        coarse_place = np.arange(pixels) * (self.coarse / pixels)
        nodes = coarse_place.astype(int)[:, None] + np.arange(4)
        self.nodes = (nodes % self.coarse).astype(np.int32)
        x = (coarse_place % 1.0)[:, None]
        weights = [(1 - x) ** 3, 3 * x**3 - 6 * x**2 + 4, 3 * (x + x**2 - x**3) + 1, x**3]
        self.weights = (np.hstack(weights) / 6.0).astype(np.float32)

    def _sum_of_table(self) -> float:
        """Displacements of all sites by the short range of one, summed, nm/GPa."""
        reach = len(self.table) - 1
        steps = np.abs(np.arange(-reach, reach + 1))
        inside = np.add.outer(steps**2, steps**2) <= reach**2
        return float(self.table[np.ix_(steps, steps)][inside].sum(dtype=float))

    def displacement(self, sites: Array, pressure: Array, targets: Array, place: Array) -> Array:
        """Displacement (nm) of some sites by the pressures (GPa) of a few.

        `place` holds the position of each site of the cell in `targets`; outside of their range it
        is another's.
        """
        rows, cols = np.divmod(sites, self.pixels)
        pressure = pressure.astype(np.float32)
        coarse = np.zeros((self.coarse, self.coarse), np.float32)
        spread((rows, cols, self.nodes[rows], self.nodes, self.weights), pressure, coarse)
        all_rows = np.arange(self.coarse)
        room = np.empty(self.rest.size, np.complex128)
        coarse = half_space.convolve(coarse, all_rows, self.rest, room, all_rows)
        moved = np.zeros(targets.size, np.float32)
        press_near(rows, cols, pressure, place, self.pixels, self.table, moved)
        add_between(targets, self.pixels, coarse, self.nodes, self.weights, moved)
        return moved


@lru_cache(maxsize=4)
def afar(pixels: int, length: float, bodies: tuple[Body, ...]) -> Mesh:
    """A half-space of modulus 1 GPa where few sites press many."""
    compliance = half_space.wave_compliance(pixels, length, 1.0, bodies)
    return Mesh(compliance, length, COARSER_AFAR)


class Split:
    """Displacements of known sites by their pressures.

    Attributes
    ----------
    open : whether there are few enough pairs of near sites.
    """

    def __init__(self, compliance: Array, scale: float):
        """Take what `Mesh` takes."""
        self.mesh = Mesh(compliance, scale)
        self.room = np.empty(self.mesh.rest.size, np.complex128)
        self.others = np.empty(PAIRS_PER_SITE * self.mesh.pixels**2, np.int32)
        self.values = np.empty(self.others.size, np.float32)
        self.forget()

    def forget(self) -> None:
        """Know no site."""
        self.open = True
        self.first = np.zeros(1, np.int64)
        self.rows, self.cols = np.empty((2, 0), np.int32)

    def know(self, sites: Array, place: Array) -> bool:
        """Take in further sites at the end of the known ones; whether there are few enough
        pairs.
        """
        old = self.rows.size
        new = sites.size - old
        if not self.open or not new:
            return self.open
        rows, cols = np.divmod(sites, self.mesh.pixels)
        self.rows = rows.astype(np.int32)
        self.cols = cols.astype(np.int32)
        nodes = self.mesh.nodes[self.rows].ravel()
        self.coarse_rows, places = half_space.rows_of(nodes, self.mesh.coarse)
        self.row_nodes = places.reshape(-1, 4).astype(np.int32)
        self.first = np.append(self.first, np.zeros(new, np.int64))
        self.open = pair(
            self.rows,
            self.cols,
            place,
            self.mesh.pixels,
            self.mesh.table,
            old,
            self.first,
            self.others,
            self.values,
        )
        return self.open

    def displacement(self, pressure: Array) -> Array:
        """Displacement (nm) of the known sites by their pressures (GPa), in single precision."""
        coarse = np.zeros((self.coarse_rows.size, self.mesh.coarse), np.float32)
        moved = np.empty_like(pressure)
        around = (self.rows, self.cols, self.row_nodes, self.mesh.nodes, self.mesh.weights)
        spread(around, pressure, coarse)
        coarse = half_space.convolve(
            coarse, self.coarse_rows, self.mesh.rest, self.room, self.coarse_rows
        )
        gather(
            around,
            coarse,
            (self.first, self.others, self.values, self.mesh.table[0, 0]),
            pressure,
            moved,
        )
        return moved


@njit(cache=True)
def pair(rows, cols, place, pixels, table, old, first, neighbours, values):
    """List the earlier sites near each of the sites from `old` on; False where there are too
    many.
    """
    reach = table.shape[0] - 1
    end = first[old]
    for k in range(old, rows.size):
        for i in range(-reach, reach + 1):
            start = dense.wrapped(rows[k] + i, pixels) * pixels
            for j in range(-reach, reach + 1):
                other = place[start + dense.wrapped(cols[k] + j, pixels)]
                if 0 <= other < k and i * i + j * j <= reach * reach:
                    if end == neighbours.size:
                        return False
                    neighbours[end] = other
                    values[end] = table[abs(i), abs(j)]
                    end += 1
        first[k + 1] = end
    return True


@njit(cache=True, fastmath=dense.FAST)
def spread(around, pressure, coarse):
    """Add the pressures of sites to the coarse sites around them; `coarse` has the rows in which
    these lie.
    """
    rows, cols, row_nodes, nodes, weights = around
    for k in range(pressure.size):
        if pressure[k] != 0.0:
            for i in range(4):
                value = pressure[k] * weights[rows[k], i]
                for j in range(4):
                    coarse[row_nodes[k, i], nodes[cols[k], j]] += value * weights[cols[k], j]


@njit(cache=True, fastmath=dense.FAST)
def gather(around, coarse, pairs, pressure, moved):
    """Displacements of sites from those of the coarse sites around them, and from the pairs of near
    sites.
    """
    rows, cols, row_nodes, nodes, weights = around
    first, neighbours, values, itself = pairs
    for k in range(moved.size):
        site_pressure = pressure[k]
        total = itself * site_pressure
        for i in range(4):
            for j in range(4):
                total += (
                    coarse[row_nodes[k, i], nodes[cols[k], j]]
                    * weights[rows[k], i]
                    * weights[cols[k], j]
                )
        for m in range(first[k], first[k + 1]):
            total += values[m] * pressure[neighbours[m]]
            moved[neighbours[m]] += values[m] * site_pressure
        moved[k] = total


@njit(cache=True)
def press_near(rows, cols, pressure, place, pixels, table, moved):
    """Add the short range of pressed sites to the displacements of sites; `place` has theirs."""
    reach = table.shape[0] - 1
    for k in range(rows.size):
        for i in range(-reach, reach + 1):
            start = dense.wrapped(rows[k] + i, pixels) * pixels
            for j in range(-reach, reach + 1):
                target = place[start + dense.wrapped(cols[k] + j, pixels)]
                if 0 <= target < moved.size and i * i + j * j <= reach * reach:
                    moved[target] += pressure[k] * table[abs(i), abs(j)]


@njit(cache=True, fastmath=dense.FAST)
def add_between(targets, pixels, coarse, nodes, weights, moved):
    """Add to the displacements of sites those of the coarse sites around them."""
    for k in range(targets.size):
        row = targets[k] // pixels
        col = targets[k] % pixels
        total = np.float32(0.0)
        for i in range(4):
            for j in range(4):
                total += coarse[nodes[row, i], nodes[col, j]] * weights[row, i] * weights[col, j]
        moved[k] += total
