"""Steps of the search for one load, over whole grids: for any library that has the array API.

`site_lists` has the same functions for NumPy's arrays. Here sites are a mask, shape (nx * ny,), and
arrays that belong to sites have all sites, 0 elsewhere. So each step is a few operations on whole
arrays, as GPUs do them best. Nothing but single numbers comes back from the device.
"""

from typing import Any

import numpy as np

from mesoscale.contact.coupled.base import Base
from mesoscale.contact.coupled.devices import namespace
from mesoscale.contact.coupled.stiffness import BEFORE, Stiffness, make_factors

Array = Any
Summands = list[tuple[Array, Array]]
"""Of each row of a sum: which rows of a field, and their weights."""


def _total(values: Array) -> float:
    """Sum in double precision."""
    xp = namespace(values)
    return float(xp.sum(values, dtype=xp.float64))


def _double(values: Array) -> Array:
    xp = namespace(values)
    return xp.astype(values, xp.float64)


def _single(values: Array) -> Array:
    xp = namespace(values)
    return xp.astype(values, xp.float32)


def _positive(values: Array) -> Array:
    """What is above 0."""
    return namespace(values).where(values > 0.0, values, 0.0)


def mean_gap(pressure: Array, gap: Array) -> float:
    """Mean gap of the sites under pressure."""
    return mean_of(pressure > 0.0, gap)


def classify(
    pressure: Array,
    gap: Array,
    separation: float,
    stiffness: float,
    hardness: float,
    share: float,
) -> tuple[Array, float, float, float, int]:
    """Sites that touch and do not yield, by a share of the gap; the largest residual and pressure,
    the sum of the pressures that stay, and how many sites came or went.
    """
    xp = namespace(gap)
    new = _positive(pressure - stiffness * (gap + separation))
    new = xp.where(new < hardness, new, hardness)
    worst = float(xp.max(xp.abs(pressure - new)))
    del new  # a large map needs its memory
    expected = pressure - share * stiffness * (gap + separation)
    yielding = (pressure >= hardness) & (expected >= hardness)
    touching = expected > 0.0
    came = touching != (pressure != 0.0)
    past = (pressure >= hardness) & ~((pressure == hardness) & yielding)
    moved = int(xp.count_nonzero(came | past))
    sites = touching & ~yielding
    carried = _total(xp.where(sites, _positive(pressure), 0.0))
    largest = max(float(xp.max(pressure)), 0.0)
    return sites, worst, largest, carried, moved


def bind(
    pressure: Array,
    gap: Array,
    separation: float,
    stiffness: float,
    hardness: float,
    share: float,
    factor: float,
    change: Array,
) -> float:
    """Take the pressures off all sites that do not touch, and give the hardness to those that
    yield; the largest change.
    """
    xp = namespace(gap)
    expected = pressure - share * stiffness * (gap + separation)
    new = xp.where(expected > 0.0, factor * _positive(pressure), 0.0)
    yielding = (pressure >= hardness) & (expected >= hardness)
    new = xp.where(yielding | (new > hardness), hardness, new)
    step = new - pressure
    change[:] = _single(step)
    pressure[:] = new
    return float(xp.max(xp.abs(step)))


def mean_of(sites: Array, gap: Array) -> float:
    """Mean gap of some sites."""
    xp = namespace(gap)
    return _total(xp.where(sites, gap, 0.0)) / int(xp.count_nonzero(sites))


def take_misfit(sites: Array, gap: Array, closed: float, misfit: Array) -> float:
    """What gaps of sites lack to be closed, over the largest; returns this (nm)."""
    xp = namespace(gap)
    lack = xp.where(sites, closed - gap, 0.0)
    largest = float(xp.max(xp.abs(lack)))
    if largest > 0.0:
        misfit[:] = _single(lack / largest)
    return largest


def join(sites: Array, length: float, closing: Array, change: Array, pressure: Array) -> None:
    """Add a step to a change of the pressures, and to these."""
    step = length * _double(closing)
    change += _single(step)
    pressure += step


def gain(sites: Array, misfit: Array, closing: Array) -> float:
    """Work of pressures that close gaps by these."""
    return _total(misfit * closing)


def turn(sites: Array, closing: Array, factor: float, change: Array) -> None:
    """Next direction of the pressures."""
    change *= factor
    change += closing


def product(sites: Array, change: Array, moved: Array) -> float:
    """Work of a change of pressures by its displacements."""
    return _total(change * moved)


def size(sites: Array, change: Array) -> float:
    """Sum of the sizes of the changes of some sites."""
    return _total(namespace(change).abs(change))


def advance(
    sites: Array,
    step: float,
    unit: float,
    change: Array,
    moved: Array,
    misfit: Array,
    pressure: Array,
) -> tuple[float, float]:
    """Go a step along a change of pressures; the range of the misfits that are left."""
    xp = namespace(misfit)
    pressure += unit * step * _double(change)
    misfit -= xp.where(sites, step * moved, 0.0)
    lowest = float(xp.min(xp.where(sites, misfit, np.inf)))
    highest = float(xp.max(xp.where(sites, misfit, -np.inf)))
    return lowest, highest


