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
from typing import Any, NamedTuple

import numpy as np
from scipy import optimize

from mesoscale.contact.coupled import site_lists, whole_grid
from mesoscale.contact.coupled.base import Base
from mesoscale.contact.coupled.devices import is_numpy, namespace
from mesoscale.contact.coupled.stiffness import Stiffness

COARSEST = 48  # sites a side: no grid with fewer has a coarser one
NEWTON_STEPS = 60
FACE_STEPS = 200
# of its first gaps, to which a linear system is solved before the sets change; from 0.05 to 0.3 the
# number of transforms hardly differs
FACE_SHARE = 0.2
SINGLE_SHARE = 1e-4  # as far as single precision surely comes at a time
# of a site's own stiffness, by which gaps and pressures tell the sites that touch: gaps that a
# linear system leaves are wide, and by all of it sites would come and go
MEMBER_SHARE = 0.3
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

Array = Any
"""NumPy's, or of another library by the array API: all steps run where the heights are."""
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
        xp = namespace(level)
        pressed = guess
        if guess is None:
            depth = xp.mean(level) - level
            pressed = xp.where(depth > 0.0, depth, 0.0)
        if not xp.any(pressed != 0.0):
            pressed = xp.ones_like(level)
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
        if guess is None:
            guess = namespace(level).zeros_like(level)
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
        guess = finer(guess, maps[-1].shape)
    contact = search(heights, base, guess, separation)
    del guess  # a large map needs its memory
    settled = contact.solve(TOLERANCE)
    return contact.pressed(settled)


def _coarse(contact: "Search") -> tuple[Array, float]:
    """Pressures, in single precision, and separation of a coarse grid."""
    contact.solve(COARSE_TOLERANCE)
    xp = contact.xp
    pressure = xp.asarray(contact.pressure, dtype=xp.float32)
    return xp.reshape(pressure, contact.shape), contact.separation


def coarser(heights: Array) -> Array:
    """Mean heights of two by two sites; at the end of an odd side, of one site."""
    xp = namespace(heights)
    for axis in (0, 1):
        sites = heights.shape[axis]
        first = np.arange(0, sites, 2)
        second = np.minimum(first + 1, sites - 1)
        mean = xp.take(heights, xp.asarray(first, device=heights.device), axis=axis)
        mean += xp.take(heights, xp.asarray(second, device=heights.device), axis=axis)
        mean *= 0.5
        heights = mean
    return heights


