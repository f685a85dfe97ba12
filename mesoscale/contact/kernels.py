"""Compiled loops: which sites touch and belong together, asperities' forces, plastic flow (section 2.2).

A site touches where h < level, with level = -separation. Connected touching sites (periodic, 4 or 8
neighbours) form an asperity. The set is kept up to date locally: sites that come into contact start
a flood fill that takes over every asperity it meets, and nothing else is looked at.

All loops that call each other are in this one file, because numba's cache on disk does not notice
changes in functions that come from another one.
"""

import numpy as np
from numba import njit

REACH = 3.0  # a flow ends 3 s2 away from the peak, at 1 % of the second Gaussian's amplitude


@njit(cache=True)
def site_curvature(heights, n, site, spacing):
    """Mean of the two profile curvatures at a site, 1/nm; positive at a minimum (eq. 2 as corrected)."""
    row = site // n
    col = site - row * n
    north = heights[site - n if row > 0 else site + n * (n - 1)]
    south = heights[site + n if row < n - 1 else site - n * (n - 1)]
    west = heights[site - 1 if col > 0 else site + n - 1]
    east = heights[site + 1 if col < n - 1 else site - n + 1]
    twice = 2.0 * heights[site]
    slope_x = (east - west) / (2.0 * spacing)
    slope_y = (south - north) / (2.0 * spacing)
    fx = 1.0 + slope_x * slope_x
    fy = 1.0 + slope_y * slope_y
    kx = (east + west - twice) / (fx * np.sqrt(fx))
    ky = (south + north - twice) / (fy * np.sqrt(fy))
    return 0.5 * (kx + ky) / (spacing * spacing)


@njit(cache=True)
def grow(asperities, heights, n, level, spacing, eight, seed):
    """Make the asperity that contains the touching site ``seed``; returns its number."""
    label, arena = asperities.label, asperities.arena
    number = asperities.used[0]
    start = asperities.used[1]
    end = start
    arena[end] = seed
    label[seed] = number + 1
    end += 1
    here = start
    peak = seed
    lowest = heights[seed]
    curvature = 0.0
    while here < end:
        site = arena[here]
        here += 1
        height = heights[site]
        if height < lowest or (height == lowest and site < peak):
            lowest = height
            peak = site
        curvature += site_curvature(heights, n, site, spacing)
        row = site // n
        col = site - row * n
        for dr in range(-1, 2):
            r = row + dr
            if r < 0:
                r += n
            elif r >= n:
                r -= n
            for dc in range(-1, 2):
                if (dr == 0 and dc == 0) or (not eight and dr != 0 and dc != 0):
                    continue
                c = col + dc
                if c < 0:
                    c += n
                elif c >= n:
                    c -= n
                other = r * n + c
                if heights[other] < level and label[other] != number + 1:
                    owner = label[other]
                    if owner > 0:
                        kill(asperities, owner - 1)
                    label[other] = number + 1
                    arena[end] = other
                    end += 1
    asperities.first[number] = start
    asperities.sites[number] = end - start
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
def touch(asperities, heights, n, level, spacing, eight, order, start, stop, changed, changed_sites, changed_count):
    """Bring all sites below ``level`` into contact.

    Looks at ``order[start:stop]``, the sites whose original height lies between the last level and
    this one, and at the sites that plastic flow has moved.
    """
    if asperities.used[1] > heights.size or asperities.used[0] > heights.size // 2:
        compact(asperities)
    for place in range(start, stop):
        site = order[place]
        if changed[site] == 0 and asperities.label[site] == 0:
            grow(asperities, heights, n, level, spacing, eight, site)
    for place in range(changed_count):
        site = changed_sites[place]
        if heights[site] < level and asperities.label[site] == 0:
            grow(asperities, heights, n, level, spacing, eight, site)


@njit(cache=True)
def shape(asperities, number, level, mechanics):
    """Indentation, radius, area (nm, nm, nm^2) and whether the bound on R acts, of one asperity.

    The radius is bounded so that no asperity is stiffer than a rigid flat punch of its own area,
    R <= 9 A / (4 pi delta): sites of mean curvature <= 0 (flattened tops) have no radius of their own.
    """
    count = asperities.sites[number]
    area = count * mechanics.site_area
    indentation = level - asperities.lowest[number]
    bound = 9.0 * area / (4.0 * np.pi * indentation)
    bounded = False
    if mechanics.curvature_radius:
        curvature = asperities.curvature[number] / count
        if curvature * bound > 1.0:
            radius = 1.0 / curvature
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
    """H(A) = H_macro + H' A^-1/4, GPa (eq. 4)."""
    return mechanics.h_macro + mechanics.h_prime / np.sqrt(np.sqrt(area))