def add(step: float, moved: Array, gap: Array) -> None:
    """Add a step of displacements to all gaps."""
    gap += step * _double(moved)


def bounded(pressure: Array, gap: Array, separation: float, hardness: float) -> None:
    """Pressures within their bounds, and the gaps between them and the flat, in place."""
    xp = namespace(gap)
    pressure[:] = _positive(xp.where(pressure > hardness, hardness, pressure))
    gap[:] = xp.where(pressure > 0.0, 0.0, _positive(gap + separation))


class GridStiffness(Stiffness):
    """What closes the gaps of some sites of a map, beside the heights of the map.

    Long waves go to the coarser grid and come back by weighted sums of rows, then of columns.
    """

    def __init__(self, base: Base, heights: Array):
        super().__init__(base)
        xp = namespace(heights)
        self.fine_shape = base.shape
        self.excess = xp.asarray(self.excess, device=heights.device)
        patterns = np.arange(len(self.factors), dtype=np.uint16)
        make_factors(patterns, self.near, self.factors, self.made)
        columns = [xp.asarray(column, device=heights.device) for column in self.factors.T.copy()]
        self.middle = columns.pop()
        self.before = list(zip(BEFORE.tolist(), columns, strict=True))
        self.to_coarse: list[Summands] = []
        self.to_fine: list[Summands] = []
        for axis, (before, share) in enumerate((self.rows, self.columns)):
            fine = np.tile(np.arange(before.size), 2)
            coarse = np.concatenate((before, before + 1)) % self.shape[axis]
            weight = np.concatenate((1.0 - share, share))
            self.to_coarse.append(_beside(heights, axis, _summands(coarse, fine, weight)))
            self.to_fine.append(_beside(heights, axis, _summands(fine, coarse, weight)))

    def close(self, sites: Array, gap: Array) -> Array:
        """Pressures of some sites from the gaps of all (nx * ny,), which are 0 elsewhere."""
        xp = namespace(gap)
        gap = xp.reshape(gap, self.fine_shape)
        touches = xp.reshape(sites, self.fine_shape)
        if sites is not self.sites:
            self.sites = sites
            self.patterns = self._patterns(touches)
        spectrum = xp.fft.rfftn(_sums(gap, self.to_coarse), axes=(0, 1))
        spectrum *= self.excess
        long = xp.fft.irfftn(spectrum, s=self.shape, axes=(0, 1))
        pressure = _sums(long, self.to_fine)
        factored = self._factor(self.middle) * gap
        for (row, column), factors in self.before:
            factored += self._factor(factors) * xp.roll(gap, (-row, -column), axis=(0, 1))
        factored = xp.where(touches, factored, 0.0)
        pressure += self._factor(self.middle) * factored
        for (row, column), factors in self.before:
            pressure += xp.roll(self._factor(factors) * factored, (row, column), axis=(0, 1))
        return xp.reshape(xp.where(touches, pressure, 0.0), (-1,))

    def _patterns(self, touches: Array) -> Array:
        """Patterns of the sites that touch before each one; beyond the edge none, unless it
        repeats.
        """
        xp = namespace(touches)
        columns = self.fine_shape[1]
        touches = xp.astype(touches, xp.int32)
        patterns = xp.zeros_like(touches)
        for bit, (row, column) in enumerate(BEFORE.tolist()):
            before = xp.roll(touches, (-row, -column), axis=(0, 1))
            if not self.repeats:
                before[:-row, :] = 0
                before[:, : max(-column, 0)] = 0
                before[:, columns - max(column, 0) :] = 0
            patterns += before * 2**bit
        return patterns

    def _factor(self, factors: Array) -> Array:
        """One of the factors of each site."""
        xp = namespace(factors)
        taken = xp.take(factors, xp.reshape(self.patterns, (-1,)))
        return xp.reshape(taken, self.fine_shape)


def _summands(target: np.ndarray, source: np.ndarray, weight: np.ndarray) -> Summands:
    """Weighted sources of each target, one after the other; where a target has fewer, of weight
    0.
    """
    order = np.argsort(target, kind="stable")
    target = target[order]
    first = np.searchsorted(target, target)
    number = np.arange(target.size) - first
    shape = (number.max() + 1, target.max() + 1)
    sources = np.zeros(shape, int)
    sources[number, target] = source[order]
    weights = np.zeros(shape, np.float32)
    weights[number, target] = weight[order]
    return list(zip(sources, weights, strict=True))


def _beside(heights: Array, axis: int, summands: Summands) -> Summands:
    """Summands of sums along an axis, on the device of the heights."""
    xp = namespace(heights)
    device = heights.device
    placed = []
    for source, weight in summands:
        weight = np.expand_dims(weight, 1 - axis)
        placed.append((xp.asarray(source, device=device), xp.asarray(weight, device=device)))
    return placed


def _sums(field: Array, summands: list[Summands]) -> Array:
    """Weighted sums of the rows of a field, then of its columns."""
    xp = namespace(field)
    for axis, ((source, weight), *remaining) in enumerate(summands):
        total = weight * xp.take(field, source, axis=axis)
        for source, weight in remaining:
            total += weight * xp.take(field, source, axis=axis)
        field = total
    return field
