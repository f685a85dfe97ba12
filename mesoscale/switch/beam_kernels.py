"""Inner loops of the bending electrode: one Newton step, and the motion to balance."""

import numpy as np
from numba import njit

from mesoscale.pad.local import pad_pressure
from mesoscale.units import GPA, NM

CLOSING_NM, OPENING_NM = 1.0, 0.25
"""Largest step of a place in contact. Where a pad of few cells tears off, longer steps overshoot:
with 0.5 and 1 nm that of `ci` (16 cells) lets go 0.9 and 1.8 % too early."""
SETTLED, BEYOND, FREE, UNSETTLED = range(4)
"""How a motion ends: in balance, below the computed closing, off the pad, or not within the allowed
steps.
"""


@njit(cache=True)
def least_gap_nm(dielectric_nm):
    """Smallest electric gap: a place deeper than the dielectric allows counts as closed."""
    return 0.1 * dielectric_nm + 0.1


@njit(cache=True)
def add_loads(separation_nm, pressure, slope, electric, places):
    """Take the electrostatic pull off where the electrode is, and put stoppers where the pad is
    not.

    Parameters
    ----------
    pressure, slope : of the pad (GPa, GPa/nm) at the separation of what lands on it; changed in
        place.
    electric : dielectric over its permittivity (nm), square of the voltage, vacuum permittivity,
        fringe over width
        (1/nm).
    places : see `mesoscale.switch.beam.Beam.places`.
    """
    dielectric_nm, squared_V2, permittivity, edge_per_nm = electric
    wired, lands, _, stopper_nm, stopper_GPa_nm = places
    least = least_gap_nm(dielectric_nm)
    for e in range(separation_nm.shape[0]):
        for g in range(separation_nm.shape[1]):
            s = separation_nm[e, g]
            if lands[e, g] == 0.0:
                pressure[e, g] = stopper_GPa_nm * max(stopper_nm - s, 0.0)
                slope[e, g] = -stopper_GPa_nm if s < stopper_nm else 0.0
            electric_nm = max(s + dielectric_nm, least)
            pull = wired[e, g] * permittivity * squared_V2 / (2.0 * (electric_nm * NM) ** 2) / GPA
            pressure[e, g] -= pull * (1.0 + edge_per_nm * electric_nm)
            slope[e, g] += pull * (2.0 / electric_nm + edge_per_nm)


@njit(cache=True)
def determinant(a, b, c, d, e, f, g, h, i):
    """Of a matrix of three rows."""
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)


