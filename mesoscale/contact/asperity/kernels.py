"""Compiled loops: which sites touch and belong together, forces, plastic flow (section 2.2).

A site touches where h < level, with level = -separation. Connected touching sites (periodic, 8
neighbours) form an asperity. The set is kept up to date locally: sites that come into contact start
a flood fill that takes over every asperity it meets, and nothing else is looked at.

All loops that call each other are in this one file, because numba's cache on disk does not notice
changes in functions that come from another one.
"""

import numpy as np
from numba import njit

REACH = 3.0  # a flow ends 3 s2 away from the peak, at 1 % of the second Gaussian's amplitude


@njit(cache=True, inline="always")
def site_curvature(height, north, south, west, east, spacing):
    """Mean of the profile curvatures at a site, 1/nm; positive at a minimum (eq. 2, corrected)."""
    slope_x = (east - west) / (2.0 * spacing)
    slope_y = (south - north) / (2.0 * spacing)
    fx = 1.0 + slope_x * slope_x
    fy = 1.0 + slope_y * slope_y
    kx = (east + west - 2.0 * height) / (fx * np.sqrt(fx))
    ky = (south + north - 2.0 * height) / (fy * np.sqrt(fy))
    return 0.5 * (kx + ky) / (spacing * spacing)


@njit(cache=True)
def grow(asperities, heights, n, level, spacing, seed):
    """Make the asperity that contains the touching site ``seed``; returns its number."""
    label, arena = asperities.label, asperities.arena
    firsts, counts = asperities.first, asperities.sites
    number = asperities.used[0]
    mine = np.int32(number + 1)
    start = asperities.used[1]
    end = start
    arena[end] = seed
    label[seed] = mine
    end += 1
    visited = start
    peak = seed
    lowest = heights[seed]
    curvature = 0.0
    around = np.empty(8, np.int64)
    while visited < end:
        site = np.int64(arena[visited])
        visited += 1
        height = heights[site]
        if height < lowest or (height == lowest and site < peak):
            lowest = height
            peak = site
        row = site // n
        col = site - row * n
        # neighbours in the periodic cell
        north = site - n
        if row == 0:
            north += n * n
        south = site + n
        if row == n - 1:
            south -= n * n
        west = -1
        if col == 0:
            west += n
        east = 1
        if col == n - 1:
            east -= n
        around[0] = north
        around[1] = south
        around[2] = site + west
        around[3] = site + east
        around[4] = north + west
        around[5] = north + east
        around[6] = south + west
        around[7] = south + east
        curvature += site_curvature(
            height,
            heights[north],
            heights[south],
            heights[site + west],
            heights[site + east],
            spacing,
        )
        for k in range(8):
            other = np.uint64(around[k])
            if heights[other] < level:
                owner = label[other]
                if owner != mine:
                    if owner > 0:  # an asperity of its own so far: free its sites
                        first = firsts[owner - 1]
                        for place in range(first, first + counts[owner - 1]):
                            label[arena[place]] = 0
                        counts[owner - 1] = 0
                    label[other] = mine
                    arena[end] = other
                    end += 1
    firsts[number] = start
    counts[number] = end - start
    asperities.peak[number] = peak
    asperities.lowest[number] = lowest
    asperities.curvature[number] = curvature
    asperities.used[0] = number + 1
    asperities.used[1] = end
    return number


@njit(cache=True)
def kill(asperities, number):
    """Free the sites of an asperity."""
    first = asperities.first[number]
    for place in range(first, first + asperities.sites[number]):
        asperities.label[asperities.arena[place]] = 0
    asperities.sites[number] = 0


@njit(cache=True)
def compact(asperities):
    """Close the gaps that dead asperities left; the living keep their order."""
    label, arena, used = asperities.label, asperities.arena, asperities.used
    number = 0
    end = 0
    for old in range(used[0]):
        count = asperities.sites[old]
        if count == 0:
            continue
        first = asperities.first[old]
        for k in range(count):
            arena[end + k] = arena[first + k]
            label[arena[end + k]] = number + 1
        asperities.first[number] = end
        asperities.sites[number] = count
        asperities.peak[number] = asperities.peak[old]
        asperities.lowest[number] = asperities.lowest[old]
        asperities.curvature[number] = asperities.curvature[old]
        number += 1
        end += count
    used[0] = number
    used[1] = end


