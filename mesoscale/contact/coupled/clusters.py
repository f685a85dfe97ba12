"""Compiled loops over the sites in contact: which belong together, what yields, what moves."""

import math

import numpy as np
from numba import njit

# Sites that touch cover more than the contact does, by this part of a site for each edge between a touching site and
# one that does not touch (Yastrebov, Anciaux and Molinari 2017, doi:10.1016/j.jmps.2017.07.016).
EXCESS = (math.pi - 1.0 + math.log(2.0)) / 24.0


@njit(cache=True)
def label(sites, place, pressure, pixels, eight, number):
    """Number the clusters of connected sites under pressure, from 0; -1 for the sites apart.

    `place` holds the position of each site of the cell in `sites`, or -1. Returns how many clusters there are.
    """
    clusters = 0
    number[:] = -1
    waiting = np.empty(sites.size, np.int32)
    for start in range(sites.size):
        if number[start] >= 0 or not pressure[start] > 0.0:
            continue
        number[start] = clusters
        waiting[0] = start
        end = 1
        while end > 0:
            end -= 1
            site = sites[waiting[end]]
            row, col = site // pixels, site % pixels
            for rows in range(-1, 2):
                for cols in range(-1, 2):
                    if not eight and rows != 0 and cols != 0:
                        continue
                    other = place[(row + rows) % pixels * pixels + (col + cols) % pixels]
                    if other >= 0 and number[other] < 0 and pressure[other] > 0.0:
                        number[other] = clusters
                        waiting[end] = other
                        end += 1
        clusters += 1
    return clusters


@njit(cache=True)
def displace(table, scale, pixels, sites, pressure, others, displacement):
    """Displacement (nm) of other sites by the pressures of some."""
    rows = np.empty(sites.size, np.int64)
    cols = np.empty(sites.size, np.int64)
    value = np.empty(sites.size)
    count = 0
    for k in range(sites.size):
        if pressure[k] > 0.0:
            rows[count], cols[count] = sites[k] // pixels, sites[k] % pixels
            value[count] = scale * pressure[k]
            count += 1
    for m in range(others.size):
        row, col = others[m] // pixels, others[m] % pixels
        total = 0.0
        for k in range(count):
            dr, dc = abs(row - rows[k]), abs(col - cols[k])
            total += value[k] * table[np.uint64(min(dr, pixels - dr)), np.uint64(min(dc, pixels - dc))]
        displacement[m] = total


@njit(cache=True)
def _record(heights, site, changes):
    """Note the height of a site before flow changes it, for `undo` and for `adopt_changes`."""
    step = np.int32(changes.used[2])
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


@njit(cache=True)
def flatten(heights, sites, separation, displacement, pressure, limit, changes, number, flowed):
    """Lower the sites at their hardness by their overlap (contact is at the minima, so their heights rise).

    Adds to `flowed` what each cluster lost, as a height of one site; `number`: the cluster of each site.
    """
    for k in range(sites.size):
        site = sites[k]
        gap = heights[site] + separation + displacement[k]
        if not (gap < 0.0 and 0.0 < limit[k] <= pressure[k]):
            continue
        _record(heights, site, changes)
        heights[site] -= gap
        flowed[number[k]] -= gap


@njit(cache=True)
def pile_up(heights, sites, place, number, flowed, separation, displacement, pressure, table, scale, eight, changes):
    """Lay down what each cluster lost on the rings of sites around it, the nearest first; True if all found room.

    A ring takes at most its gaps, so that the piles just touch the flat; the last one is filled to the same share of
    its gaps everywhere. Sites under pressure take nothing. One cluster comes after the other, by the number of their
    first site in the cell, and finds what those before it have laid down.
    """
    pixels = int(np.sqrt(heights.size))
    known = np.zeros(heights.size, np.bool_)
    reached = np.empty(heights.size, np.int32)
    order = np.argsort(number, kind="mergesort")
    first = np.searchsorted(number[order], np.arange(flowed.size + 1))
    first_site = np.full(flowed.size, heights.size)
    for k in range(sites.size):
        if number[k] >= 0:
            first_site[number[k]] = min(first_site[number[k]], sites[k])
    for cluster in np.argsort(first_site, kind="mergesort"):
        left = flowed[cluster]
        start, end = 0, 0
        for k in order[first[cluster] : first[cluster + 1]]:
            reached[end] = sites[k]
            known[sites[k]] = True
            end += 1
        while left > 0.0:
            last = end
            for site in reached[start:last]:
                row, col = site // pixels, site % pixels
                for rows in range(-1, 2):
                    for cols in range(-1, 2):
                        other = (row + rows) % pixels * pixels + (col + cols) % pixels
                        if not known[other] and (eight or rows == 0 or cols == 0):
                            known[other] = True
                            reached[end] = other
                            end += 1
            if end == last:
                return False
            start = last
            room = _gaps(
                heights, sites, place, separation, displacement, pressure, table, scale, pixels, reached[start:end]
            )
            total = room.sum()
            if total > 0.0:
                share = min(left / total, 1.0)
                for k in range(room.size):
                    if room[k] > 0.0:
                        _record(heights, reached[start + k], changes)
                        heights[reached[start + k]] -= share * room[k]
                left = left - total if share == 1.0 else 0.0
        for site in reached[:end]:
            known[site] = False
    return True


@njit(cache=True)
def _gaps(heights, sites, place, separation, displacement, pressure, table, scale, pixels, others):
    """Gaps (nm) of some sites, 0 of those under pressure."""
    unknown = others[place[others] < 0]
    moved = np.empty(unknown.size)
    displace(table, scale, pixels, sites, pressure, unknown, moved)
    gap = np.zeros(others.size)
    count = 0
    for k in range(others.size):
        here = place[others[k]]
        if here < 0:
            gap[k] = max(heights[others[k]] + separation + moved[count], 0.0)
            count += 1
        elif not pressure[here] > 0.0:
            gap[k] = max(heights[others[k]] + separation + displacement[here], 0.0)
    return gap


@njit(cache=True)
def attracting(sites, place, pressure, pixels, touching):
    """How many sites' areas attract with the gap of each of some sites.

    Without `touching` sites under pressure do not, but for the strip along their edges where there is no contact: it
    counts with the gap of the site beyond the edge. `place` and `pressure` as in `label`.
    """
    weight = np.ones(sites.size)
    if touching:
        return weight
    for k in range(sites.size):
        here = place[sites[k]]
        if here >= 0 and pressure[here] > 0.0:
            weight[k] = 0.0
            continue
        row, col = sites[k] // pixels, sites[k] % pixels
        for rows, cols in ((-1, 0), (1, 0), (0, -1), (0, 1)):
            other = place[(row + rows) % pixels * pixels + (col + cols) % pixels]
            if other >= 0 and pressure[other] > 0.0:
                weight[k] += EXCESS
    return weight
