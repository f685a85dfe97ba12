"""Asperities in contact: which sites belong together, their shape and their force (section 2.2).

A site touches where h < level, with level = -separation. Connected touching sites (periodic, 4 or 8
neighbours) form an asperity. The set is kept up to date locally: sites that come into contact start
a flood fill that takes over every asperity it meets, and nothing else is looked at.
"""

from typing import NamedTuple

import numpy as np
from numba import njit


class Asperities(NamedTuple):
    """Asperities of one surface; a dead (merged) one has ``count`` 0. Sizes: N^2 sites."""

    label: np.ndarray  # (N^2,) int32: asperity number + 1 of each site, 0 where there is no contact
    arena: np.ndarray  # (3 N^2,) int32: sites, those of one asperity in a row
    first: np.ndarray  # (2 N^2,) int32: where an asperity's sites start in the arena
    count: np.ndarray  # (2 N^2,) int32: number of sites
    peak: np.ndarray  # (2 N^2,) int32: lowest site (the smaller number among equals)
    lowest: np.ndarray  # (2 N^2,) float64: its height, nm
    curvature: np.ndarray  # (2 N^2,) float64: sum of the sites' mean curvature, 1/nm
    used: np.ndarray  # (2,) int64: asperity numbers and arena places in use


class Mechanics(NamedTuple):
    """Constants of eqs 2-4."""

    stiffness: float  # p E*, GPa
    h_macro: float  # GPa
    h_prime: float  # GPa nm^0.5
    site_area: float  # nm^2
    curvature_radius: bool  # else truncation
    area_of_sites: bool  # else Hertz's
    eight: bool  # 8 neighbours, else 4


def no_asperities(sites: int) -> Asperities:
    """Empty set for a surface of N^2 sites; the memory is touched only as contact grows."""
    return Asperities(
        np.zeros(sites, np.int32),
        np.empty(3 * sites, np.int32),
        np.empty(2 * sites, np.int32),
        np.empty(2 * sites, np.int32),
        np.empty(2 * sites, np.int32),
        np.empty(2 * sites),
        np.empty(2 * sites),
        np.zeros(2, np.int64),
    )


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
    asperities.count[number] = end - start
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
    for place in range(first, first + asperities.count[number]):
        asperities.label[asperities.arena[place]] = 0
    asperities.count[number] = 0


@njit(cache=True)
def compact(asperities):
    """Close the gaps that dead asperities left; the living keep their order."""
    label, arena, used = asperities.label, asperities.arena, asperities.used
    number = 0
    end = 0
    for old in range(used[0]):
        count = asperities.count[old]
        if count == 0:
            continue
        first = asperities.first[old]
        for k in range(count):
            arena[end + k] = arena[first + k]
            label[arena[end + k]] = number + 1
        asperities.first[number] = end
        asperities.count[number] = count
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
        if asperities.count[number] > 0:
            kill(asperities, number)
    asperities.used[:] = 0


@njit(cache=True)
def touch(
    asperities, heights, n, level, spacing, eight, order, start, stop, changed, changed_sites, changed_count
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
    count = asperities.count[number]
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
    """Repulsive force (nN), sites, asperities, bounds on R in use; ``capped``: at most H A each (eq. 4)."""
    force = 0.0
    sites = 0
    alive = 0
    bounds = 0
    for number in range(asperities.used[0]):
        if asperities.count[number] == 0:
            continue
        indentation, radius, area, bounded = shape(asperities, number, level, mechanics)
        single = mechanics.stiffness * np.sqrt(radius * indentation) * indentation
        if capped:
            single = min(single, hardness(area, mechanics) * area)
        force += single
        sites += asperities.count[number]
        alive += 1
        bounds += bounded
    return force, sites, alive, bounds
