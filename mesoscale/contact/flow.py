"""Plastic flow of asperities: the surface changes until none is above its hardness (section 2.2)."""

from typing import NamedTuple

import numpy as np
from numba import njit

from mesoscale.contact.asperities import compact, grow, hardness, kill, shape

REACH = 4.0  # the flow ends 4 s2 away from the peak: exp(-8) of the second Gaussian's amplitude


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


@njit(cache=True)
def undo(heights, changes):
    """Take back the flow of this step."""
    for k in range(changes.used[1]):
        heights[changes.journal[k]] = changes.before[k]
    changes.used[1] = 0


@njit(cache=True)
def _appended(buffer, used, value):
    """Append to a growing buffer; returns it (a new one if it was full)."""
    if used == buffer.size:
        larger = np.empty(2 * buffer.size, buffer.dtype)
        larger[:used] = buffer
        buffer = larger
    buffer[used] = value
    return buffer


@njit(cache=True)
def _half_gaussian(width, half, spacing):
    values = np.empty(half + 1)
    for k in range(half + 1):
        x = k * spacing / width
        values[k] = np.exp(-0.5 * x * x)
    return values


@njit(cache=True)
def _add_flow(heights, n, spacing, peak, amplitude, narrow, ratio, at_peak, changes):
    """Add amplitude * (G1 - c G2) around a peak, with c such that the sum over the grid is zero.

    ``at_peak``: scale so that the peak moves by exactly the amplitude. Returns the patch's half-width.
    """
    wide = ratio * narrow
    half = min(int(np.ceil(REACH * wide / spacing)), (n - 1) // 2)
    g1 = _half_gaussian(narrow, half, spacing)
    g2 = _half_gaussian(wide, half, spacing)
    sum1 = 2.0 * g1[1:].sum() + 1.0
    sum2 = 2.0 * g2[1:].sum() + 1.0
    balance = (sum1 / sum2) ** 2
    if at_peak:
        amplitude /= 1.0 - balance
    row, col = peak // n, peak % n
    step = changes.used[2]
    for dr in range(-half, half + 1):
        r = row + dr
        if r < 0:
            r += n
        elif r >= n:
            r -= n
        f1 = amplitude * g1[abs(dr)]
        f2 = amplitude * balance * g2[abs(dr)]
        for dc in range(-half, half + 1):
            c = col + dc
            if c < 0:
                c += n
            elif c >= n:
                c -= n
            site = r * n + c
            if changes.stamp[site] != step:
                changes.stamp[site] = step
                changes.journal[changes.used[1]] = site
                changes.before[changes.used[1]] = heights[site]
                changes.used[1] += 1
                if changes.changed[site] == 0:
                    changes.changed[site] = 1
                    changes.sites[changes.used[0]] = site
                    changes.original[changes.used[0]] = heights[site]
                    changes.used[0] += 1
            heights[site] += f1 * g1[abs(dc)] - f2 * g2[abs(dc)]
    return half


@njit(cache=True)
def settle(heights, n, spacing, level, asperities, mechanics, rule, changes):
    """Let all yielding asperities flow, all at once, sweep after sweep, until none is above its hardness.

    Only asperities that flowed or whose sites or neighbours moved are looked at again.

    Returns the sweeps done and whether no asperity is left above its hardness.
    """
    active = np.empty(1024, np.int32)
    actives = 0
    for number in range(asperities.used[0]):
        if asperities.count[number] > 0:
            active = _appended(active, actives, number)
            actives += 1
    peaks = np.empty(256, np.int32)
    amplitudes = np.empty(256)
    widths = np.empty(256)
    halves = np.empty(256, np.int32)
    seeds = np.empty(1024, np.int32)
    sweeps = 0
    while True:
        flows = 0
        for k in range(actives):
            number = active[k]
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
            peaks = _appended(peaks, flows, asperities.peak[number])
            amplitudes = _appended(amplitudes, flows, amplitude)
            widths = _appended(widths, flows, width)
            flows += 1
        if flows == 0:
            return sweeps, True
        if sweeps == rule.max_sweeps:
            return sweeps, False
        sweeps += 1
        if asperities.used[1] > 2 * heights.size or asperities.used[0] > heights.size:
            compact(asperities)
        if halves.size < flows:
            halves = np.empty(peaks.size, np.int32)
        for k in range(flows):
            halves[k] = _add_flow(
                heights, n, spacing, peaks[k], amplitudes[k], widths[k], rule.ratio, not rule.fixed, changes
            )
        waiting = 0
        for k in range(flows):
            # one ring more than the flow: a site's curvature sees its neighbours
            reach = min(halves[k] + 1, (n - 1) // 2)
            row, col = peaks[k] // n, peaks[k] % n
            for dr in range(-reach, reach + 1):
                r = (row + dr) % n
                for dc in range(-reach, reach + 1):
                    site = r * n + (col + dc) % n
                    owner = asperities.label[site]
                    if owner > 0:
                        number = owner - 1
                        first = asperities.first[number]
                        for place in range(first, first + asperities.count[number]):
                            member = asperities.arena[place]
                            if heights[member] < level:
                                seeds = _appended(seeds, waiting, member)
                                waiting += 1
                        kill(asperities, number)
                    elif heights[site] < level:
                        seeds = _appended(seeds, waiting, site)
                        waiting += 1
        actives = 0
        for k in range(waiting):
            if asperities.label[seeds[k]] == 0:
                number = grow(asperities, heights, n, level, spacing, mechanics.eight, seeds[k])
                active = _appended(active, actives, number)
                actives += 1
