"""The elastic contact of a map under one load, without the way there.

The pressures p >= 0 with the sum of the load make the gap g = h + d + G p complementary to them:
g = 0 where p > 0, g >= 0 where p = 0. The separation d of the mean planes is what the load
constraint costs. Active sets find it as in `grid`, each linear system by conjugate gradients among
pressures that leave the load as it is (Polonsky and Keer, doi:10.1016/S0043-1648(99)00113-1, take
the same step). Nested grids, each of half the sites a side, find the sets where transforms cost
little. Steps are in single precision and add to pressures and gaps in double precision."""

from typing import NamedTuple

import numpy as np
from numba import njit

from mesoscale.contact.coupled.base import Base
from mesoscale.contact.coupled.stiffness import Stiffness

COARSEST = 48  # sites a side: no grid with fewer has a coarser one
NEWTON_STEPS = 60
FACE_STEPS = 200
# of its first gaps, to which a linear system is solved before the sets change; with 0.3 sites of a
# rough surface come and go for ever, at half of them in contact
FACE_SHARE = 0.1
TOLERANCE = 1e-6  # of the residual over the largest pressure: what a cycle demands, too
COARSE_TOLERANCE = 1e-3  # of a coarse grid, whose pressures err by more on the next
ROUNDED = 2e-6  # error of displacements in single precision, over the changes that they follow
LOAD_MISSED = 1e-8  # share of the load that is put right at the end, with no further transform
UNSEEN = 0.1  # of the tolerance: smaller changes of pressure at the bounds move nothing
GOAL_SHARE = 0.3  # of the tolerance, to which the last linear system is solved
ROUNDING = 1e-7  # work over gain of a direction that moves nothing

Array = np.ndarray


class Pressed(NamedTuple):
    """A map under a load.

    Attributes
    ----------
    pressure, gap : (nx, ny), GPa and nm.
    separation : of the flat from the plane that heights are measured from, nm.
    transforms : of the finest grid, there and back.
    settled : whether all conditions hold to `TOLERANCE`.
    """

    pressure: Array
    gap: Array
    separation: float
    transforms: int
    settled: bool


def press(heights: Array, load_nN: float, base: Base) -> Pressed:
    """Press a map (nx, ny) in nm, contact at the lowest, with a force."""
    maps = [heights]
    bases = [base]
    while min(maps[-1].shape) >= 2 * COARSEST:
        maps.append(coarser(maps[-1]))
        bases.append(bases[-1].coarser(maps[-1].shape))
    pressure = np.maximum(maps[-1].mean() - maps[-1], 0.0)
    if not pressure.any():
        pressure = np.ones(maps[-1].shape)
    for level in reversed(range(1, len(maps))):
        contact = OneLoad(maps[level], load_nN, bases[level], pressure)
        contact.solve(COARSE_TOLERANCE)
        pressure = finer(contact.pressure.reshape(contact.shape), maps[level - 1].shape, base)
    contact = OneLoad(heights, load_nN, base, pressure)
    settled = contact.solve(TOLERANCE)
    return contact.pressed(settled)