def finer(field: Array, shape: tuple[int, int]) -> Array:
    """A field at about twice its sites a side, the same on two by two of them."""
    xp = namespace(field)
    for axis, sites in enumerate(shape):
        coarse = xp.asarray(np.arange(sites) // 2, device=field.device)
        field = xp.take(field, coarse, axis=axis)
    return field


class Search(ABC):
    """A map while its pressures are sought.

    Attributes
    ----------
    xp : functions of the array API for the heights.
    steps : the module whose functions go over all sites.
    shape : of the map.
    pressure : (nx * ny,), GPa.
    gap : (nx * ny,), nm, without the separation.
    separation : nm.
    hardness : pressure at which the surface yields, GPa.
    """

    def __init__(self, heights: Array, base: Base, pressure: Array, hardness: float = math.inf):
        """Take heights (nx, ny) in nm, contact at the lowest, and pressures to start from."""
        self.hardness = float(hardness)
        self.xp = namespace(heights)
        self.shape = heights.shape
        self.heights = heights
        self.base = base
        self.before = base.transforms
        if is_numpy(heights):
            self.steps = site_lists
            self.stiffness = Stiffness(base)
        else:
            self.steps = whole_grid
            self.stiffness = whole_grid.GridStiffness(base, heights)
        self.separation = 0.0
        self.pressure = self.xp.reshape(pressure, (-1,))
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
        self.gap = self.change = self.misfit = self._zeros(0)  # frees their memory
        moved = self.base.displacement(self.xp.reshape(self.pressure, self.shape))
        moved += self.heights
        self.gap = self.xp.reshape(moved, (-1,))
        self.change = self._zeros(math.prod(self.shape))
        self.misfit = self._zeros(math.prod(self.shape))
        self.drift = 0.0  # changes since, over the load: how far single precision has come

    def _zeros(self, sites: int) -> Array:
        """So many, in single precision, beside the heights."""
        return self.xp.zeros(sites, dtype=self.xp.float32, device=self.heights.device)

    def _total(self, values: Array) -> float:
        """Sum in double precision."""
        return float(self.xp.sum(values, dtype=self.xp.float64))

    def _moved(self, change: Array) -> Array:
        """Displacement (nm) of all sites by a change of the pressures."""
        moved = self.base.displacement(self.xp.reshape(change, self.shape))
        return self.xp.reshape(moved, (-1,))

    def solve(self, tolerance: float) -> bool:
        """Find the pressures to a residual over the largest one; whether they settled."""
        stiffness = 1.0 / self.base.spring
        length = 0.0  # of the last step along a direction: none is known yet
        for _ in range(NEWTON_STEPS):
            self.separate()
            state = (self.pressure, self.gap, self.separation, stiffness, self.hardness)
            sites, worst, largest, carried, moved = self.steps.classify(*state, MEMBER_SHARE)
            if worst <= tolerance * largest:
                if self.exact() and ROUNDED * self.drift <= tolerance:
                    return True
                self.follow()
                continue
            bound = self.steps.bind(*state, MEMBER_SHARE, self.factor(carried), self.change)
            if bound > UNSEEN * tolerance * largest:
                self._step_ahead(sites, length)
                self.gap += self._moved(self.change)
                self._drift(self._total(self.xp.abs(self.change)))
            goal = GOAL_SHARE * tolerance * largest * self.base.spring
            share = FACE_SHARE if moved else SINGLE_SHARE
            length = self._close_gaps(sites, goal, share)
        return False

    def _drift(self, change: float) -> None:
        """Count a change of the pressures in single precision."""
        self.drift += change / max(self._total(self.pressure), change)

    def _step_ahead(self, sites: Array, length: float) -> None:
        """Let a change at the bounds go on as the next step will, at no further transform."""
        self.misfit[:] = 0.0
        unit = self.steps.take_misfit(sites, self.gap, self.closed(sites), self.misfit)
        closing = self.stiffness.close(sites, self.misfit)
        self.level(sites, closing)
        self.steps.join(sites, length * unit, closing, self.change, self.pressure)

    def _close_gaps(self, sites: Array, goal: float, share: float) -> float:
        """Change the pressures of free sites until their gaps close.

        Returns the length of the last step.
        """
        misfit = self.misfit
        change = self.change
        misfit[:] = 0.0
        change[:] = 0.0
        unit = self.steps.take_misfit(sites, self.gap, self.closed(sites), misfit)
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
            gained = self.steps.gain(sites, misfit, closing)
            self.steps.turn(sites, closing, gained / last, change)
            last = gained
            moved = self._moved(change)
            work = self.steps.product(sites, change, moved)
            if not work > ROUNDING * gained > 0.0:
                break
            length = gained / work
            left = self.left(
                *self.steps.advance(sites, length, unit, change, moved, misfit, self.pressure)
            )
            self.steps.add(length * unit, moved, self.gap)
            del moved  # the next one takes its memory
            self._drift(length * unit * self.steps.size(sites, change))
        return length

    def pressed(self, settled: bool) -> Pressed:
        """The answer."""
        self.steps.bounded(self.pressure, self.gap, self.separation, self.hardness)
        return Pressed(
            self.xp.reshape(self.pressure, self.shape),
            self.xp.reshape(self.gap, self.shape),
            self.separation,
            self.base.transforms - self.before,
            settled,
        )


class OneLoad(Search):
    """A map under a load: its separation is what keeps the load."""

    def __init__(self, heights: Array, load_nN: float, base: Base, guess: Array):
        self.load = float(load_nN / base.site_area)
        self.lifting: tuple[Array, Array] = (None, None)
        xp = namespace(heights)
        share = self.load / float(xp.sum(guess, dtype=xp.float64))
        super().__init__(heights, base, xp.asarray(guess, dtype=xp.float64) * share)

    def separate(self) -> None:
        """The mean gap of the pressed sites is 0."""
        self.separation = -self.steps.mean_gap(self.pressure, self.gap)

    def factor(self, carried: float) -> float:
        """The load stays."""
        return self.load / carried

    def closed(self, sites: Array) -> float:
        """The mean one of the sites."""
        return self.steps.mean_of(sites, self.gap)

    def left(self, lowest: float, highest: float) -> float:
        """Half of the range: a change of the separation takes the rest."""
        return 0.5 * (highest - lowest)

    def level(self, sites: Array, closing: Array) -> None:
        """Take the load off a step, by pressures that lift all sites alike."""
        if self.lifting[0] is not sites:
            everywhere = self._zeros(math.prod(self.shape))
            everywhere[sites] = 1.0
            self.lifting = (sites, self.stiffness.close(sites, everywhere))
        lifting = self.lifting[1]
        share = self._total(closing) / self._total(lifting)
        closing -= share * lifting

    def exact(self) -> bool:
        """Scale the pressures to the load."""
        factor = self.load / self._total(self.pressure)
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
        xp = namespace(heights)
        super().__init__(heights, base, xp.asarray(guess, dtype=xp.float64), hardness)
        self.separation = float(separation)

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
        self.load = float(load_nN / base.site_area)
        self.length = LOAD_LENGTH * (float(self.xp.std(heights)) or base.spacing)
        self.touch = -float(self.xp.min(heights))

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
                share = max(self._total(self.pressure) / self.load, LIGHTEST)
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
