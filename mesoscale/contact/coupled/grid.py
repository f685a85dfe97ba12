"""Pressures between bounds where many sites can touch: active sets, with the half-space applied by
FFT.

The problem is that of `dense`. Here the linear system of each step is solved by conjugate gradients
that are preconditioned with the stiffness of the half-space (Vollebregt,
doi:10.1007/s10957-013-0433-z) between neighbours, or with their matrix where few sites are free.
Steps are in single precision, which adds to the displacements; double precision has the last word.
"""

from collections.abc import Callable
from functools import cached_property

import numpy as np
from numba import njit
from scipy import fft

from mesoscale.contact.coupled import clusters, dense, half_space
from mesoscale.contact.coupled.split import Split
from mesoscale.settings.contact import Body

NEWTON_STEPS = 60
FACE_STEPS = 500
GRADIENT_STEPS = 500
SINGLE_SHARE = 1e-6  # single precision gets a linear system at least this far
# each linear system is solved to this share of its first gap: the sets change before more pays
FACE_SHARE = 0.3
SPLIT_ERROR = 2e-3  # of `Split`, roughly
# of the pressures: larger changes are not followed by `Split` while hardness still changes, and
# more is not changed in single precision, which errs by 2e-6 of what changes
SMALL = 0.1
COARSE = 1e-5  # tolerances beyond it need no displacements in double precision
# free sites up to which a linear system has a matrix; the same over pixels a side
DIRECT, DIRECT_PER_PIXEL = (256, 2)
# of the grid's sites: so many pairs of sites cost less by the table than a transform
TABLE_SHARE = 1.5

Array = np.ndarray
Apply = Callable[[Array], Array]


