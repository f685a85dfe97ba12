"""Steps of the search for one load, by lists of sites: compiled for the processor.

`whole_grid` has the same functions for arrays of other libraries. Pressures (GPa) and gaps (nm) of
all sites, shape (nx * ny,), are in double precision; misfits of the gaps, changes of the pressures
and displacements by these in single precision. Misfits and changes are changed in place.
"""

import numpy as np
from numba import njit


@njit(cache=True)
def mean_gap(pressure, gap):
    """Mean gap of the sites under pressure."""
    total = 0.0
    count = 0
    for k in range(gap.size):
        if pressure[k] > 0.0:
            total += gap[k]
            count += 1
    return total / count


@njit(cache=True)
def classify(pressure, gap, separation, stiffness, hardness, share):
    """Sites that touch and do not yield, by pressure and a share of the gap together.

    A site does not yield before its pressure as an elastic one is beyond the hardness: by its gap
    alone it may yield and part in turns.

    Returns
    -------
    These sites, the largest residual and pressure (GPa), the sum of the pressures that stay, and
    how many sites came or went.
    """
    sites = np.empty(gap.size, np.int32)
    count = 0
    worst = 0.0
    largest = 0.0
    carried = 0.0
    moved = 0
    for k in range(gap.size):
        site_pressure = pressure[k]
        lacking = -stiffness * (gap[k] + separation)
        new_pressure = min(max(site_pressure + lacking, 0.0), hardness)
        worst = max(worst, abs(site_pressure - new_pressure))
        largest = max(largest, site_pressure)
        expected = site_pressure + share * lacking
        touches = expected > 0.0
        yielding = site_pressure >= hardness and expected >= hardness
        came = touches != (site_pressure != 0.0)
        moved += came or site_pressure > hardness or (site_pressure == hardness and not yielding)
        if touches and not yielding:
            sites[count] = k
            count += 1
            carried += max(site_pressure, 0.0)
    return sites[:count].copy(), worst, largest, carried, moved


@njit(cache=True)
def bind(pressure, gap, separation, stiffness, hardness, share, factor, change):
    """Take the pressures off all sites that do not touch, and give the hardness to those that
    yield; the largest change.
    """
    largest = 0.0
    for k in range(gap.size):
        site_pressure = pressure[k]
        expected = site_pressure - share * stiffness * (gap[k] + separation)
        new = 0.0
        if min(site_pressure, expected) >= hardness:
            new = hardness
        elif expected > 0.0:
            new = min(factor * max(site_pressure, 0.0), hardness)
        change[k] = new - site_pressure
        largest = max(largest, abs(new - site_pressure))
        pressure[k] = new
    return largest


@njit(cache=True)
def mean_of(sites, gap):
    """Mean gap of some sites."""
    total = 0.0
    for site in sites:
        total += gap[site]
    return total / sites.size


@njit(cache=True)
def take_misfit(sites, gap, closed, misfit):
    """What gaps of sites lack to be closed, over the largest; returns this (nm)."""
    largest = 0.0
    for site in sites:
        largest = max(largest, abs(gap[site] - closed))
    if largest > 0.0:
        for site in sites:
            misfit[site] = (closed - gap[site]) / largest
    return largest


@njit(cache=True)
def join(sites, length, closing, change, pressure):
    """Add a step to a change of the pressures, and to these."""
    for k in range(sites.size):
        step = length * closing[k]
        change[sites[k]] += step
        pressure[sites[k]] += step


@njit(cache=True)
def gain(sites, misfit, closing):
    """Work of pressures that close gaps by these."""
    total = 0.0
    for k in range(sites.size):
        total += misfit[sites[k]] * closing[k]
    return total


@njit(cache=True)
def turn(sites, closing, factor, change):
    """Next direction of the pressures."""
    share = np.float32(factor)
    for k in range(sites.size):
        change[sites[k]] = share * change[sites[k]] + closing[k]


@njit(cache=True)
def product(sites, change, moved):
    """Work of a change of pressures by its displacements."""
    total = 0.0
    for site in sites:
        total += change[site] * moved[site]
    return total


@njit(cache=True)
def size(sites, change):
    """Sum of the sizes of the changes of some sites."""
    total = 0.0
    for site in sites:
        total += abs(change[site])
    return total


@njit(cache=True)
def advance(sites, step, unit, change, moved, misfit, pressure):
    """Go a step along a change of pressures; the range of the misfits that are left."""
    highest = -np.inf
    lowest = np.inf
    for site in sites:
        pressure[site] += unit * step * change[site]
        misfit[site] -= np.float32(step) * moved[site]
        highest = max(highest, misfit[site])
        lowest = min(lowest, misfit[site])
    return lowest, highest


@njit(cache=True)
def add(step, moved, gap):
    """Add a step of displacements to all gaps."""
    for k in range(gap.size):
        gap[k] += step * moved[k]


def bounded(pressure, gap, separation, hardness):
    """Pressures within their bounds, and the gaps between them and the flat, in place."""
    np.clip(pressure, 0.0, hardness, out=pressure)
    gap += separation
    np.maximum(gap, 0.0, out=gap)
    gap[pressure > 0.0] = 0.0
