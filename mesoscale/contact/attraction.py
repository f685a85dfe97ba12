"""Van der Waals attraction of a rough surface and a plane (section 2.1, eq. 1).

Sum over the sites of 1/g^3, with the gap g = h + separation cut off at D0. Sites far from contact are
summed through a histogram of their heights that keeps the first five moments of each bin; sites near
contact, and all sites that plastic flow has moved, are summed one by one.
"""

import numpy as np
from numba import njit

MOMENTS = 5
NEAR_BINS = 100  # a site is near while its gap is below this many bin widths


@njit(cache=True)
def bin_heights(heights, lowest, width, moments):
    """Add every site to the moments of its bin: sums of t^0..t^4, t = h - bin centre."""
    last = moments.shape[0] - 1
    for site in range(heights.size):
        x = (heights[site] - lowest) / width
        b = max(0, min(int(x), last))
        t = (x - b - 0.5) * width
        moments[b, 0] += 1.0
        moments[b, 1] += t
        moments[b, 2] += t * t
        moments[b, 3] += t * t * t
        moments[b, 4] += t * t * t * t


@njit(cache=True)
def take_out(originals, start, stop, lowest, width, moments):
    """Remove sites (given by their original heights) from the moments."""
    last = moments.shape[0] - 1
    for k in range(start, stop):
        x = (originals[k] - lowest) / width
        b = max(0, min(int(x), last))
        t = (x - b - 0.5) * width
        moments[b, 0] -= 1.0
        moments[b, 1] -= t
        moments[b, 2] -= t * t
        moments[b, 3] -= t * t * t
        moments[b, 4] -= t * t * t * t


@njit(cache=True)
def first_far_bin(gap, separation, lowest, width, bins):
    """First of the bins all of whose sites are at least a gap away."""
    return min(max(int(np.floor((gap - separation - lowest) / width)) + 1, 0), bins)


@njit(cache=True)
def far_inverse_cubes(separation, far, lowest, width, moments):
    """Sum over the sites of 1/g^3 in the bins from `far` on: (g + t)^-3 expanded in t / g."""
    rest = 0.0
    for b in range(far, moments.shape[0]):
        u = 1.0 / (lowest + (b + 0.5) * width + separation)
        rest += u**3 * (
            moments[b, 0]
            + u
            * (
                -3.0 * moments[b, 1]
                + u * (6.0 * moments[b, 2] + u * (-10.0 * moments[b, 3] + u * 15.0 * moments[b, 4]))
            )
        )
    return rest


@njit(cache=True)
def inverse_cubes(
    heights,
    separation,
    cutoff,
    touching,
    order,
    order_heights,
    changed,
    changed_sites,
    changed_count,
    lowest,
    width,
    moments,
):
    """Sum over the sites of 1/max(g, cutoff)^3; ``touching``: whether sites with g < 0 count.

    ``order`` holds at least all sites of the near bins, by rising original height.
    """
    bins = moments.shape[0]
    far = first_far_bin(max(NEAR_BINS * width, 2.0 * cutoff), separation, lowest, width, bins)
    near = 0.0
    for place in range(order.size):
        if min(int((order_heights[place] - lowest) / width), bins - 1) >= far:
            break
        if changed[order[place]] == 0:
            gap = order_heights[place] + separation
            if gap >= 0.0 or touching:
                gap = max(gap, cutoff)
                near += 1.0 / (gap * gap * gap)
    moved = 0.0
    for place in range(changed_count):
        gap = heights[changed_sites[place]] + separation
        if gap >= 0.0 or touching:
            gap = max(gap, cutoff)
            moved += 1.0 / (gap * gap * gap)
    return near + moved + far_inverse_cubes(separation, far, lowest, width, moments)