class Grid:
    """A half-space of N x N sites, for pressures and displacements of shape (N^2,).

    Attributes
    ----------
    field : displacement (nm) of all sites by the pressures that `displace` had last.
    table : influence of one site on another (`half_space.influence`).
    """

    def __init__(self, pixels: int, length: float, e_star: float, bodies: tuple[Body, ...] = ()):
        self.shape = (pixels, pixels)
        self.scale = length / e_star
        self.compliance = half_space.wave_compliance(pixels, length, e_star, bodies)
        self.single_compliance = self.compliance.astype(np.float32)
        self.field = np.zeros(pixels**2)
        self.rows = np.arange(pixels)
        nowhere = self.rows[:0]
        # the sites asked for last, their rows, and their places in these
        self.located = (nowhere, nowhere, nowhere)
        self.room = np.empty(self.compliance.size, np.complex128)
        self.table = half_space.influence(pixels, length, bodies)
        self.drifted = False  # whether displacements at hand are by `split`
        self.block = np.empty((0, 0), np.float32)
        self.block_sites = np.empty(0, np.int32)

    @cached_property
    def split(self) -> Split:
        """The same for known sites, with an error."""
        return Split(self.compliance, self.scale)

    @cached_property
    def stencil(self) -> Array:
        """`half_space.stiffness_between_neighbours` of this half-space."""
        return half_space.stiffness_between_neighbours(self.table)

    def displacement(self, pressure: Array) -> Array:
        """Displacement (nm) by a pressure (GPa), mean zero, in the precision of the pressure."""
        spectrum = np.asarray(fft.rfft2(pressure.reshape(self.shape)))
        spectrum *= self._compliance(pressure)
        return np.asarray(fft.irfft2(spectrum, s=self.shape, overwrite_x=True)).reshape(-1)

    def _between(self, pressure: Array, rows: Array, wanted: Array) -> Array:
        """The same of some rows of the cell by the pressures of some; the other rows have none."""
        compliance = self._compliance(pressure)
        of_rows = pressure.reshape(-1, self.shape[1])
        return half_space.convolve(of_rows, rows, compliance, self.room, wanted).reshape(-1)

    def _compliance(self, pressure: Array) -> Array:
        """That of the waves, in the precision of the pressure."""
        return self.single_compliance if pressure.dtype == np.float32 else self.compliance

    def spread(self, sites: Array, values: Array) -> Array:
        """Values of some sites, in the order of the cell, on all; 0 on the others."""
        if sites.size == self.field.size:
            return values
        everywhere = np.zeros(self.field.size, values.dtype)
        everywhere[sites] = values
        return everywhere

    def _pressed(self, sites: Array, pressure: Array) -> tuple[Array, Array, Array]:
        """Pressures of all sites in the rows of some, these rows, and where the sites are in
        them.
        """
        if self.located[0] is not sites:
            rows, place = half_space.rows_of(sites // self.shape[1], self.shape[0])
            self.located = sites, rows, place * self.shape[1] + sites % self.shape[1]
        _, rows, place = self.located
        everywhere = np.zeros(rows.size * self.shape[1], pressure.dtype)
        everywhere[place] = pressure
        return everywhere, rows, place

    def displacement_at(self, sites: Array, pressure: Array) -> Array:
        """Displacement (nm) of some sites by their pressures (GPa), in the precision of the
        pressures.
        """
        everywhere, rows, place = self._pressed(sites, pressure)
        return self._between(everywhere, rows, rows)[place]

    def displacement_by(self, sites: Array, pressure: Array) -> Array:
        """The same of all sites."""
        everywhere, rows, _ = self._pressed(sites, pressure)
        return self._between(everywhere, rows, self.rows)

    def nearly(self, sites: Array, pressure: Array) -> Array:
        """The same in single precision, by `split` where it pays."""
        self.drifted = self.split.open
        return (
            self.split.displacement(pressure)
            if self.split.open
            else self.displacement_at(sites, pressure)
        )

    def displace(self, sites: Array, pressure: Array) -> Array:
        """The same; that of all sites is kept in `field`, which nothing changes in place."""
        self.field = self.displacement_by(sites, pressure)
        self.under = (sites, pressure.copy())
        self.rounded = 0.0
        self.drifted = False
        return self.field[sites]

    def follow(self, sites: Array, place: Array, pressure: Array, keep: bool) -> Array:
        """The same from what `field` is under, by the change alone in single precision, where
        rounding allows it.
        """
        before, pressed = self.under
        change = pressure.copy()
        change[place[before]] -= pressed
        size = np.abs(change)
        largest = float(size.max())
        rounded = self.rounded + float(size.sum()) / max(float(pressure.sum()), 1e-300)
        if largest == 0.0 or (keep and rounded > SMALL):
            return self.displace(sites, pressure)
        self.drifted = False
        unit = (change / largest).astype(np.float32)
        if not keep:
            return self.field[sites] + largest * self.displacement_at(sites, unit)
        moved = self.displacement_by(sites, unit)
        moved *= np.float32(largest)
        self.field = self.field + moved
        self.under = (sites, pressure.copy())
        self.rounded = rounded
        return self.field[sites]


def solve(
    grid: Grid,
    sites: Array,
    place: Array,
    gap: Array,
    limit: Array,
    tolerance: float,
    pressure: Array,
    displacement: Array,
) -> tuple[int, bool]:
    """Find the pressures of n sites of a grid; the arguments are those of `dense.solve`.

    Displacements are followed with an error until the sets are found, then corrected on the whole
    grid.

    Returns
    -------
    Newton steps, and whether they settled. `grid.field` has the displacements of all sites.
    """
    stiffness = 1.0 / (grid.scale * grid.table[0, 0])
    state = np.full(gap.size, 1, np.int8)
    all_sites = np.arange(gap.size)
    change = np.zeros(gap.size)
    direct = min(max(DIRECT, DIRECT_PER_PIXEL * grid.shape[0]), grid.field.size - 1)
    coarse = tolerance > COARSE
    error = SPLIT_ERROR if grid.split.open else 0.0
    aim = tolerance
    # displacements are those of the pressures, or near enough
    exact = coarse
    # the last step has made them so
    corrected = True
    # the last step has solved for all free sites
    solved = False
    if grid.drifted and not coarse:
        displacement[:] = grid.follow(sites, place, pressure, False)
    for step in range(NEWTON_STEPS):
        changed = dense.classify(gap, pressure, displacement, limit, stiffness, gap.size, state)
        sets_moved = changed > 0 or step == 0
        worst = dense.residual(gap, pressure, displacement, limit, stiffness, gap.size)
        if corrected and not coarse:
            aim = max(tolerance, error * worst)
        allowed = aim if grid.drifted else tolerance
        settled = worst <= allowed or (solved and not sets_moved)
        if settled and exact:
            return step, True
        bound = dense.bind(pressure, limit, state, change, gap.size)
        if settled:
            exact = aim <= tolerance or solved or not grid.drifted
            displacement[:] = grid.follow(sites, place, pressure, exact)
            corrected = True
            solved = False
            continue
        exact = coarse
        corrected = False
        free = np.flatnonzero(state == 1)
        solved = 0 < free.size <= direct
        if solved:
            _solve_few(grid, sites, place, free, gap, (pressure, change), displacement)
            _follow(grid, sites, (pressure, change), all_sites, displacement)
            continue
        if bound:
            _follow(grid, sites, (pressure, change), all_sites, displacement)
        if free.size:
            goal = 0.3 * aim * float(pressure.max()) / stiffness
            near = (
                dense.neighbours(sites, place, grid.shape[0], free, all_sites),
                grid.stencil,
            )
            share = FACE_SHARE if sets_moved else 0.0
            solution = (pressure, displacement)
            _close_gaps(grid, sites, state == 1, near, gap, solution, goal, share)
            # a uniform pressure moves nothing: take the least, so that sets change
            if free.size == grid.field.size:
                pressure -= pressure.min()
    displacement[:] = grid.displace(sites, pressure)
    return NEWTON_STEPS, False


def _solve_few(
    grid: Grid,
    sites: Array,
    place: Array,
    free: Array,
    gap: Array,
    pressed: tuple[Array, Array],
    displacement: Array,
) -> None:
    """Close the gaps of the free sites by the matrix of their influences, which is kept.

    Pressures and their change are changed in place; displacements do not follow yet.
    """
    pressure, change = pressed
    if not np.array_equal(grid.block_sites, sites[free]):
        grid.block_sites = sites[free]
        grid.block = dense.block(grid.table, grid.scale, grid.block_sites, grid.shape[0])
    row_of_block = np.full(gap.size, -1)
    row_of_block[free] = np.arange(free.size)
    around = dense.neighbours(sites, place, grid.shape[0], free, row_of_block)
    open_gap = gap[free] + displacement[free]
    _follow(grid, sites, pressed, free, open_gap)
    closed = dense.close_gaps(grid.block, around, grid.stencil, open_gap, 0.0, SINGLE_SHARE)
    change[free] += closed
    pressure[free] += closed


def _follow(
    grid: Grid, sites: Array, pressed: tuple[Array, Array], places: Array, displacement: Array
) -> None:
    """Add to the displacements of some of the sites what a change of the pressures (GPa) of all
    makes.

    Of few sites it is taken from the table, of many in single precision, by `Split` where the
    change is small.
    """
    pressure, change = pressed
    size = np.abs(change)
    if np.count_nonzero(size) * places.size <= TABLE_SHARE * grid.field.size:
        clusters.displace(
            grid.table, grid.scale, grid.shape[0], sites, change, sites[places], displacement
        )
        return
    largest = float(size.max())
    small = float(size.sum()) <= SMALL * float(pressure.sum())
    unit = (change / largest).astype(np.float32)
    displaced = grid.nearly if small else grid.displacement_at
    displacement += largest * displaced(sites, unit)[places]


def _close_gaps(
    grid: Grid,
    sites: Array,
    free: Array,
    near: tuple[Array, Array],
    gap: Array,
    solution: tuple[Array, Array],
    goal: float,
    share: float,
) -> None:
    """Change the pressures of the free sites, and with them the displacements, so that the gaps
    there close.

    Both change in place. Single precision is three times as fast.
    """
    (around, stencil), (pressure, displacement) = near, solution
    first = np.where(free, -(gap + displacement), 0.0)
    largest = float(np.abs(first).max())
    if largest == 0.0:  # closed to the last digit
        return
    goal = max(goal / largest, share, SINGLE_SHARE)
    r = (first / largest).astype(np.float32)
    x, u, d, z = (np.zeros_like(r) for _ in range(4))
    stencil = (stencil / grid.scale).astype(np.float32)
    last = 1.0
    for _ in range(FACE_STEPS):
        dense.stiffen(around, stencil, r, z)
        rz = _turn(z, r, free, last, d)
        last = rz
        q = grid.nearly(sites, d)
        dq = float(d @ q)
        if not dq > 1e-7 * rz > 0.0:  # rounding of what moves nothing
            break
        if _advance(np.float32(rz / dq), d, q, free, x, u, r) <= goal:
            break
    pressure += largest * x.astype(float)
    displacement += largest * u.astype(float)


@njit(cache=True, fastmath=dense.FAST)
def _turn(z, r, free, last, d):
    """Next direction d from the preconditioned residual z of the free sites; returns r z."""
    rz = 0.0
    for k in range(r.size):
        if free[k]:
            rz += r[k] * z[k]
    factor = np.float32(rz / last)
    for k in range(r.size):
        d[k] = factor * d[k] + z[k] if free[k] else np.float32(0.0)
    return rz


@njit(cache=True, fastmath=dense.FAST)
def _advance(step, d, q, free, x, u, r):
    """Go a step along d, whose displacement is q; returns the largest residual that is left."""
    largest = np.float32(0.0)
    for k in range(r.size):
        x[k] += step * d[k]
        u[k] += step * q[k]
        if free[k]:
            r[k] -= step * q[k]
            largest = max(largest, abs(r[k]))
    return largest


def project(
    apply: Apply,
    norm: float,
    gap: Array,
    limit: Array,
    stiffness: float,
    tolerance: float,
    guess: Array,
) -> tuple[Array, Array, int, bool]:
    """The same by modified proportioning with reduced gradient projections, which converges from
    any guess.

    Dostal and Schoeberl, doi:10.1007/s10589-005-5395-6. `apply` makes displacements of pressures,
    `norm` bounds its largest eigenvalue (nm/GPa).
    """
    fixed = 1.0 / norm
    pressure = np.clip(guess, 0.0, limit)
    displacement = apply(pressure)
    d = np.zeros_like(pressure)
    fresh = True
    for step in range(GRADIENT_STEPS):
        if step % 100 == 99:  # rounding adds up
            displacement = apply(pressure)
        if dense.residual(gap, pressure, displacement, limit, stiffness, gap.size) <= tolerance:
            return pressure, displacement, step, True
        gradient = gap + displacement
        low = pressure <= 0.0
        high = pressure >= limit
        free = np.where(low | high, 0.0, gradient)
        chopped = np.where(
            low, np.minimum(gradient, 0.0), np.where(high, np.maximum(gradient, 0.0), 0.0)
        )
        # the part of the free gradient that a step of fixed length can follow
        reduced = np.clip(free, (pressure - limit) / fixed, pressure / fixed)
        if chopped @ chopped > free @ reduced:  # let sites off their bounds
            length = float(chopped @ chopped) / float(chopped @ apply(chopped))
            pressure = np.clip(pressure - length * chopped, 0.0, limit)
            displacement = apply(pressure)
            fresh = True
            continue
        if fresh:
            d = free
        q = apply(d)
        dq = float(d @ q)
        best = float(free @ d) / dq if dq > 0.0 else np.inf
        with np.errstate(divide="ignore", invalid="ignore"):
            room = np.where(
                d > 0.0, pressure / d, np.where(d < 0.0, (pressure - limit) / d, np.inf)
            )
        longest = float(room.min())
        if best <= longest:
            pressure = pressure - best * d
            displacement = displacement + -best * q
            inside = (pressure > 0.0) & (pressure < limit)
            free = np.where(inside, gap + displacement, 0.0)
            d = free - (float(free @ q) / dq) * d
            fresh = False
        else:  # to the bound, and on along the projected gradient
            pressure = np.clip(pressure - longest * d, 0.0, limit)
            gradient = gap + displacement - longest * q
            inside = (pressure > 0.0) & (pressure < limit)
            pressure = np.clip(pressure - fixed * np.where(inside, gradient, 0.0), 0.0, limit)
            displacement = apply(pressure)
            fresh = True
    return pressure, displacement, GRADIENT_STEPS, False
