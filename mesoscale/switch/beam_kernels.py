"""Inner loops of the bending electrode: one Newton step, and the motion to balance."""

from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mesoscale.pad.local import pad_pressure
from mesoscale.units import GPA, NM

Array = NDArray[np.float64]

CLOSING_NM, OPENING_NM = 1.0, 0.25
"""Largest step of a place in contact. Where a pad of few cells tears off, longer steps overshoot:
with 0.5 and 1 nm that of `ci` (16 cells) lets go 0.9 and 1.8 % too early."""
MOST_STEPS = 60_000
"""Of a motion to balance."""
FARTHEST_NM = 100.0
"""Largest step of a place that is far from landing."""
BEGUN_PER_M = 6.6e4
"""Damping of a motion (an added stiffness) over the pull of the spring, with which it begins and
which is its floor after a reversal; 1e9 Pa/m of the default switch."""
WEAKEST_PER_M = 66.0
"""Least damping of a step that is tried again; 1e6 Pa/m of the default switch."""
STRONGEST_PER_M = 6.6e20
"""With so much damping a step is gone whatever it does, as it leads nowhere; 1e25 Pa/m of the
default switch."""
LEAST_GROWTH, LARGEST_GROWTH = 1.5, 10.0
"""Factors between which the damping grows where a step is tried again."""
DECAY = 0.3
"""Factor by which the damping falls after a step of less than half of what is allowed."""
STILL_NM = 1e-3
"""Last step of a motion that has settled: a thousandth of the length over which a pad's pressure
changes."""
BALANCED_SHARE = 6.6e-5
"""Of the pull of the spring: pressure that may be left unbalanced, 1 Pa of the default switch."""
UNEVEN_NM, UNEVEN_STEP = 5.0, 0.004
"""Separations of the table of uneven charge: `UNEVEN_NM` sinh(k `UNEVEN_STEP`), dense where fine
charge fades and in steps of 0.4 % far away."""
SETTLED, BEYOND, FREE, UNSETTLED = range(4)
"""How a motion ends: in balance, below the computed closing, off the pad, or not within the allowed
steps.
"""


class Mechanics(NamedTuple):
    """A beam of finite elements for these loops. Their shapes are Hermite's: of height and slope of
    the first node, then of the second.

    Attributes
    ----------
    shapes : at the integration points, shape (elements, 4, points).
    bending_N_m : stiffness of bending, shape (elements, 4, 4).
    pulled : stiffness of an axial force of 1 N, 1/m, shape (elements, 4, 4).
    weights_m2 : area that each integration point stands for, shape (elements, points).
    products_m2 : these times the products of two shapes, shape (elements, 4, 4, points).
    tension_N : axial force at rest.
    stretching_N_m : growth of the axial force with the length of the bent beam.
    rest : height (m) and slope of the nodes at rest, shape (nodes, 2).
    unknowns : how many of heights and slopes are free.
    """

    shapes: Array
    bending_N_m: Array
    pulled: Array
    weights_m2: Array
    products_m2: Array
    tension_N: float
    stretching_N_m: float
    rest: Array
    unknowns: int


@njit(cache=True)
def least_gap_nm(dielectric_nm):
    """Smallest electric gap: a place deeper than the dielectric allows counts as closed."""
    return 0.1 * dielectric_nm + 0.1


@njit(cache=True)
def _at_separation(separation_nm, table):
    """Value of a table at `UNEVEN_NM` sinh(k `UNEVEN_STEP`), and its slope."""
    s = max(separation_nm, 0.0)
    place = np.arcsinh(s / UNEVEN_NM) / UNEVEN_STEP
    k = min(int(place), table.size - 2)
    change = table[k + 1] - table[k]
    slope = change / UNEVEN_STEP / np.sqrt(s * s + UNEVEN_NM * UNEVEN_NM)
    return table[k] + min(place - k, 1.0) * change, slope