@njit(cache=True)
def solve_beam_matrix(blocks, coupling, right, stretching):
    """Solve for the nodes of a beam, whose stretching adds `stretching` times a column times
    itself; in place.

    Nodes are eliminated one after the other, the last one together with the axial force: there the
    matrix may be singular, as it is where a beam buckles or snaps (W. Govaerts, Numerical Methods
    for Bifurcations of Dynamical Equilibria, SIAM 2000, section 3). Parts of the beam are singular
    to the last digits by chance alone.

    Parameters
    ----------
    blocks : symmetric blocks of the nodes, shape (nodes, 2, 2); [0, 1] is not read.
    coupling : blocks of a node (rows) and the next (columns), shape (nodes, 2, 2).
    right : right sides, of which the last is the column of stretching, shape (nodes, sides + 1, 2).
    """
    nodes = len(blocks)
    sides = right.shape[1] - 1
    corner = -1.0
    below = np.zeros(sides)
    solved = np.empty((sides + 1, 2))
    for k in range(nodes - 1):
        a = blocks[k, 0, 0]
        b = blocks[k, 1, 0]
        d = blocks[k, 1, 1]
        scale = 1.0 / (a * d - b * b)
        p = coupling[k, 0, 0]
        q = coupling[k, 0, 1]
        r = coupling[k, 1, 0]
        t = coupling[k, 1, 1]
        # inverse of the node's block times that to the next
        u = scale * (d * p - b * r)
        v = scale * (d * q - b * t)
        w = scale * (a * r - b * p)
        x = scale * (a * t - b * q)
        blocks[k + 1, 0, 0] -= p * u + r * w
        blocks[k + 1, 1, 0] -= q * u + t * w
        blocks[k + 1, 1, 1] -= q * v + t * x
        coupling[k, 0, 0], coupling[k, 0, 1], coupling[k, 1, 0], coupling[k, 1, 1] = u, v, w, x
        for side in range(sides + 1):
            y, z = right[k, side]
            solved[side, 0] = scale * (d * y - b * z)
            solved[side, 1] = scale * (a * z - b * y)
            right[k + 1, side, 0] -= u * y + w * z
            right[k + 1, side, 1] -= v * y + x * z
        y, z = right[k, sides]
        corner -= stretching * (y * solved[sides, 0] + z * solved[sides, 1])
        for side in range(sides):
            below[side] -= stretching * (y * solved[side, 0] + z * solved[side, 1])
        right[k] = solved
    a = blocks[-1, 0, 0]
    b = blocks[-1, 1, 0]
    d = blocks[-1, 1, 1]
    y, z = right[-1, sides]
    m = stretching * y
    n = stretching * z
    full_determinant = determinant(a, b, y, b, d, z, m, n, corner)
    for side in range(sides):
        f = right[-1, side, 0]
        g = right[-1, side, 1]
        h = below[side]
        right[-1, side, 0] = determinant(f, b, y, g, d, z, h, n, corner) / full_determinant
        right[-1, side, 1] = determinant(a, f, y, b, g, z, m, h, corner) / full_determinant
        force = determinant(a, b, f, b, d, g, m, n, h) / full_determinant
        for k in range(nodes - 2, -1, -1):
            f, g = right[k + 1, side]
            right[k, side, 0] -= (
                right[k, sides, 0] * force + coupling[k, 0, 0] * f + coupling[k, 0, 1] * g
            )
            right[k, side, 1] -= (
                right[k, sides, 1] * force + coupling[k, 1, 0] * f + coupling[k, 1, 1] * g
            )