@njit(cache=True)
def clear(asperities):
    """Forget all contacts."""
    for number in range(asperities.used[0]):
        if asperities.sites[number] > 0:
            kill(asperities, number)
    asperities.used[:] = 0


@njit(cache=True)
def touch(
    asperities,
    heights,
    n,
    level,
    spacing,
    order,
    start,
    stop,
    changed,
    changed_sites,
    changed_count,
):
    """Bring all sites below ``level`` into contact.

    Looks at ``order[start:stop]``, the sites whose original height lies between the last level and
    this one, and at the sites that plastic flow has moved.
    """
    if asperities.used[1] > heights.size or asperities.used[0] > heights.size // 2:
        compact(asperities)
    for place in range(start, stop):
        site = order[place]
        if changed[site] == 0 and asperities.label[site] == 0:
            grow(asperities, heights, n, level, spacing, site)
    for place in range(changed_count):
        site = changed_sites[place]
        if heights[site] < level and asperities.label[site] == 0:
            grow(asperities, heights, n, level, spacing, site)


@njit(cache=True)
def shape(asperities, number, level, mechanics):
    """Indentation, radius, area (nm, nm, nm^2) and whether the bound on R acts, of one asperity.

    The radius is bounded so that no asperity is stiffer than a rigid flat punch of its own area, R
    <= 9 A / (4 pi delta): sites of mean curvature <= 0 (flattened tops) have no radius of their
    own.
    """
    count = asperities.sites[number]
    area = count * mechanics.site_area
    indentation = level - asperities.lowest[number]
    bounded = False
    if mechanics.curvature_radius:
        bound = 9.0 * area / (4.0 * np.pi * indentation)
        mean = asperities.curvature[number] / count
        if mean * bound > 1.0:
            radius = 1.0 / mean
        else:
            radius = bound
            bounded = True
    else:
        radius = area / (2.0 * np.pi * indentation)
    if not mechanics.area_of_sites:
        area = np.pi * radius * indentation
    return indentation, radius, area, bounded


@njit(cache=True)
def hardness(area, mechanics):
    """H(A) in GPa, as `HardnessLaw.pressure`."""
    law = mechanics.hardness
    length = np.sqrt(area)
    base = law.h_macro + law.h_prime / np.sqrt(length)
    if law.t_film == 0.0:
        return base
    crossover = law.k_film * (length / law.t_film) ** law.m_film
    return base + (law.h_film - base) / (1.0 + crossover)


@njit(cache=True)
def total_force(asperities, level, mechanics, capped):
    """Repulsive force; ``capped``: at most H A each (eq. 4).

    Returns the force (nN), sites, asperities, bounds on R in use, and the largest F / (H A) before
    the cap.
    """
    force = 0.0
    sites = 0
    alive = 0
    bounds = 0
    load = 0.0
    for number in range(asperities.used[0]):
        if asperities.sites[number] == 0:
            continue
        indentation, radius, area, bounded = shape(asperities, number, level, mechanics)
        single = mechanics.stiffness * np.sqrt(radius * indentation) * indentation
        ceiling = hardness(area, mechanics) * area
        ratio = np.inf
        if ceiling > 0.0:
            ratio = single / ceiling
        load = max(load, ratio)
        if capped:
            single = min(single, ceiling)
        force += single
        sites += asperities.sites[number]
        alive += 1
        bounds += bounded
    return force, sites, alive, bounds, load


@njit(cache=True)
def _gaussian(width, half, spacing, values):
    """Fill in the values at -half .. half sites; returns their sum."""
    values[half] = 1.0
    total = 1.0
    for k in range(1, half + 1):
        x = k * spacing / width
        value = np.exp(-0.5 * x * x)
        values[half - k] = value
        values[half + k] = value
        total += 2.0 * value
    return total


