"""Compiled loops over the sites in contact: which belong together, what yields, what moves."""

import numpy as np
from numba import njit

from mesoscale.contact.coupled.dense import wrapped


@njit(cache=True)
def label(sites, place, pressure, pixels, cluster):
    """Number the clusters of connected sites under pressure, from 0; -1 for the sites apart.

    `place` holds the position of each site of the cell in `sites`, or -1. Returns how many clusters
    there are.
    """
    clusters = 0
    cluster[:] = -1
    waiting = np.empty(sites.size, np.int32)
    for start in range(sites.size):
        if cluster[start] >= 0 or not pressure[start] > 0.0:
            continue
        cluster[start] = clusters
        waiting[0] = start
        end = 1
        while end > 0:
            end -= 1
            site = sites[waiting[end]]
            row = site // pixels
            col = site % pixels
            for rows in range(-1, 2):
                for cols in range(-1, 2):
                    other = place[
                        wrapped(row + rows, pixels) * pixels + wrapped(col + cols, pixels)
                    ]
                    if other >= 0 and cluster[other] < 0 and pressure[other] > 0.0:
                        cluster[other] = clusters
                        waiting[end] = other
                        end += 1
        clusters += 1
    return clusters


@njit(cache=True)
def displace(table, scale, pixels, sites, pressure, targets, displacement):
    """Add to the displacements (nm) of other sites what pressures (GPa) of some make."""
    rows = np.empty(sites.size, np.int64)
    cols = np.empty(sites.size, np.int64)
    value = np.empty(sites.size)
    count = 0
    for k in range(sites.size):
        if pressure[k] != 0.0:
            rows[count] = sites[k] // pixels
            cols[count] = sites[k] % pixels
            value[count] = scale * pressure[k]
            count += 1
    for m in range(targets.size):
        row = targets[m] // pixels
        col = targets[m] % pixels
        total = 0.0
        for k in range(count):
            dr = abs(row - rows[k])
            dc = abs(col - cols[k])
            total += (
                value[k] * table[np.uint64(min(dr, pixels - dr)), np.uint64(min(dc, pixels - dc))]
            )
        displacement[m] += total


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
def flatten(heights, sites, separation, displacement, pressure, limit, changes):
    """Lower the sites at their hardness by their overlap (contact is at the minima, so their
    heights rise).

    What flows is left out of the surface. Up to E* tan(slope)/Y of some 30 the half-space around an
    indentation takes its volume up by expanding elastically (K. L. Johnson, Contact Mechanics,
    1985, section 6.3).
    """
    for k in range(sites.size):
        site = sites[k]
        gap = heights[site] + separation + displacement[k]
        if not (gap < 0.0 and 0.0 < limit[k] <= pressure[k]):
            continue
        _record(heights, site, changes)
        heights[site] -= gap
