"""Plastic flow of asperities: the surface changes until none is above its hardness (section 2.2)."""

from typing import NamedTuple

import numpy as np
from numba import njit

from mesoscale.contact.asperities import compact, grow, hardness, shape

REACH = 3.0  # the flow ends 3 s2 away from the peak, at 1 % of the second Gaussian's amplitude


class FlowRule(NamedTuple):
    """Shape and size of one flow, see ContactSettings."""

    fixed: bool  # fixed increment, else return mapping
    increment: float  # nm
    width: float  # nm: s1 = sqrt(width * R)
    floor: float  # nm: smallest s1
    ratio: float  # s2 / s1
    tolerance: float
    max_sweeps: int


class Changes(NamedTuple):
    """What flow has done to a surface of N^2 sites, and what undoes the step under way."""

    changed: np.ndarray  # (N^2,) uint8: 1 where the height is no longer the original
    sites: np.ndarray  # (N^2,) int32: the changed sites
    original: np.ndarray  # (N^2,) float64: their heights before the first change, nm
    journal: np.ndarray  # (N^2,) int32: sites changed in this step
    before: np.ndarray  # (N^2,) float64: their heights before it
    stamp: np.ndarray  # (N^2,) int32: last step in which a site changed
    used: np.ndarray  # (3,) int64: changed sites, journal entries, number of this step


def no_changes(sites: int) -> Changes:
    """An untouched surface; the memory is touched only as flow spreads."""
    return Changes(
        np.zeros(sites, np.uint8),
        np.empty(sites, np.int32),
        np.empty(sites),
        np.empty(sites, np.int32),
        np.empty(sites),
        np.zeros(sites, np.int32),
        np.zeros(3, np.int64),
    )


class Workspace(NamedTuple):
    """Lists that a sweep fills anew; preallocated because growing arrays are slow in compiled loops."""

    active: np.ndarray  # int32: asperities to look at
    peak: np.ndarray  # int32: where the flows of this sweep are
    amplitude: np.ndarray  # float64: nm
    width: np.ndarray  # float64: s1, nm
    half: np.ndarray  # int32: half-width of the patch in sites
    seeds: np.ndarray  # int32: sites waiting to be joined to asperities


def workspace(sites: int) -> Workspace:
    """Room for the worst case; the memory is touched only as needed."""
    return Workspace(
        np.empty(2 * sites, np.int32),
        np.empty(sites, np.int32),
        np.empty(sites),
        np.empty(sites),
        np.empty(sites, np.int32),
        np.empty(sites, np.int32),
    )


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
                last = first + asperities.count[owner - 1]
                asperities.count[owner - 1] = 0
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
        if asperities.count[number] > 0:
            work.active[actives] = number
            actives += 1
    for sweeps in range(rule.max_sweeps + 1):
        flows = 0
        for k in range(actives):
            number = work.active[k]
            if asperities.count[number] == 0:
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
                work.active[actives] = grow(
                    asperities, heights, n, level, spacing, mechanics.eight, work.seeds[k]
                )
                actives += 1
    return rule.max_sweeps, False