@njit(cache=True)
def add_loads(separation_nm, pressure, slope, electric, places):
    """Take the electrostatic pull off where the electrode is, and put stoppers where the pad is
    not.

    Parameters
    ----------
    pressure, slope : of the pad (GPa, GPa/nm) at the separation of what lands on it; changed in
        place.
    electric : dielectric over its permittivity (nm), square of the voltage, vacuum permittivity,
        fringe over width (1/nm), and what uneven charge adds to that square (V^2) at the
        separations of `UNEVEN_NM`; empty without it.
    places : see `mesoscale.switch.beam.Beam.places`.
    """
    dielectric_nm, squared_V2, permittivity, edge_per_nm, uneven_V2 = electric
    wired, lands, _, stopper_nm, stopper_GPa_nm = places
    least = least_gap_nm(dielectric_nm)
    for e in range(separation_nm.shape[0]):
        for g in range(separation_nm.shape[1]):
            s = separation_nm[e, g]
            if lands[e, g] == 0.0:
                pressure[e, g] = stopper_GPa_nm * max(stopper_nm - s, 0.0)
                slope[e, g] = -stopper_GPa_nm if s < stopper_nm else 0.0
            electric_nm = max(s + dielectric_nm, least)
            felt_V2 = squared_V2
            if uneven_V2.size > 0:
                more_V2, falls_V2_nm = _at_separation(s, uneven_V2)
                felt_V2 += more_V2
                of_square = wired[e, g] * permittivity / (2.0 * (electric_nm * NM) ** 2) / GPA
                slope[e, g] -= of_square * falls_V2_nm * (1.0 + edge_per_nm * electric_nm)
            pull = wired[e, g] * permittivity * felt_V2 / (2.0 * (electric_nm * NM) ** 2) / GPA
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

    With K the band of bending and loads, v the column and S the stretching, K x + S v (v x) = f is
    solved with the growth n of the axial force as one unknown more:

        [ K    v ] [x]   [f]
        [ S v -1 ] [n] = [0].

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
    # the row of the axial force, below those of the nodes
    corner = -1.0
    below = np.zeros(sides)
    solved = np.empty((sides + 1, 2))
    for k in range(nodes - 1):
        # the node's block [a b; b d], and [p q; r t] to the next node
        a = blocks[k, 0, 0]
        b = blocks[k, 1, 0]
        d = blocks[k, 1, 1]
        scale = 1.0 / (a * d - b * b)
        p = coupling[k, 0, 0]
        q = coupling[k, 0, 1]
        r = coupling[k, 1, 0]
        t = coupling[k, 1, 1]

        # [u v; w x]: inverse of the block times the coupling; the next block loses what it couples
        u = scale * (d * p - b * r)
        v = scale * (d * q - b * t)
        w = scale * (a * r - b * p)
        x = scale * (a * t - b * q)
        blocks[k + 1, 0, 0] -= p * u + r * w
        blocks[k + 1, 1, 0] -= q * u + t * w
        blocks[k + 1, 1, 1] -= q * v + t * x
        coupling[k, 0, 0] = u
        coupling[k, 0, 1] = v
        coupling[k, 1, 0] = w
        coupling[k, 1, 1] = x

        # [y z]: each right side, and that of stretching in the row of the axial force
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

    # the last node and the axial force together: [a b y; b d z; m n corner], by Cramer's rule
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

        # back from node to node: [f g] of the next one
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
                moved = nodal[e + j // 2, j % 2]
                middle = 0.5 * nodal[e + i // 2, i % 2] + rest[e + i // 2, i % 2]
                longer += pulled[e, i, j] * moved * middle
    return longer


@njit(cache=True)
def newton_step(nodal, pressure_Pa, slope_Pa_m, other_Pa, damping_Pa_m, beam):
    """One Newton step towards balance, and the response to another load.

    With B the stiffness of bending, G that of an axial force of 1 N, T this force at rest, n what
    it has grown by, and z the state over that at rest z0, a beam in balance has

        B z + T G z + n G (z + z0) = f(z),    n = S ((z + z0) G (z + z0) - z0 G z0) / 2.

    Linearised about z, with v = G (z + z0):

        (B + (T + n) G + damping - df/dz) change + S v (v change) = what is not balanced.

    S v v is no band matrix. So the growth of the axial force is one unknown more
    (`solve_beam_matrix`).

    Parameters
    ----------
    nodal : z, height (m) and slope of the nodes less those at rest, shape (nodes, 2).
    pressure_Pa, slope_Pa_m : pressure and its slope at the integration points, shape (elements,
        points).
    other_Pa : the other load there.
    damping_Pa_m : added stiffness that holds the beam back.
    beam : a `Mechanics`.

    Returns
    -------
    change, response : of the nodes to what is not balanced and to the other load, shape (nodes, 2)
        each.
    work : of the unbalanced forces on the change. It is negative where the step is one to a balance
        that is not stable.
    """
    elements, points = pressure_Pa.shape
    nodes = beam.unknowns // 2
    blocks = np.zeros((nodes, 2, 2))
    coupling = np.zeros((nodes, 2, 2))
    right = np.zeros((nodes, 3, 2))
    growth_N = beam.stretching_N_m * elongation(nodal, beam.pulled, beam.rest)
    # Hermite's four shapes of an element: i and j are height (0) and slope (1) of its first node,
    # and of its second (2, 3); the clamped node of the beam is none of the unknown ones
    for e in range(elements):
        for i in range(4):
            node = e + i // 2 - 1
            which = i % 2
            if node < 0 or node >= nodes:
                continue

            # forces of the two loads on shape i
            pushed = 0.0
            other = 0.0
            for g in range(points):
                share = beam.weights_m2[e, g] * beam.shapes[e, i, g]
                pushed += pressure_Pa[e, g] * share
                other += other_Pa[e, g] * share
            right[node, 1, which] += other
            for j in range(4):
                # forces of bending and tension on it
                moved = nodal[e + j // 2, j % 2]
                at_rest = beam.rest[e + j // 2, j % 2]
                drawn = beam.pulled[e, i, j]
                tension_part = beam.tension_N * moved + growth_N * (moved + at_rest)
                pushed -= beam.bending_N_m[e, i, j] * moved + drawn * tension_part
                right[node, 2, which] += drawn * (moved + at_rest)

                # the matrix is symmetric: one half of it is enough
                if j > i or e + j // 2 < 1:
                    continue
                entry = beam.bending_N_m[e, i, j] + (beam.tension_N + growth_N) * drawn
                for g in range(points):
                    entry += (damping_Pa_m - slope_Pa_m[e, g]) * beam.products_m2[e, i, j, g]
                if i // 2 == j // 2:
                    blocks[node, which, j % 2] += entry
                else:
                    coupling[node - 1, j % 2, which] += entry
            right[node, 0, which] += pushed

    force = right[:, 0].copy()
    solve_beam_matrix(blocks, coupling, right, beam.stretching_N_m)
    change = np.zeros((elements + 1, 2))
    response = np.zeros((elements + 1, 2))
    work = 0.0
    # in loops: what numba brings for assigning a part of an array takes seconds to compile
    for node in range(nodes):
        for which in range(2):
            change[1 + node, which] = right[node, 0, which]
            response[1 + node, which] = right[node, 1, which]
            work += force[node, which] * right[node, 0, which]
    return change, response, work


@njit(cache=True)
def deflect(nodal, shapes):
    """Deflection at the integration points, shape (elements, points)."""
    deflection = np.zeros((nodal.shape[0] - 1, shapes.shape[2]))
    for e in range(deflection.shape[0]):
        for g in range(deflection.shape[1]):
            for i in range(4):
                deflection[e, g] += nodal[e + i // 2, i % 2] * shapes[e, i, g]
    return deflection


@njit(cache=True)
def _longest(moved, s, places, contact_nm, longest_nm):
    """Largest step (nm) of all places, and the largest step over what is allowed there.

    Allowed is a quarter of the way to landing, but at least `longest_nm` and at most `FARTHEST_NM`.
    """
    _, lands, dimple_nm, stopper_nm, _ = places
    largest_nm = 0.0
    excess = 0.0
    for e in range(s.shape[0]):
        for g in range(s.shape[1]):
            height_nm = s[e, g] - stopper_nm
            if lands[e, g] > 0.0:
                height_nm = s[e, g] - (dimple_nm + contact_nm)
            allowed_nm = min(max(0.25 * height_nm, longest_nm), FARTHEST_NM)
            excess = max(excess, abs(moved[e, g]) / allowed_nm)
            largest_nm = max(largest_nm, abs(moved[e, g]))
    return largest_nm, excess


@njit(cache=True)
def _remember(deepest_nm, s, places):
    """Note how deep each place came, and return the lowest separation of places that land."""
    _, lands, dimple_nm, _, _ = places
    lowest_nm = np.inf
    for e in range(s.shape[0]):
        for g in range(s.shape[1]):
            if lands[e, g] > 0.0:
                height_nm = s[e, g] - dimple_nm
                deepest_nm[e, g] = min(deepest_nm[e, g], height_nm)
                lowest_nm = min(lowest_nm, height_nm)
    return lowest_nm


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
    longest_nm,
):
    """Let a beam move to balance at one voltage, every place remembering how deep it came; both
    changed in place.

    The motion is overdamped. Each step is Newton's, with a stiffness added that holds the beam
    back: its damping, in Pa/m.

    - A step that is too long, or that leads to a balance which is not stable, is tried again with
      more damping.
    - After a short step the damping falls, down to a floor.
    - The curves of a pad are of straight pieces, between which plain steps may go back and forth
      for ever. So a reversal raises the floor tenfold. Without one the floor sinks, the more slowly
      the more reversals there were: after ten half as fast.

    Parameters
    ----------
    beam : a `Mechanics`.
    places, pad, electric : what `add_loads`, `pad_pressure` and `add_loads` take of them.
    spring_Pa : pull of the spring, the scale of all pressures; see
        `mesoscale.switch.beam.Beam.spring_Pa`.
    contact_nm : separation at which a place is about to land.
    off_nm : in balance above it, no place is in contact.
    free_nm : a rising beam is off the pad where no place is below this separation.
    longest_nm : largest step of a place in contact.
    """
    begun = BEGUN_PER_M * spring_Pa
    weakest = WEAKEST_PER_M * spring_Pa
    strongest = STRONGEST_PER_M * spring_Pa
    damping = begun
    damping_floor = 0.0
    reversals = 0
    lowest_nm = np.inf
    last_change = np.zeros(nodal.shape[0])
    pressure = np.empty_like(rest_m)
    slope = np.empty_like(rest_m)
    nothing = np.zeros_like(rest_m)
    dimple_nm = places[2]
    s = (rest_m + deflect(nodal, beam.shapes)) / NM
    for _ in range(MOST_STEPS):
        pad_pressure(s - dimple_nm, deepest_nm, pressure, slope, *pad)
        add_loads(s, pressure, slope, electric, places)
        change, _, work = newton_step(
            nodal, pressure * GPA, slope * (GPA / NM), nothing, damping, beam
        )
        moved = deflect(change, beam.shapes) / NM
        largest_nm, excess = _longest(moved, s, places, contact_nm, longest_nm)

        # too far, or towards a balance that is not stable
        if excess > 1.0 or work < 0.0:
            growth = min(max(1.2 * excess, LEAST_GROWTH), LARGEST_GROWTH)
            damping = max(growth * damping, weakest)
            if damping < strongest:
                continue

        nodal += change
        s += moved
        lowest_before_nm = lowest_nm
        lowest_nm = _remember(deepest_nm, s, places)
        if deepest_nm.min() < pad[0][0]:
            return BEYOND
        if lowest_nm > free_nm and lowest_nm > lowest_before_nm:
            return FREE

        reversed_now = (change[:, 0] * last_change).sum() < 0.0
        last_change = change[:, 0].copy()
        if reversed_now:
            reversals += 1
            damping_floor = max(10.0 * damping_floor, begun)
        else:
            damping_floor = damping_floor * (1.0 - 3.0 / (10 + reversals))
        if excess < 0.5 or reversed_now:
            damping = max(DECAY * damping, damping_floor)

        unbalanced_Pa = largest_nm * NM * damping
        if largest_nm < STILL_NM and unbalanced_Pa < BALANCED_SHARE * spring_Pa:
            if lowest_nm < off_nm:
                return SETTLED
            return FREE
    return UNSETTLED
