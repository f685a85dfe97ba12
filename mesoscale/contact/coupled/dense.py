"""Pressures between bounds on a few thousand sites, by active sets; all compiled.

The pressures p of the known sites make the gap g = g0 + G p complementary to 0 <= p <= limit: g >=
0 where p = 0, g = 0 between the bounds, g <= 0 where p = limit. This is a convex quadratic
programme. A primal-dual active set, which is a semismooth Newton iteration (Hueeber and Wohlmuth,
doi:10.1016/j.cma.2004.08.006), solves it with one linear system for the sites between the bounds at
a time. Conjugate gradients solve this system, because they need some tens of products with a matrix
whose factors cost as much as a hundred. These products are in single precision: each step starts
from gaps in double precision, so that only the number of steps can suffer. `grid` holds the same
for whole grids, and what takes over where the sets do not come to rest.
"""

import numpy as np
from numba import njit

NEWTON_STEPS = 40
FACE_STEPS = 1000
FACE_SHARE = 1e-3
# sums in any order, so that they run in parallel lanes; what compiled loops call is put into them
# (forceinline): each library has a copy of its own, and which of them runs, and so the last digits,
# would depend on what was loaded first
FAST = {"contract", "reassoc", "nsz"}


@njit(cache=True, inline="always")
def wrapped(index, pixels):
    """A row or column of the cell that lies beyond its edge by less than a side: many times faster
    than a remainder.
    """
    return index + pixels if index < 0 else index - pixels if index >= pixels else index


@njit(cache=True)
def extend(matrix, table, scale, sites, old, new, pixels):
    """Fill the rows and columns of the sites old .. new - 1 into the matrix of influences."""
    row = sites[:new] // pixels
    col = sites[:new] % pixels
    for k in range(old, new):
        for j in range(k + 1):
            rows = abs(row[k] - row[j])
            cols = abs(col[k] - col[j])
            value = scale * table[min(rows, pixels - rows), min(cols, pixels - cols)]
            matrix[k, j] = value
            matrix[j, k] = value


@njit(cache=True)
def block(table, scale, sites, pixels):
    """Influences of some sites on each other, nm/GPa, in single precision."""
    matrix = np.empty((sites.size, sites.size), np.float32)
    extend(matrix, table, scale, sites, 0, sites.size, pixels)
    return matrix


@njit(cache=True, fastmath=FAST, forceinline=True)
def multiply(matrix, n, x, y):
    """y = matrix[:n, :n] x for a symmetric matrix; its cost is that of the values of x that are not
    0.
    """
    y[:n] = 0.0
    for k in range(n):
        if x[k] != 0.0:
            row = matrix[k]
            factor = x[k]
            for j in range(n):
                y[j] += factor * row[j]


@njit(cache=True, fastmath=FAST, forceinline=True)
def _multiply_block(block, x, y):
    for k in range(x.size):
        row = block[k]
        total = np.float32(0.0)
        for j in range(x.size):
            total += row[j] * x[j]
        y[k] = total


@njit(cache=True)
def residual(gap, pressure, displacement, limit, stiffness, n):
    """Largest abs(p - min(max(p - k g, 0), limit)) over the largest pressure: 0 where all
    conditions are met.
    """
    worst = 0.0
    largest = 0.0
    for k in range(n):
        new_pressure = pressure[k] - stiffness * (gap[k] + displacement[k])
        new_pressure = min(max(new_pressure, 0.0), limit[k])
        worst = max(worst, abs(pressure[k] - new_pressure))
        largest = max(largest, pressure[k])
    return worst / largest if largest > 0.0 else (np.inf if worst > 0.0 else 0.0)


@njit(cache=True)
def classify(gap, pressure, displacement, limit, stiffness, n, state):
    """Sort the sites into those apart (0), between the bounds (1) and at the limit (2); returns how
    many moved.

    From one bound to the other a site goes by way of the state between: where steps jump over it,
    all sites at the limit can change places with those apart for ever (seen in second cycles, where
    whole tops yield again at once).
    """
    moved = 0
    for k in range(n):
        open_gap = gap[k] + displacement[k]
        old = state[k]
        value = pressure[k] - stiffness * open_gap
        new = np.int8(0)
        if value >= limit[k]:
            new = np.int8(2)
        elif value > 0.0:
            new = np.int8(1)
        if abs(new - old) == 2:
            new = np.int8(1)
        if new != old:
            moved += 1
            state[k] = new
    return moved


@njit(cache=True)
def bind(pressure, limit, state, change, n):
    """Put the sites apart and those at their limit on their bounds, the others between them;
    whether any changes.
    """
    changed = False
    for k in range(n):
        new = min(max(pressure[k], 0.0), limit[k])
        if state[k] == 0:
            new = 0.0
        elif state[k] == 2:
            new = limit[k]
        change[k] = new - pressure[k]
        changed |= change[k] != 0.0
        pressure[k] = new
    return changed


