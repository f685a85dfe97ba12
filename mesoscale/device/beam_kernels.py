"""Inner loops of the bending electrode: one Newton step, and the motion to balance."""

import numpy as np
from numba import njit

from mesoscale.pad.local import pad_pressure

BANDS = 3
"""Half bandwidth of the beam's matrix: two nodes of an element have a deflection and a slope."""
NM = 1e-9
GPA = 1e9
MOST_STEPS = 60000
LARGEST_STEP_NM = 20.0
"""Step of a place of the creeping beam that is far from contact; in contact `LARGEST_CHANGE_NM`."""
LARGEST_CHANGE_NM = 1.0
SHARE_OF_WAY = 0.25
"""A place that is about to land moves by this share of its way."""
PATIENCE = 10
"""Turns after which the motion forgets half as fast that it was held back."""
SETTLED_NM = 1e-3
"""Last step of a beam in balance, a thousandth of the length over which the pressure of a pad changes."""
SETTLED_Pa = 1.0
"""Pressure that is then left over, a ten-thousandth of the spring's."""
SETTLED, BEYOND, FREE, UNSETTLED = range(4)
"""How a motion ends: in balance, below the computed closing, off the pad, or not within the allowed steps."""


@njit(cache=True)
def least_gap_nm(dielectric_nm):
    """Smallest electric gap: a place deeper than the dielectric allows counts as closed."""
    return 0.1 * dielectric_nm + 0.1


@njit(cache=True)
def add_voltage(separation_nm, pressure, slope, dielectric_nm, squared_V2, permittivity):
    """Take the electrostatic pull off."""
    least = least_gap_nm(dielectric_nm)
    for e in range(separation_nm.shape[0]):
        for g in range(separation_nm.shape[1]):
            electric_nm = max(separation_nm[e, g] + dielectric_nm, least)
            pull = permittivity * squared_V2 / (2.0 * (electric_nm * NM) ** 2) / GPA
            pressure[e, g] -= pull
            slope[e, g] += 2.0 * pull / electric_nm


@njit(cache=True)
def solve_bands(bands, right):
    """Gauss with row exchanges on a matrix of half bandwidth BANDS, row by row in `bands` (n, 3 BANDS + 1); in place.

    Entry (i, j) stands in bands[i, j - i + BANDS]; the last BANDS columns are room for the exchanges.
    """
    n = len(bands)
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
            for side in range(right.shape[1]):
                kept = right[k, side]
                right[k, side] = right[best, side]
                right[best, side] = kept
        for i in range(k + 1, end):
            factor = bands[i, k - i + BANDS] / bands[k, BANDS]
            if factor != 0.0:
                for j in range(k + 1, min(k + 2 * BANDS + 1, n)):
                    bands[i, j - i + BANDS] -= factor * bands[k, j - k + BANDS]
                for side in range(right.shape[1]):
                    right[i, side] -= factor * right[k, side]
    for k in range(n - 1, -1, -1):
        for side in range(right.shape[1]):
            total = right[k, side]
            for j in range(k + 1, min(k + 2 * BANDS + 1, n)):
                total -= bands[k, j - k + BANDS] * right[j, side]
            right[k, side] = total / bands[k, BANDS]


@njit(cache=True)
def newton_step(nodal, pressure_Pa, slope_Pa_m, other_Pa, inertia, shape, stiffness, weights):
    """One Newton step towards balance, and the answer to another load, of clamped nodes; shape (nodes, 2) each."""
    elements, points = pressure_Pa.shape
    unknowns = 2 * elements - 2
    bands, right = np.zeros((unknowns, 3 * BANDS + 1)), np.zeros((unknowns, 2))
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
                right[row, 0] -= stiffness[e, i, j] * nodal[e + j // 2, j % 2]
                column = 2 * e + j - 2
                if column < 0 or column >= unknowns:
                    continue
                entry = stiffness[e, i, j]
                for g in range(points):
                    entry += (inertia - slope_Pa_m[e, g]) * weights[e, g] * shape[e, i, g] * shape[e, j, g]
                bands[row, column - row + BANDS] += entry
    solve_bands(bands, right)
    change, answer = np.zeros((elements + 1, 2)), np.zeros((elements + 1, 2))
    # in loops: what numba brings for assigning a part of an array takes seconds to compile
    for row in range(unknowns):
        change[1 + row // 2, row % 2] = right[row, 0]
        answer[1 + row // 2, row % 2] = right[row, 1]
    return change, answer


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
def creep(nodal, deepest_nm, rest_m, beam, pad, electric, contact_nm, free_nm):
    """Let a beam move to balance at one voltage, every place remembering how deep it came; both changed in place.

    The beam is held back by an added stiffness that grows where steps are too large: an overdamped motion.

    Parameters
    ----------
    beam, pad, electric : what `newton_step`, `pad_pressure` and `add_voltage` take last.
    contact_nm : separation at which a place is about to land.
    free_nm : the motion ends where no place is below this separation.
    """
    inertia, least, turns = 1e9, 0.0, 0
    last = np.zeros(nodal.shape[0])
    pressure, slope = np.empty_like(rest_m), np.empty_like(rest_m)
    nothing = np.zeros_like(rest_m)
    s = (rest_m + deflect(nodal, beam[0])) / NM
    for _ in range(MOST_STEPS):
        pad_pressure(s, deepest_nm, pressure, slope, *pad)
        add_voltage(s, pressure, slope, *electric)
        change, _ = newton_step(nodal, pressure * GPA, slope * (GPA / NM), nothing, inertia, *beam)
        moved = deflect(change, beam[0]) / NM
        excess, most = 0.0, 0.0
        for e in range(s.shape[0]):
            for g in range(s.shape[1]):
                way = SHARE_OF_WAY * (s[e, g] - contact_nm)
                allowed = min(max(way, LARGEST_CHANGE_NM), LARGEST_STEP_NM)
                excess = max(excess, abs(moved[e, g]) / allowed)
                most = max(most, abs(moved[e, g]))
        if excess > 1.0:
            inertia = max(min(max(1.2 * excess, 1.5), 10.0) * inertia, 1e6)
            if inertia < 1e25:
                continue
        nodal += change
        s += moved
        for e in range(s.shape[0]):
            for g in range(s.shape[1]):
                deepest_nm[e, g] = min(deepest_nm[e, g], s[e, g])
        if deepest_nm.min() < pad[0][0]:
            return BEYOND
        if s.min() > free_nm:
            return FREE
        back = (change[:, 0] * last).sum() < 0.0
        last = change[:, 0].copy()
        # the curves are of straight pieces, between which plain steps may cycle: hold back more after each turn, and
        # forget it the later the more turns there were
        turns += back
        least = max(10.0 * least, 1e9) if back else least * (1.0 - 0.3 * PATIENCE / (PATIENCE + turns))
        if excess < 0.5 or back:
            inertia = max(0.3 * inertia, least)
        if most < SETTLED_NM and most * NM * inertia < SETTLED_Pa:
            return SETTLED
    return UNSETTLED
