"""Inner loops of the bending electrode: one Newton step, and the motion to balance."""

import numpy as np
from numba import njit

from mesoscale.device.plate import GPA, NM
from mesoscale.pad.local import pad_pressure

BANDS = 3
"""Half bandwidth of the beam's matrix: two nodes of an element have a deflection and a slope."""
STOPPER_GPa_nm = 1e-2
"""Stiffness of a stopper: it gives way by a tenth of a nanometre under 1 MPa."""
CLOSING_NM, OPENING_NM = 1.0, 0.25
"""Largest step of a place in contact. Where a pad of few cells tears off, longer steps overshoot: with 0.5 and 1 nm
that of `ci` (16 cells) lets go 0.9 and 1.8 % too early."""
SETTLED, BEYOND, FREE, UNSETTLED = range(4)
"""How a motion ends: in balance, below the computed closing, off the pad, or not within the allowed steps."""


@njit(cache=True)
def least_gap_nm(dielectric_nm):
    """Smallest electric gap: a place deeper than the dielectric allows counts as closed."""
    return 0.1 * dielectric_nm + 0.1


@njit(cache=True)
def add_loads(separation_nm, pressure, slope, electric, places):
    """Take the electrostatic pull off where the electrode is, and put stoppers where the pad is not.

    Parameters
    ----------
    pressure, slope : of the pad (GPa, GPa/nm) at the separation of what lands on it; changed in place.
    electric : dielectric over its permittivity (nm), square of the voltage, vacuum permittivity, fringe over width
        (1/nm).
    places : see `mesoscale.device.beam.Beam.places`.
    """
    dielectric_nm, squared_V2, permittivity, edge_per_nm = electric
    wired, lands, _, stopper_nm = places
    least = least_gap_nm(dielectric_nm)
    for e in range(separation_nm.shape[0]):
        for g in range(separation_nm.shape[1]):
            s = separation_nm[e, g]
            if lands[e, g] == 0.0:
                pressure[e, g] = STOPPER_GPa_nm * max(stopper_nm - s, 0.0)
                slope[e, g] = -STOPPER_GPa_nm if s < stopper_nm else 0.0
            electric_nm = max(s + dielectric_nm, least)
            pull = wired[e, g] * permittivity * squared_V2 / (2.0 * (electric_nm * NM) ** 2) / GPA
            pressure[e, g] -= pull * (1.0 + edge_per_nm * electric_nm)
            slope[e, g] += pull * (2.0 / electric_nm + edge_per_nm)


@njit(cache=True)
def solve_bands(bands, border, corner, right):
    """Gauss with row exchanges on a matrix of half bandwidth BANDS with one more row and column; in place.

    Entry (i, j) stands in bands[i, j - i + BANDS], of shape (n, 3 BANDS + 1); the last BANDS columns are room for the
    exchanges. The last column of `right` (n, sides + 1) is the border's column, `border` (n,) its row, `corner` their
    corner; its right sides are zero. The matrix without its border may be singular: the last two unknowns are found
    together (W. Govaerts, Numerical Methods for Bifurcations of Dynamical Equilibria, SIAM 2000, section 3).
    """
    n, sides = len(bands), right.shape[1] - 1
    below = np.zeros(sides)
    for k in range(n):
        end = min(k + BANDS + 1, n)
        best = k
        for i in range(k + 1, end):
            if abs(bands[i, k - i + BANDS]) > abs(bands[best, k - best + BANDS]):
                best = i
        if best != k:
            for j in range(k, min(k + 2 * BANDS + 1, n)):
                kept = bands[k, j - k + BANDS]
                bands[k, j - k + BANDS] = bands[best, j - best + BANDS]
                bands[best, j - best + BANDS] = kept
            for side in range(sides + 1):
                kept = right[k, side]
                right[k, side] = right[best, side]
                right[best, side] = kept
        for i in range(k + 1, end):
            factor = bands[i, k - i + BANDS] / bands[k, BANDS]
            if factor != 0.0:
                for j in range(k + 1, min(k + 2 * BANDS + 1, n)):
                    bands[i, j - i + BANDS] -= factor * bands[k, j - k + BANDS]
                for side in range(sides + 1):
                    right[i, side] -= factor * right[k, side]
        if k < n - 1 and border[k] != 0.0:
            factor = border[k] / bands[k, BANDS]
            for j in range(k + 1, min(k + 2 * BANDS + 1, n)):
                border[j] -= factor * bands[k, j - k + BANDS]
            corner -= factor * right[k, sides]
            for side in range(sides):
                below[side] -= factor * right[k, side]
    pivot, column, row = bands[n - 1, BANDS], right[n - 1, sides], border[n - 1]
    determinant = pivot * corner - column * row
    for side in range(sides):
        total = right[n - 1, side]
        right[n - 1, side] = (total * corner - column * below[side]) / determinant
        force = (pivot * below[side] - row * total) / determinant
        for k in range(n - 2, -1, -1):
            total = right[k, side] - right[k, sides] * force
            for j in range(k + 1, min(k + 2 * BANDS + 1, n)):
                total -= bands[k, j - k + BANDS] * right[j, side]
            right[k, side] = total / bands[k, BANDS]