@njit(cache=True)
def neighbours(sites, place, pixels, places, number):
    """Numbers of some sites and their neighbours, row by row of each three by three; -1 where one
    has none.

    Parameters
    ----------
    sites, place : the known sites, and the position of each site of the cell in them, or -1
    places : of some of them, shape (n,)
    number : of each known site, or -1
    """
    around = np.full((places.size, 9), -1, np.int32)
    for m in range(places.size):
        row = sites[places[m]] // pixels
        col = sites[places[m]] % pixels
        for i in range(3):
            start = wrapped(row + i - 1, pixels) * pixels
            for j in range(3):
                other = place[start + wrapped(col + j - 1, pixels)]
                if other >= 0:
                    around[m, 3 * i + j] = number[other]
    return around


@njit(cache=True, fastmath=FAST, forceinline=True)
def stiffen(around, stencil, gap, pressure):
    """Pressures from the gaps of some sites (`neighbours`) by
    `half_space.stiffness_between_neighbours`, flat.
    """
    for m in range(around.shape[0]):
        total = gap[around[m, 4]] * stencil[4]
        for j in range(9):
            if j != 4 and around[m, j] >= 0:
                total += gap[around[m, j]] * stencil[j]
        pressure[around[m, 4]] = total


@njit(cache=True)
def close_gaps(block, around, stencil, gap, goal, share):
    """Pressures that close the gaps of some sites, by conjugate gradients that `stiffen`
    preconditions.

    Ends where the largest gap is below `goal`, or below a share of the first one: the next step
    goes on from there, and the block need not be exact.
    """
    x = np.zeros(gap.size)
    z = np.empty(gap.size)
    r = -gap
    goal = max(goal, share * np.abs(gap).max())
    d = np.zeros(gap.size)
    q = np.empty(gap.size)
    last = 1.0
    for _ in range(FACE_STEPS):
        if np.abs(r).max() <= goal:
            break
        stiffen(around, stencil, r, z)
        rz = r @ z
        if not rz > 0.0:
            break
        d = z + (rz / last) * d
        last = rz
        _multiply_block(block, d.astype(np.float32), q)
        dq = d @ q
        if not dq > 0.0:
            break
        x += (rz / dq) * d
        r -= (rz / dq) * q
    return x


@njit(cache=True)
def solve(matrix, cell, gap, limit, tolerance, pressure, displacement):
    """Find the pressures of n sites; `pressure` holds a first guess.

    Parameters
    ----------
    matrix : (>= n, >= n), displacement of one site from the pressure on another, nm/GPa
    cell : numbers of the n sites, position of each site of the cell among them or -1 (N^2,), sites
        a side (N), and `half_space.stiffness_between_neighbours`
    gap : (n,), gap of the undeformed surface, nm
    limit : (n,), largest pressures, GPa, may be infinite
    tolerance : of the residual over the largest pressure
    pressure, displacement : (>= n,), GPa and nm; the answer

    Returns
    -------
    Newton steps, and whether they settled.
    """
    sites, place, pixels, stencil = cell
    n = sites.size
    stiffness = 1.0 / matrix[0, 0] if n > 0 else 0.0
    multiply(matrix, n, pressure, displacement)
    state = np.full(n, 1, np.int8)
    change = np.zeros(n)
    moves = np.empty(n)
    block = np.empty((0, 0), np.float32)
    around = np.empty((0, 9), np.int32)
    number = np.empty(n, np.int32)
    for step in range(NEWTON_STEPS):
        moved = classify(gap, pressure, displacement, limit, stiffness, n, state) > 0 or step == 0
        bind(pressure, limit, state, change, n)
        largest = pressure[:n].max() if n else 0.0
        multiply(matrix, n, change, moves)
        displacement[:n] += moves
        if residual(gap, pressure, displacement, limit, stiffness, n) <= tolerance:
            return step, True
        free = np.flatnonzero(state == 1)
        count = free.size
        if count == 0:
            continue
        if moved:
            number[:] = -1
            number[free] = np.arange(count)
            around = neighbours(sites, place, pixels, free, number)
            block = np.empty((count, count), np.float32)
            for k in range(count):
                for j in range(count):
                    block[k, j] = matrix[free[k], free[j]]
        open_gap = gap[free] + displacement[free]
        closed_gaps = close_gaps(
            block, around, stencil, open_gap, 0.1 * tolerance * largest / stiffness, FACE_SHARE
        )
        change[:] = 0.0
        change[free] = closed_gaps
        pressure[free] += closed_gaps
        multiply(matrix, n, change, moves)
        displacement[:n] += moves
    return NEWTON_STEPS, False