@njit(cache=True)
def _add_flow(heights, n, spacing, peak, amplitude, narrow, rule, changes, g1, g2):
    """Add amplitude * (G1 - c G2) around a peak, with c such that the sum over the grid is zero.

    Return mapping: scaled so that the peak moves by exactly the amplitude. ``g1``, ``g2``: room for
    the two Gaussians. Returns the patch's half-width.
    """
    wide = rule.ratio * narrow
    half = min(int(np.ceil(REACH * wide / spacing)), (n - 1) // 2)
    balance = (_gaussian(narrow, half, spacing, g1) / _gaussian(wide, half, spacing, g2)) ** 2
    if not rule.fixed:
        amplitude /= 1.0 - balance
    # bare arrays and unsigned numbers: no counting of references, no check for indices below zero
    changed, sites, original = changes.changed, changes.sites, changes.original
    journal, before, stamp = changes.journal, changes.before, changes.stamp
    step = np.int32(changes.used[2])
    recorded = changes.used[1]
    known = changes.used[0]
    width = 2 * half + 1
    top = peak // n - half
    left = peak % n - half
    if left < 0:
        left += n
    before_edge = min(width, n - left)
    for k in range(width):
        row = top + k
        if row < 0:
            row += n
        elif row >= n:
            row -= n
        f1 = amplitude * g1[k]
        f2 = amplitude * balance * g2[k]
        # columns up to the cell's edge, then those wrapped around it
        for patch in range(2):
            origin = np.uint64(row * n + left)
            offset = np.uint64(0)
            count = np.uint64(before_edge)
            if patch == 1:
                origin = np.uint64(row * n)
                offset = np.uint64(before_edge)
                count = np.uint64(width - before_edge)
            unknown = 0
            for m in range(count):
                unknown += stamp[origin + m] != step
            if unknown > 0:
                for m in range(count):
                    site = origin + m
                    if stamp[site] != step:
                        stamp[site] = step
                        journal[recorded] = site
                        before[recorded] = heights[site]
                        recorded += 1
                        if changed[site] == 0:
                            changed[site] = 1
                            sites[known] = site
                            original[known] = heights[site]
                            known += 1
            for m in range(count):
                heights[origin + m] += f1 * g1[offset + m] - f2 * g2[offset + m]
    changes.used[1] = recorded
    changes.used[0] = known
    return half


@njit(cache=True)
def _release(heights, n, level, peak, reach, asperities, seeds, waiting):
    """Break up the asperities within ``reach`` of a peak; their touching sites wait for others.

    A waiting site has label -1. Returns the number of waiting sites.
    """
    label = asperities.label
    arena = asperities.arena
    firsts = asperities.first
    counts = asperities.sites
    width = 2 * reach + 1
    top = peak // n - reach
    left = peak % n - reach
    if left < 0:
        left += n
    before_edge = min(width, n - left)
    for k in range(width):
        row = top + k
        if row < 0:
            row += n
        elif row >= n:
            row -= n
        for patch in range(2):
            origin = np.uint64(row * n + left)
            count = np.uint64(before_edge)
            if patch == 1:
                origin = np.uint64(row * n)
                count = np.uint64(width - before_edge)
            reached = 0
            for m in range(count):
                owner = label[origin + m]
                reached += (owner > 0) | ((owner == 0) & (heights[origin + m] < level))
            if reached == 0:
                continue
            for m in range(count):
                site = origin + m
                owner = label[site]
                if owner > 0:
                    first = firsts[owner - 1]
                    last = first + counts[owner - 1]
                    counts[owner - 1] = 0
                    for place in range(first, last):
                        member = arena[place]
                        if heights[member] < level:
                            label[member] = -1
                            seeds[waiting] = member
                            waiting += 1
                        else:
                            label[member] = 0
                elif owner == 0 and heights[site] < level:
                    label[site] = -1
                    seeds[waiting] = site
                    waiting += 1
    return waiting


@njit(cache=True)
def _find_yielding(heights, level, asperities, mechanics, rule, work, actives):
    """List the asperities above their hardness by the site of their peak; returns how many.

    None yields where every site touches: flow keeps the volume, and there is nowhere left to flow
    to.
    """
    yielding = 0
    for k in range(actives):
        number = work.active[k]
        if asperities.sites[number] == 0 or asperities.sites[number] == heights.size:
            continue
        indentation, radius, area, _ = shape(asperities, number, level, mechanics)
        force = mechanics.stiffness * np.sqrt(radius * indentation) * indentation
        ceiling = hardness(area, mechanics) * area
        if force <= ceiling * (1.0 + rule.tolerance):
            continue
        work.yielding[yielding] = number
        work.peak[yielding] = asperities.peak[number]
        # the indentation at which eq. 3 gives the limit, R and A unchanged
        work.goal[yielding] = level - indentation * (ceiling / force) ** (2.0 / 3.0)
        work.margin[yielding] = rule.tolerance * indentation / 3.0
        # no wider than the contact itself (flattened tops have no curvature), no narrower than the
        # floor
        roughness_width = np.sqrt(rule.width * radius)
        contact_width = np.sqrt(area / np.pi)
        work.width[yielding] = max(rule.floor, min(roughness_width, contact_width))
        yielding += 1
    return yielding


@njit(cache=True)
def _sites_to_raise(heights, asperities, number, goal, margin, work):
    """List the sites of an asperity that lie below a height, the lowest first; returns how many.

    Depths are compared in whole margins, and among equals the site's number decides: rounding does
    not.
    """
    first = asperities.first[number]
    count = asperities.sites[number]
    if count == 1:
        work.low[0] = asperities.arena[first]
        return 1
    low = 0
    for place in range(first, first + count):
        if heights[asperities.arena[place]] < goal:
            work.low[low] = asperities.arena[place]
            low += 1
    if low > 1:
        sites = np.sort(work.low[:low])
        values = np.empty(low)
        for k in range(low):
            values[k] = -np.floor((goal - heights[sites[k]]) / margin)
        rank = np.argsort(values, kind="mergesort")  # keeps the order of the sites among equals
        for k in range(low):
            work.low[k] = sites[rank[k]]
    return low


@njit(cache=True)
def settle(heights, n, spacing, level, asperities, mechanics, rule, changes, work):
    """Let all yielding asperities flow, sweep after sweep, until none is above its hardness.

    Fixed increments: one at each peak. Return mapping: one asperity after the other, by the number
    of their lowest sites, each has all its sites raised to its goal, the lowest first. Only
    asperities that flowed or whose sites or neighbours moved are looked at again.

    Returns the sweeps done and whether no asperity is left above its hardness.
    """
    actives = np.int64(0)
    for number in range(asperities.used[0]):
        if asperities.sites[number] > 0:
            work.active[actives] = number
            actives += 1
    for sweeps in range(rule.max_sweeps + 1):
        yielding = _find_yielding(heights, level, asperities, mechanics, rule, work, actives)
        if yielding == 0:
            return sweeps, True
        if sweeps == rule.max_sweeps:
            return sweeps, False
        flows = 0
        for k in np.argsort(work.peak[:yielding]):
            goal = work.goal[k]
            margin = work.margin[k]
            low = 1
            work.low[0] = work.peak[k]
            if not rule.fixed:
                low = _sites_to_raise(
                    heights, asperities, work.yielding[k], goal - margin, margin, work
                )
            for m in range(low):
                site = work.low[m]
                rise = rule.increment
                if not rule.fixed:
                    rise = goal - heights[site]
                if rise > margin:
                    work.site[flows] = site
                    work.half[flows] = _add_flow(
                        heights,
                        n,
                        spacing,
                        site,
                        rise,
                        work.width[k],
                        rule,
                        changes,
                        work.narrow,
                        work.wide,
                    )
                    flows += 1
        waiting = np.int64(0)  # else the callee is compiled for the number 0, too
        for k in range(flows):
            # one ring more than the flow: a site's curvature sees its neighbours
            reach = min(work.half[k] + 1, (n - 1) // 2)
            waiting = _release(
                heights, n, level, work.site[k], reach, asperities, work.seeds, waiting
            )
        if asperities.used[1] > 2 * heights.size or asperities.used[0] > heights.size:
            compact(asperities)
        actives = np.int64(0)
        for k in range(waiting):
            if asperities.label[work.seeds[k]] == -1:
                work.active[actives] = grow(asperities, heights, n, level, spacing, work.seeds[k])
                actives += 1
    return rule.max_sweeps, False