@njit(cache=True)
def elongation(nodal, pulled, rest):
    """By how much a beam is longer than at rest (m), int (z'^2 - z0'^2) / 2 dx."""
    longer = 0.0
    for e in range(nodal.shape[0] - 1):
        for i in range(4):
            for j in range(4):
                more = nodal[e + j // 2, j % 2]
                longer += pulled[e, i, j] * more * (0.5 * nodal[e + i // 2, i % 2] + rest[e + i // 2, i % 2])
    return longer


@njit(cache=True)
def newton_step(
    nodal,
    pressure_Pa,
    slope_Pa_m,
    other_Pa,
    inertia,
    shape,
    bends,
    pulled,
    weights,
    coupled,
    tension,
    stretching,
    rest,
    unknowns,
):
    """One Newton step towards balance, and the answer to another load, of the free nodes; shape (nodes, 2) each.

    The work of the unbalanced forces on the step comes third. It is negative where the step is one to a balance that
    is not stable. Stretching adds a product of one vector with itself to the matrix, which then is no band any more: so
    the growth of the axial force is one unknown more.
    """
    elements, points = pressure_Pa.shape
    bands, right = np.zeros((unknowns, 3 * BANDS + 1)), np.zeros((unknowns, 3))
    border = np.zeros(unknowns)
    more = stretching * elongation(nodal, pulled, rest)
    for e in range(elements):
        for i in range(4):
            row = 2 * e + i - 2
            if row < 0 or row >= unknowns:
                continue
            for g in range(points):
                share = weights[e, g] * shape[e, i, g]
                right[row, 0] += pressure_Pa[e, g] * share
                right[row, 1] += other_Pa[e, g] * share
            for j in range(4):
                moved, at_rest = nodal[e + j // 2, j % 2], rest[e + j // 2, j % 2]
                drawn = pulled[e, i, j]
                right[row, 0] -= bends[e, i, j] * moved + drawn * (tension * moved + more * (moved + at_rest))
                right[row, 2] += drawn * (moved + at_rest)
                column = 2 * e + j - 2
                if j > i or column < 0:
                    continue
                entry = bends[e, i, j] + (tension + more) * drawn
                for g in range(points):
                    entry += (inertia - slope_Pa_m[e, g]) * coupled[e, i, j, g]
                bands[row, column - row + BANDS] += entry
                if j < i:
                    bands[column, row - column + BANDS] += entry
    force = right[:, 0].copy()
    for row in range(unknowns):
        border[row] = stretching * right[row, 2]
    solve_bands(bands, border, -1.0, right)
    change, answer, work = np.zeros((elements + 1, 2)), np.zeros((elements + 1, 2)), 0.0
    # in loops: what numba brings for assigning a part of an array takes seconds to compile
    for row in range(unknowns):
        change[1 + row // 2, row % 2] = right[row, 0]
        answer[1 + row // 2, row % 2] = right[row, 1]
        work += force[row] * right[row, 0]
    return change, answer, work


@njit(cache=True)
def deflect(nodal, shape):
    """Deflection at the integration points, shape (elements, points)."""
    deflection = np.zeros((nodal.shape[0] - 1, shape.shape[2]))
    for e in range(deflection.shape[0]):
        for g in range(deflection.shape[1]):
            for i in range(4):
                deflection[e, g] += nodal[e + i // 2, i % 2] * shape[e, i, g]
    return deflection


@njit(cache=True, nogil=True)  # switches are solved side by side
def creep(nodal, deepest_nm, rest_m, beam, places, pad, electric, contact_nm, off_nm, free_nm, most_nm):
    """Let a beam move to balance at one voltage, every place remembering how deep it came; both changed in place.

    The beam is held back by an added stiffness that grows where steps are too large: an overdamped motion.

    Parameters
    ----------
    beam, places, pad, electric : what `newton_step`, `add_loads` and `pad_pressure` take last.
    contact_nm : separation at which a place is about to land.
    off_nm : in balance above it, no place is in contact.
    free_nm : a rising beam is off the pad where no place is below this separation.
    most_nm : largest step of a place in contact.
    """
    inertia, least, turns, lowest = 1e9, 0.0, 0, np.inf
    last = np.zeros(nodal.shape[0])
    pressure, slope = np.empty_like(rest_m), np.empty_like(rest_m)
    nothing = np.zeros_like(rest_m)
    _, lands, dimple_nm, stopper_nm = places
    s = (rest_m + deflect(nodal, beam[0])) / NM
    for _ in range(60000):
        pad_pressure(s - dimple_nm, deepest_nm, pressure, slope, *pad)
        add_loads(s, pressure, slope, electric, places)
        change, _, work = newton_step(nodal, pressure * GPA, slope * (GPA / NM), nothing, inertia, *beam)
        moved = deflect(change, beam[0]) / NM
        excess, most = 0.0, 0.0
        for e in range(s.shape[0]):
            for g in range(s.shape[1]):
                way = s[e, g] - (dimple_nm + contact_nm if lands[e, g] > 0.0 else stopper_nm)
                allowed = min(max(0.25 * way, most_nm), 100.0)  # nm, of the way to landing
                excess = max(excess, abs(moved[e, g]) / allowed)
                most = max(most, abs(moved[e, g]))
        if excess > 1.0 or work < 0.0:
            inertia = max(min(max(1.2 * excess, 1.5), 10.0) * inertia, 1e6)
            if inertia < 1e25:
                continue
        nodal += change
        s += moved
        before, lowest = lowest, np.inf
        for e in range(s.shape[0]):
            for g in range(s.shape[1]):
                if lands[e, g] > 0.0:
                    deepest_nm[e, g] = min(deepest_nm[e, g], s[e, g] - dimple_nm)
                    lowest = min(lowest, s[e, g] - dimple_nm)
        if deepest_nm.min() < pad[0][0]:
            return BEYOND
        if lowest > free_nm and lowest > before:
            return FREE
        back = (change[:, 0] * last).sum() < 0.0
        last = change[:, 0].copy()
        # the curves are of straight pieces, between which plain steps may cycle: hold back more after each turn, and
        # forget it the later the more turns there were: after ten half as fast
        turns += back
        least = max(10.0 * least, 1e9) if back else least * (1.0 - 3.0 / (10 + turns))
        if excess < 0.5 or back:
            inertia = max(0.3 * inertia, least)
        # a thousandth of the length over which a pad's pressure changes (nm), a ten-thousandth of the spring's (Pa)
        if most < 1e-3 and most * NM * inertia < 1.0:
            return SETTLED if lowest < off_nm else FREE
    return UNSETTLED