def coarser(heights: Array) -> Array:
    """Heights at about every second site a side."""
    rows, columns = (np.arange(-(-sites // 2)) * 2 for sites in heights.shape)
    return np.ascontiguousarray(heights[np.ix_(rows, columns)])


def finer(field: Array, shape: tuple[int, int], base: Base) -> Array:
    """A field between its sites, of a map that repeats or not."""
    for axis, sites in enumerate(shape):
        place = np.arange(sites) * (field.shape[axis] / sites if base.repeats else 0.5)
        before = place.astype(int)
        after = before + 1
        if base.repeats:
            after %= field.shape[axis]
        after = np.minimum(after, field.shape[axis] - 1)
        weight = np.expand_dims(place - before, 1 - axis)
        low = field.take(before, axis)
        field = low + weight * (field.take(after, axis) - low)
    return field


class OneLoad:
    """A map under a load while its pressures are sought.

    Attributes
    ----------
    shape : of the map.
    pressure : (nx * ny,), GPa, with the wanted sum.
    gap : (nx * ny,), nm, without the separation.
    separation : nm.
    """

    def __init__(self, heights: Array, load_nN: float, base: Base, guess: Array):
        """Take heights (nx, ny) in nm, contact at the lowest, and pressures to start from."""
        self.shape = heights.shape
        self.base = base
        self.before = base.transforms
        self.load = load_nN / base.site_area
        self.stiffness = Stiffness(base)
        self.separation = 0.0
        pressure = guess * (self.load / guess.sum())
        self.pressure = pressure.reshape(-1)
        self.heights = heights
        self.follow()
        sites = heights.size
        self.change, self.misfit, self.closing = (np.zeros(sites, np.float32) for _ in range(3))

    def follow(self) -> None:
        """Take the gaps by the pressures in double precision."""
        moved = self.base.displacement(self.pressure.reshape(self.shape))
        moved += self.heights
        self.gap = moved.reshape(-1)
        self.drift = 0.0  # changes since, over the load: how far single precision has come

    def _moved(self, change: Array) -> Array:
        """Displacement (nm) of all sites by a change of the pressures."""
        return self.base.displacement(change.reshape(self.shape)).reshape(-1)

    def solve(self, tolerance: float) -> bool:
        """Find the pressures to a residual over the largest one; whether they settled."""
        stiffness = 1.0 / self.base.spring
        length = 0.0  # of the last step along a direction: none is known yet
        for _ in range(NEWTON_STEPS):
            self.separation = -mean_gap(self.pressure, self.gap)
            state = (self.pressure, self.gap, self.separation, stiffness)
            sites, worst, largest, kept, moved = classify(*state)
            if worst <= tolerance * largest:
                missed = abs(self.pressure.sum() / self.load - 1.0)
                self.pressure *= self.load / self.pressure.sum()
                if ROUNDED * self.drift <= tolerance and missed <= LOAD_MISSED:
                    return True
                self.follow()
                continue
            uniform = self._uniform(sites)
            if bind(*state, self.load / kept, self.change) > UNSEEN * tolerance * largest:
                self._step_ahead(sites, uniform, length)
                self.gap += self._moved(self.change)
                self.drift += size(self.change) / self.load
            goal = GOAL_SHARE * tolerance * largest * self.base.spring
            share = FACE_SHARE if moved else 0.0
            length = self._close_gaps(sites, uniform, goal, share)
        return False

    def _uniform(self, sites: Array) -> Array:
        """Pressures of sites that lift them all by about 1."""
        self.misfit[:] = 0.0
        self.misfit[sites] = 1.0
        self.stiffness.close(sites, self.misfit, self.closing)
        return self.closing[sites]

    def _step_ahead(self, sites: Array, uniform: Array, length: float) -> None:
        """Let a change at the bounds go on as the next step will, at no further transform."""
        unit = take_misfit(sites, self.gap, self.misfit)
        self.stiffness.close(sites, self.misfit, self.closing)
        level(sites, uniform, self.closing)
        join(sites, length * unit, self.closing, self.change, self.pressure)

    def _close_gaps(self, sites: Array, uniform: Array, goal: float, share: float) -> float:
        """Change the pressures of free sites, but not their sum, until their gaps are equal.

        Returns the length of the last step.
        """
        misfit = self.misfit
        closing = self.closing
        change = self.change
        change[:] = 0.0
        unit = take_misfit(sites, self.gap, misfit)
        left = 1.0
        length = 0.0
        last = 1.0
        for _ in range(FACE_STEPS):
            if left <= max(goal / max(unit, goal), share):
                break
            self.stiffness.close(sites, misfit, closing)
            level(sites, uniform, closing)
            gained = product(sites, misfit, closing)
            turn(sites, closing, gained / last, change)
            last = gained
            moved = self._moved(change)
            work = product(sites, change, moved)
            if not work > ROUNDING * gained > 0.0:
                break
            length = gained / work
            left = advance(sites, length, unit, change, moved, misfit, self.pressure)
            add(length * unit, moved, self.gap)
            self.drift += length * unit * size(change) / self.load
        return length

    def pressed(self, settled: bool) -> Pressed:
        """The answer."""
        pressure = np.maximum(self.pressure, 0.0, out=self.pressure)
        gap = self.gap
        gap += self.separation
        np.maximum(gap, 0.0, out=gap)
        gap[pressure > 0.0] = 0.0
        return Pressed(
            pressure.reshape(self.shape),
            gap.reshape(self.shape),
            self.separation,
            self.base.transforms - self.before,
            settled,
        )


@njit(cache=True)
def mean_gap(pressure, gap):
    """Mean gap of the sites under pressure."""
    total = 0.0
    count = 0
    for k in range(gap.size):
        if pressure[k] > 0.0:
            total += gap[k]
            count += 1
    return total / count


@njit(cache=True)
def classify(pressure, gap, separation, stiffness):
    """Sites that touch by pressure and gap together.

    Returns
    -------
    These sites, the largest residual and pressure (GPa), the sum of the pressures that stay, and
    how many sites came or went.
    """
    sites = np.empty(gap.size, np.int32)
    count = 0
    worst = 0.0
    largest = 0.0
    kept = 0.0
    moved = 0
    for k in range(gap.size):
        here = pressure[k]
        wanted = max(here - stiffness * (gap[k] + separation), 0.0)
        worst = max(worst, abs(here - wanted))
        largest = max(largest, here)
        moved += (wanted > 0.0) != (here > 0.0)
        if wanted > 0.0:
            sites[count] = k
            count += 1
            kept += max(here, 0.0)
    return sites[:count].copy(), worst, largest, kept, moved


@njit(cache=True)
def bind(pressure, gap, separation, stiffness, factor, change):
    """Take the pressures off all sites that do not touch, and keep the load; the largest change."""
    largest = 0.0
    for k in range(gap.size):
        here = pressure[k]
        new = 0.0
        if here - stiffness * (gap[k] + separation) > 0.0:
            new = factor * max(here, 0.0)
        change[k] = new - here
        largest = max(largest, abs(new - here))
        pressure[k] = new
    return largest


@njit(cache=True)
def take_misfit(sites, gap, misfit):
    """Gaps that are to close, less their mean and over the largest; returns this (nm)."""
    total = 0.0
    for site in sites:
        total += gap[site]
    mean = total / sites.size
    largest = 0.0
    for site in sites:
        largest = max(largest, abs(gap[site] - mean))
    if largest > 0.0:
        for site in sites:
            misfit[site] = (mean - gap[site]) / largest
    return largest


@njit(cache=True)
def level(sites, uniform, closing):
    """Take the load off some pressures, by those that lift all sites alike."""
    excess = 0.0
    lifted = 0.0
    for k in range(sites.size):
        excess += closing[sites[k]]
        lifted += uniform[k]
    share = np.float32(excess / lifted)
    for k in range(sites.size):
        closing[sites[k]] -= share * uniform[k]


@njit(cache=True)
def join(sites, length, closing, change, pressure):
    """Add a step to a change of the pressures, and to these."""
    for site in sites:
        step = length * closing[site]
        change[site] += step
        pressure[site] += step


@njit(cache=True)
def turn(sites, closing, factor, change):
    """Next direction of the pressures."""
    share = np.float32(factor)
    for site in sites:
        change[site] = share * change[site] + closing[site]


@njit(cache=True)
def product(sites, change, moved):
    """Work of a change of pressures by its displacements."""
    total = 0.0
    for site in sites:
        total += change[site] * moved[site]
    return total


@njit(cache=True)
def size(change):
    """Sum of the sizes of all changes."""
    total = 0.0
    for value in change:
        total += abs(value)
    return total


@njit(cache=True)
def advance(sites, step, unit, change, moved, misfit, pressure):
    """Go a step along a change of pressures; half the range of the misfits that are left."""
    highest = -np.inf
    lowest = np.inf
    for site in sites:
        pressure[site] += unit * step * change[site]
        misfit[site] -= np.float32(step) * moved[site]
        highest = max(highest, misfit[site])
        lowest = min(lowest, misfit[site])
    return 0.5 * (highest - lowest)


@njit(cache=True)
def add(step, moved, gap):
    """Add a step of displacements to all gaps."""
    for k in range(gap.size):
        gap[k] += step * moved[k]