@njit(cache=True)
def elongation(nodal, pulled, rest):
    """By how much a beam is longer than at rest (m), int (z'^2 - z0'^2) / 2 dx."""
    longer = 0.0
    for e in range(nodal.shape[0] - 1):
        for i in range(4):
            for j in range(4):
                more = nodal[e + j // 2, j % 2]
                longer += (
                    pulled[e, i, j]
                    * more
                    * (0.5 * nodal[e + i // 2, i % 2] + rest[e + i // 2, i % 2])
                )
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
    """One Newton step towards balance, and the answer to another load, of the free nodes; shape
    (nodes, 2) each.

    The work of the unbalanced forces on the step comes third. It is negative where the step is one
    to a balance that is not stable. Stretching adds a product of one vector with itself to the
    matrix, which then is no band any more: so the growth of the axial force is one unknown more.
    """
    elements, points = pressure_Pa.shape
    nodes = unknowns // 2
    blocks = np.zeros((nodes, 2, 2))
    coupling = np.zeros((nodes, 2, 2))
    right = np.zeros((nodes, 3, 2))
    more = stretching * elongation(nodal, pulled, rest)
    for e in range(elements):
        for i in range(4):
            node = e + i // 2 - 1
            turned = i % 2
            if node < 0 or node >= nodes:
                continue
            pushed, other = 0.0, 0.0
            for g in range(points):
                share = weights[e, g] * shape[e, i, g]
                pushed += pressure_Pa[e, g] * share
                other += other_Pa[e, g] * share
            right[node, 1, turned] += other
            for j in range(4):
                moved = nodal[e + j // 2, j % 2]
                at_rest = rest[e + j // 2, j % 2]
                drawn = pulled[e, i, j]
                pushed -= bends[e, i, j] * moved + drawn * (
                    tension * moved + more * (moved + at_rest)
                )
                right[node, 2, turned] += drawn * (moved + at_rest)
                if j > i or e + j // 2 < 1:
                    continue
                entry = bends[e, i, j] + (tension + more) * drawn
                for g in range(points):
                    entry += (inertia - slope_Pa_m[e, g]) * coupled[e, i, j, g]
                if i // 2 == j // 2:
                    blocks[node, turned, j % 2] += entry
                else:
                    coupling[node - 1, j % 2, turned] += entry
            right[node, 0, turned] += pushed
    force = right[:, 0].copy()
    solve_beam_matrix(blocks, coupling, right, stretching)
    change = np.zeros((elements + 1, 2))
    answer = np.zeros((elements + 1, 2))
    work = 0.0
    # in loops: what numba brings for assigning a part of an array takes seconds to compile
    for node in range(nodes):
        for turned in range(2):
            change[1 + node, turned] = right[node, 0, turned]
            answer[1 + node, turned] = right[node, 1, turned]
            work += force[node, turned] * right[node, 0, turned]
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
def creep(
    nodal,
    deepest_nm,
    rest_m,
    beam,
    places,
    pad,
    electric,
    spring_Pa,
    contact_nm,
    off_nm,
    free_nm,
    most_nm,
):
    """Let a beam move to balance at one voltage, every place remembering how deep it came; both
    changed in place.

    The beam is held back by an added stiffness that grows where steps are too large: an overdamped
    motion.

    Parameters
    ----------
    beam, places, pad, electric : what `newton_step`, `add_loads` and `pad_pressure` take last.
    spring_Pa : pull of the spring, the scale of all pressures; see
        `mesoscale.switch.beam.Beam.spring_Pa`.
    contact_nm : separation at which a place is about to land.
    off_nm : in balance above it, no place is in contact.
    free_nm : a rising beam is off the pad where no place is below this separation.
    most_nm : largest step of a place in contact.
    """
    # stiffnesses (Pa/m) that hold the beam back: where it begins and after a turn, the least, and
    # that of a step which is gone whatever it does: 1e9, 1e6 and 1e25 of the default switch
    begun = 6.6e4 * spring_Pa
    weakest = 66.0 * spring_Pa
    strongest = 6.6e20 * spring_Pa
    inertia, least, turns, lowest = begun, 0.0, 0, np.inf
    last = np.zeros(nodal.shape[0])
    pressure = np.empty_like(rest_m)
    slope = np.empty_like(rest_m)
    nothing = np.zeros_like(rest_m)
    _, lands, dimple_nm, stopper_nm, _ = places
    s = (rest_m + deflect(nodal, beam[0])) / NM
    for _ in range(60000):
        pad_pressure(s - dimple_nm, deepest_nm, pressure, slope, *pad)
        add_loads(s, pressure, slope, electric, places)
        change, _, work = newton_step(
            nodal, pressure * GPA, slope * (GPA / NM), nothing, inertia, *beam
        )
        moved = deflect(change, beam[0]) / NM
        excess, largest_move = 0.0, 0.0
        for e in range(s.shape[0]):
            for g in range(s.shape[1]):
                height_nm = s[e, g] - (dimple_nm + contact_nm if lands[e, g] > 0.0 else stopper_nm)
                allowed = min(max(0.25 * height_nm, most_nm), 100.0)  # nm, of the way to landing
                excess = max(excess, abs(moved[e, g]) / allowed)
                largest_move = max(largest_move, abs(moved[e, g]))
        if excess > 1.0 or work < 0.0:
            inertia = max(min(max(1.2 * excess, 1.5), 10.0) * inertia, weakest)
            if inertia < strongest:
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
        # the curves are of straight pieces, between which plain steps may cycle: hold back more
        # after each turn, and forget it the later the more turns there were: after ten half as fast
        turns += back
        least = max(10.0 * least, begun) if back else least * (1.0 - 3.0 / (10 + turns))
        if excess < 0.5 or back:
            inertia = max(0.3 * inertia, least)
        # a thousandth of the length over which a pad's pressure changes (nm), 1 Pa of the default
        # switch
        if largest_move < 1e-3 and largest_move * NM * inertia < 6.6e-5 * spring_Pa:
            return SETTLED if lowest < off_nm else FREE
    return UNSETTLED