@njit(cache=True)
def total_force(asperities, level, mechanics, capped):
    """Repulsive force; ``capped``: at most H A each (eq. 4).

    Returns the force (nN), sites, asperities, bounds on R in use, and the largest F / (H A) before the cap.
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
        load = max(load, single / ceiling if ceiling > 0.0 else np.inf)
        if capped:
            single = min(single, ceiling)
        force += single
        sites += asperities.sites[number]
        alive += 1
        bounds += bounded
    return force, sites, alive, bounds, load


@njit(cache=True)
def undo(heights, changes):
    """Take back the flow of this step."""
    for k in range(changes.used[1]):
        heights[changes.journal[k]] = changes.before[k]
    changes.used[1] = 0


@njit(cache=True)
def _gaussian(width, half, spacing):
    """Values at -half .. half sites, and their sum."""
    values = np.empty(2 * half + 1)
    total = 0.0
    for k in range(2 * half + 1):
        x = (k - half) * spacing / width
        values[k] = np.exp(-0.5 * x * x)
        total += values[k]
    return values, total


@njit(cache=True)
def _add_flow(heights, n, spacing, peak, amplitude, narrow, ratio, at_peak, changes):
    """Add amplitude * (G1 - c G2) around a peak, with c such that the sum over the grid is zero.

    ``at_peak``: scale so that the peak moves by exactly the amplitude. Returns the patch's half-width.
    """
    wide = ratio * narrow
    half = min(int(np.ceil(REACH * wide / spacing)), (n - 1) // 2)
    g1, sum1 = _gaussian(narrow, half, spacing)
    g2, sum2 = _gaussian(wide, half, spacing)
    balance = (sum1 / sum2) ** 2
    if at_peak:
        amplitude /= 1.0 - balance
    width = 2 * half + 1
    step = changes.used[2]
    recorded = changes.used[1]
    known = changes.used[0]
    top = peak // n - half + n
    left = (peak % n - half + n) % n
    before_edge = min(width, n - left)
    for k in range(width):
        start = ((top + k) % n) * n
        f1 = amplitude * g1[k]
        f2 = amplitude * balance * g2[k]
        for part in range(2):  # columns up to the cell's edge, then those wrapped around it
            first, last = (0, before_edge) if part == 0 else (before_edge, width)
            origin = start + left if part == 0 else start - before_edge
            for m in range(first, last):
                site = origin + m
                if changes.stamp[site] != step:
                    changes.stamp[site] = step
                    changes.journal[recorded] = site
                    changes.before[recorded] = heights[site]
                    recorded += 1
                    if changes.changed[site] == 0:
                        changes.changed[site] = 1
                        changes.sites[known] = site
                        changes.original[known] = heights[site]
                        known += 1
            for m in range(first, last):
                heights[origin + m] += f1 * g1[m] - f2 * g2[m]
    changes.used[1] = recorded
    changes.used[0] = known
    return half


@njit(cache=True)
def _release(heights, n, level, peak, reach, asperities, seeds, waiting):
    """Break up the asperities within ``reach`` of a peak; their touching sites wait to be joined again.

    A waiting site has label -1. Returns the number of waiting sites.
    """
    label = asperities.label
    width = 2 * reach + 1
    top = peak // n - reach + n
    left = (peak % n - reach + n) % n
    before_edge = min(width, n - left)
    for k in range(width):
        start = ((top + k) % n) * n
        for m in range(width):
            site = start + left + m if m < before_edge else start + m - before_edge
            owner = label[site]
            if owner > 0:
                first = asperities.first[owner - 1]
                last = first + asperities.sites[owner - 1]
                asperities.sites[owner - 1] = 0
                for place in range(first, last):
                    member = asperities.arena[place]
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
def settle(heights, n, spacing, level, asperities, mechanics, rule, changes, work):
    """Let all yielding asperities flow, all at once, sweep after sweep, until none is above its hardness.

    Only asperities that flowed or whose sites or neighbours moved are looked at again.

    Returns the sweeps done and whether no asperity is left above its hardness.
    """
    actives = 0
    for number in range(asperities.used[0]):
        if asperities.sites[number] > 0:
            work.active[actives] = number
            actives += 1
    for sweeps in range(rule.max_sweeps + 1):
        flows = 0
        for k in range(actives):
            number = work.active[k]
            if asperities.sites[number] == 0:
                continue
            indentation, radius, area, _ = shape(asperities, number, level, mechanics)
            force = mechanics.stiffness * np.sqrt(radius * indentation) * indentation
            ceiling = hardness(area, mechanics) * area
            if rule.fixed:
                if force <= ceiling:
                    continue
                amplitude = rule.increment
            else:
                if force <= ceiling * (1.0 + rule.tolerance):
                    continue
                amplitude = indentation * (1.0 - (ceiling / force) ** (2.0 / 3.0))
            # no wider than the contact itself (flattened tops have no curvature), no narrower than the floor
            width = max(rule.floor, min(np.sqrt(rule.width * radius), np.sqrt(area / np.pi)))
            work.peak[flows] = asperities.peak[number]
            work.amplitude[flows] = amplitude
            work.width[flows] = width
            flows += 1
        if flows == 0:
            return sweeps, True
        if sweeps == rule.max_sweeps:
            return sweeps, False
        if asperities.used[1] > 2 * heights.size or asperities.used[0] > heights.size:
            compact(asperities)
        for k in range(flows):
            work.half[k] = _add_flow(
                heights,
                n,
                spacing,
                work.peak[k],
                work.amplitude[k],
                work.width[k],
                rule.ratio,
                not rule.fixed,
                changes,
            )
        waiting = 0
        for k in range(flows):
            # one ring more than the flow: a site's curvature sees its neighbours
            reach = min(work.half[k] + 1, (n - 1) // 2)
            waiting = _release(heights, n, level, work.peak[k], reach, asperities, work.seeds, waiting)
        actives = 0
        for k in range(waiting):
            if asperities.label[work.seeds[k]] == -1:
                work.active[actives] = grow(asperities, heights, n, level, spacing, mechanics.eight, work.seeds[k])
                actives += 1
    return rule.max_sweeps, False
