"""The contact of a map under one load or at one separation, without the way there.

The pressures p >= 0 with the sum of the load make the gap g = h + d + G p complementary to them:
g = 0 where p > 0, g >= 0 where p = 0. The separation d of the mean planes is what the load
constraint costs. Active sets find it as in `grid`, each linear system by conjugate gradients among
pressures that leave the load as it is (Polonsky and Keer, doi:10.1016/S0043-1648(99)00113-1, take
the same step). Nested grids, each of half the sites a side, find the sets where transforms cost
little. Steps are in single precision and add to pressures and gaps in double precision.

A surface that yields has p <= H, and g <= 0 where p = H (Almqvist et al.,
doi:10.1016/j.triboint.2005.11.008): what would lie below the flat has flowed. A closing ends with
these pressures, too, unless it relieves sites that have yielded. Such a load is found among
separations.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numba import njit
from scipy import optimize

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
LOAD_LENGTH = 0.6  # of the roughness: over this separation a rough surface's load grows e times
FIRST_DEPTH = 1e-3  # of the same length, from touch, of a surface that does not touch yet
BEYOND = 1.2  # times the expected step: it shall go beyond the load
LIGHTEST = 1e-3  # share of a load below which none counts as lighter
DOUBLINGS = 40  # of the step, until separations lie around a load
CLOSEST = 1e-12  # of the same length: nearer separations are one

Array = np.ndarray
Guess = Array | None


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

    def search(level: Array, below: Base, guess: Guess, separation: float) -> Search:
        pressed = guess if guess is not None else np.maximum(level.mean() - level, 0.0)
        if not pressed.any():
            pressed = np.ones(level.shape)
        return OneLoad(level, load_nN, below, pressed)

    return _nested(heights, base, 0.0, search)


def press_yielding(heights: Array, load_nN: float, hardness: float, base: Base) -> Pressed:
    """As `press`, of a surface that yields at a pressure (GPa)."""

    def search(level: Array, below: Base, guess: Guess, separation: float) -> Search:
        if guess is None:
            elastic = press(level, load_nN, below)
            guess = elastic.pressure
            separation = elastic.separation
        return OneYieldingLoad(level, load_nN, hardness, separation, below, guess)

    return _nested(heights, base, 0.0, search)


def press_to(heights: Array, separation: float, base: Base, hardness: float = math.inf) -> Pressed:
    """Press a map (nx, ny) in nm, contact at the lowest, to a separation (nm); it may yield at a
    pressure (GPa).
    """

    def search(level: Array, below: Base, guess: Guess, separation: float) -> Search:
        guess = np.zeros(level.shape) if guess is None else guess
        return OneSeparation(level, separation, below, guess, hardness)

    return _nested(heights, base, separation, search)


def _nested(
    heights: Array,
    base: Base,
    separation: float,
    search: Callable[[Array, Base, Guess, float], "Search"],
) -> Pressed:
    """Search on grids that are finer and finer, each from the answer of the last."""
    maps = [heights]
    bases = [base]
    while min(maps[-1].shape) >= 2 * COARSEST:
        maps.append(coarser(maps[-1]))
        bases.append(bases[-1].coarser(maps[-1].shape))
    guess = None
    while len(maps) > 1:
        guess, separation = _coarse(search(maps.pop(), bases.pop(), guess, separation))
        guess = finer(guess, maps[-1].shape, base)
    contact = search(heights, base, guess, separation)
    del guess  # a large map needs its memory
    settled = contact.solve(TOLERANCE)
    return contact.pressed(settled)


def _coarse(contact: "Search") -> tuple[Array, float]:
    """Pressures, in single precision, and separation of a coarse grid."""
    contact.solve(COARSE_TOLERANCE)
    return contact.pressure.reshape(contact.shape).astype(np.float32), contact.separation


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
        weight = np.expand_dims(place - before, 1 - axis).astype(field.dtype)
        low = field.take(before, axis)
        field = low + weight * (field.take(after, axis) - low)
    return field


class Search(ABC):
    """A map while its pressures are sought.

    Attributes
    ----------
    shape : of the map.
    pressure : (nx * ny,), GPa.
    gap : (nx * ny,), nm, without the separation.
    separation : nm.
    hardness : pressure at which the surface yields, GPa.
    """

    def __init__(self, heights: Array, base: Base, pressure: Array, hardness: float = math.inf):
        """Take heights (nx, ny) in nm, contact at the lowest, and pressures to start from."""
        self.hardness = hardness
        self.shape = heights.shape
        self.heights = heights
        self.base = base
        self.before = base.transforms
        self.stiffness = Stiffness(base)
        self.separation = 0.0
        self.pressure = pressure.reshape(-1)
        self.follow()

    @abstractmethod
    def separate(self) -> None:
        """Take the separation that the pressures ask for."""

    @abstractmethod
    def factor(self, carried: float) -> float:
        """By which pressures grow, of which so much is left at sites that touch."""

    @abstractmethod
    def closed(self, sites: Array) -> float:
        """Gap of closed sites, without the separation."""

    @abstractmethod
    def left(self, lowest: float, highest: float) -> float:
        """Size of misfits in a range."""

    @abstractmethod
    def level(self, sites: Array, closing: Array) -> None:
        """Take from a step of the pressures what it may not change."""

    @abstractmethod
    def exact(self) -> bool:
        """Put the load right, and say whether it hardly was wrong."""

    def follow(self) -> None:
        """Take the gaps by the pressures in double precision."""
        self.gap = self.change = self.misfit = np.empty(0, np.float32)  # frees their memory
        moved = self.base.displacement(self.pressure.reshape(self.shape))
        moved += self.heights
        self.gap = moved.reshape(-1)
        self.change = np.zeros(self.gap.size, np.float32)
        self.misfit = np.zeros(self.gap.size, np.float32)
        self.drift = 0.0  # changes since, over the load: how far single precision has come

    def _moved(self, change: Array) -> Array:
        """Displacement (nm) of all sites by a change of the pressures."""
        return self.base.displacement(change.reshape(self.shape)).reshape(-1)

    def solve(self, tolerance: float) -> bool:
        """Find the pressures to a residual over the largest one; whether they settled."""
        stiffness = 1.0 / self.base.spring
        length = 0.0  # of the last step along a direction: none is known yet
        for _ in range(NEWTON_STEPS):
            self.separate()
            state = (self.pressure, self.gap, self.separation, stiffness, self.hardness)
            sites, worst, largest, carried, moved = classify(*state)
            if worst <= tolerance * largest:
                if self.exact() and ROUNDED * self.drift <= tolerance:
                    return True
                self.follow()
                continue
            if bind(*state, self.factor(carried), self.change) > UNSEEN * tolerance * largest:
                self._step_ahead(sites, length)
                self.gap += self._moved(self.change)
                self._drift(np.abs(self.change).sum(dtype=float))
            goal = GOAL_SHARE * tolerance * largest * self.base.spring
            share = FACE_SHARE if moved else 0.0
            length = self._close_gaps(sites, goal, share)
        return False

    def _drift(self, change: float) -> None:
        """Count a change of the pressures in single precision."""
        self.drift += change / max(self.pressure.sum(), change)

    def _step_ahead(self, sites: Array, length: float) -> None:
        """Let a change at the bounds go on as the next step will, at no further transform."""
        self.misfit[:] = 0.0
        unit = take_misfit(sites, self.gap, self.closed(sites), self.misfit)
        closing = self.stiffness.close(sites, self.misfit)
        self.level(sites, closing)
        join(sites, length * unit, closing, self.change, self.pressure)

    def _close_gaps(self, sites: Array, goal: float, share: float) -> float:
        """Change the pressures of free sites until their gaps close.

        Returns the length of the last step.
        """
        misfit = self.misfit
        change = self.change
        misfit[:] = 0.0
        change[:] = 0.0
        unit = take_misfit(sites, self.gap, self.closed(sites), misfit)
        if unit == 0.0:
            return 0.0
        left = 1.0
        length = 0.0
        last = 1.0
        for _ in range(FACE_STEPS):
            if left <= max(goal / max(unit, goal), share):
                break
            closing = self.stiffness.close(sites, misfit)
            self.level(sites, closing)
            gained = gain(sites, misfit, closing)
            turn(sites, closing, gained / last, change)
            last = gained
            moved = self._moved(change)
            work = product(sites, change, moved)
            if not work > ROUNDING * gained > 0.0:
                break
            length = gained / work
            left = self.left(*advance(sites, length, unit, change, moved, misfit, self.pressure))
            add(length * unit, moved, self.gap)
            del moved  # the next one takes its memory
            self._drift(length * unit * size(sites, change))
        return length

    def pressed(self, settled: bool) -> Pressed:
        """The answer."""
        pressure = np.clip(self.pressure, 0.0, self.hardness, out=self.pressure)
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


class OneLoad(Search):
    """A map under a load: its separation is what keeps the load."""

    def __init__(self, heights: Array, load_nN: float, base: Base, guess: Array):
        self.load = load_nN / base.site_area
        self.lifting = (np.empty(0, np.int32), np.empty(0, np.float32))
        share = self.load / guess.sum(dtype=float)
        super().__init__(heights, base, guess.astype(float) * share)

    def separate(self) -> None:
        """The mean gap of the pressed sites is 0."""
        self.separation = -mean_gap(self.pressure, self.gap)

    def factor(self, carried: float) -> float:
        """The load stays."""
        return self.load / carried

    def closed(self, sites: Array) -> float:
        """The mean one of the sites."""
        return mean_of(sites, self.gap)

    def left(self, lowest: float, highest: float) -> float:
        """Half of the range: a change of the separation takes the rest."""
        return 0.5 * (highest - lowest)

    def level(self, sites: Array, closing: Array) -> None:
        """Take the load off a step, by pressures that lift all sites alike."""
        if self.lifting[0] is not sites:
            everywhere = np.zeros(self.gap.size, np.float32)
            everywhere[sites] = 1.0
            self.lifting = (sites, self.stiffness.close(sites, everywhere))
        lifting = self.lifting[1]
        share = closing.sum(dtype=float) / lifting.sum(dtype=float)
        closing -= np.float32(share) * lifting

    def exact(self) -> bool:
        """Scale the pressures to the load."""
        factor = self.load / self.pressure.sum()
        self.pressure *= factor
        return abs(factor - 1.0) <= LOAD_MISSED


class OneSeparation(Search):
    """A map at a separation: its load is what comes."""

    def __init__(
        self,
        heights: Array,
        separation: float,
        base: Base,
        guess: Array,
        hardness: float = math.inf,
    ):
        super().__init__(heights, base, guess.astype(float), hardness)
        self.separation = separation

    def separate(self) -> None:
        """It stays."""

    def factor(self, carried: float) -> float:
        """Pressures stay as they are."""
        return 1.0

    def closed(self, sites: Array) -> float:
        """Gaps close to the flat."""
        return -self.separation

    def left(self, lowest: float, highest: float) -> float:
        """The largest."""
        return max(highest, -lowest)

    def level(self, sites: Array, closing: Array) -> None:
        """A step may change the load."""

    def exact(self) -> bool:
        """No load is asked for."""
        return True


class OneYieldingLoad(OneSeparation):
    """A map that yields, under a load: separations are tried until it carries this.

    At light loads a change of the separation changes the load by a factor, so that its logarithm
    is what is followed.
    """

    def __init__(
        self,
        heights: Array,
        load_nN: float,
        hardness: float,
        separation: float,
        base: Base,
        guess: Array,
    ):
        super().__init__(heights, separation, base, guess, hardness)
        self.load = load_nN / base.site_area
        self.length = LOAD_LENGTH * (float(heights.std()) or base.spacing)
        self.touch = -float(heights.min())

    def solve(self, tolerance: float) -> bool:
        """Find the separation that carries the load to a tolerance; whether it was found.

        What is far from it is solved coarsely.
        """
        if tolerance < COARSE_TOLERANCE:
            self._find(COARSE_TOLERANCE)
        return self._find(tolerance)

    def _find(self, tolerance: float) -> bool:
        tried: dict[float, float] = {}

        def excess(separation: float) -> float:
            """Logarithm of what is carried over the load; 0 within the tolerance."""
            if separation not in tried:
                self.separation = separation
                settled = super(OneYieldingLoad, self).solve(tolerance)
                share = max(float(self.pressure.sum()) / self.load, LIGHTEST)
                met = settled and abs(share - 1.0) <= tolerance
                tried[separation] = 0.0 if met else math.log(share)
            return tried[separation]

        near = min(self.separation, self.touch - FIRST_DEPTH * self.length)
        if excess(near) == 0.0:
            return True
        # the load of a single summit grows with the depth
        length = min(self.length, self.touch - near)
        step = BEYOND * length * min(max(excess(near), -1.0), 1.0)
        for _ in range(DOUBLINGS):
            far = near + step
            if excess(far) == 0.0:
                return True
            if excess(near) * excess(far) < 0.0:
                separation = optimize.brentq(excess, near, far, xtol=CLOSEST * self.length)
                return excess(float(np.asarray(separation))) == 0.0
            near = far
            step *= 2.0
        return False


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
def classify(pressure, gap, separation, stiffness, hardness):
    """Sites that touch and do not yield, by pressure and gap together.

    A site does not yield before its pressure as an elastic one is beyond the hardness: by its gap
    alone it may yield and part in turns.

    Returns
    -------
    These sites, the largest residual and pressure (GPa), the sum of the pressures that stay, and
    how many sites came or went.
    """
    sites = np.empty(gap.size, np.int32)
    count = 0
    worst = 0.0
    largest = 0.0
    carried = 0.0
    moved = 0
    for k in range(gap.size):
        site_pressure = pressure[k]
        expected = max(site_pressure - stiffness * (gap[k] + separation), 0.0)
        new_pressure = min(expected, hardness)
        worst = max(worst, abs(site_pressure - new_pressure))
        largest = max(largest, site_pressure)
        yielding = site_pressure >= hardness and expected >= hardness
        came = (new_pressure > 0.0) != (site_pressure != 0.0)
        moved += came or site_pressure > hardness or (site_pressure == hardness and not yielding)
        if new_pressure > 0.0 and not yielding:
            sites[count] = k
            count += 1
            carried += max(site_pressure, 0.0)
    return sites[:count].copy(), worst, largest, carried, moved


@njit(cache=True)
def bind(pressure, gap, separation, stiffness, hardness, factor, change):
    """Take the pressures off all sites that do not touch, and give the hardness to those that
    yield; the largest change.
    """
    largest = 0.0
    for k in range(gap.size):
        site_pressure = pressure[k]
        expected = site_pressure - stiffness * (gap[k] + separation)
        new = 0.0
        if min(site_pressure, expected) >= hardness:
            new = hardness
        elif expected > 0.0:
            new = min(factor * max(site_pressure, 0.0), hardness)
        change[k] = new - site_pressure
        largest = max(largest, abs(new - site_pressure))
        pressure[k] = new
    return largest


@njit(cache=True)
def mean_of(sites, gap):
    """Mean gap of some sites."""
    total = 0.0
    for site in sites:
        total += gap[site]
    return total / sites.size


@njit(cache=True)
def take_misfit(sites, gap, closed, misfit):
    """What gaps of sites lack to be closed, over the largest; returns this (nm)."""
    largest = 0.0
    for site in sites:
        largest = max(largest, abs(gap[site] - closed))
    if largest > 0.0:
        for site in sites:
            misfit[site] = (closed - gap[site]) / largest
    return largest


@njit(cache=True)
def join(sites, length, closing, change, pressure):
    """Add a step to a change of the pressures, and to these."""
    for k in range(sites.size):
        step = length * closing[k]
        change[sites[k]] += step
        pressure[sites[k]] += step


@njit(cache=True)
def gain(sites, misfit, closing):
    """Work of pressures that close gaps by these."""
    total = 0.0
    for k in range(sites.size):
        total += misfit[sites[k]] * closing[k]
    return total


@njit(cache=True)
def turn(sites, closing, factor, change):
    """Next direction of the pressures."""
    share = np.float32(factor)
    for k in range(sites.size):
        change[sites[k]] = share * change[sites[k]] + closing[k]


@njit(cache=True)
def product(sites, change, moved):
    """Work of a change of pressures by its displacements."""
    total = 0.0
    for site in sites:
        total += change[site] * moved[site]
    return total


@njit(cache=True)
def size(sites, change):
    """Sum of the sizes of the changes of some sites."""
    total = 0.0
    for site in sites:
        total += abs(change[site])
    return total


@njit(cache=True)
def advance(sites, step, unit, change, moved, misfit, pressure):
    """Go a step along a change of pressures; the range of the misfits that are left."""
    highest = -np.inf
    lowest = np.inf
    for site in sites:
        pressure[site] += unit * step * change[site]
        misfit[site] -= np.float32(step) * moved[site]
        highest = max(highest, misfit[site])
        lowest = min(lowest, misfit[site])
    return lowest, highest


@njit(cache=True)
def add(step, moved, gap):
    """Add a step of displacements to all gaps."""
    for k in range(gap.size):
        gap[k] += step * moved[k]
