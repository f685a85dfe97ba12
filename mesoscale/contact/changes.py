"""What flow has done to a surface, and how a step of it is undone."""

from typing import NamedTuple

import numpy as np
from numba import njit


class Changes(NamedTuple):
    """What flow has done to a surface of N^2 sites, and what undoes the step under way.

    Attributes
    ----------
    changed : (N^2,) uint8: 1 where the height is no longer the original.
    sites : (N^2,) int32: the changed sites.
    original : (N^2,) float64: their heights before the first change, nm.
    journal : (N^2,) int32: sites changed in this step.
    before : (N^2,) float64: their heights before it.
    stamp : (N^2,) int32: last step in which a site changed.
    used : (4,) int64: changed sites, journal entries, number of this step, changed sites before it.
    """

    changed: np.ndarray
    sites: np.ndarray
    original: np.ndarray
    journal: np.ndarray
    before: np.ndarray
    stamp: np.ndarray
    used: np.ndarray


def no_changes(sites: int) -> Changes:
    """An untouched surface; the memory is touched only as flow spreads."""
    changed = np.zeros(sites, np.uint8)
    site = np.empty(sites, np.int32)
    original = np.empty(sites)
    journal = np.empty(sites, np.int32)
    before = np.empty(sites)
    stamp = np.zeros(sites, np.int32)
    used = np.zeros(4, np.int64)
    return Changes(changed, site, original, journal, before, stamp, used)


@njit(cache=True)
def undo(heights, changes):
    """Take back the flow of this step."""
    for k in range(changes.used[1]):
        heights[changes.journal[k]] = changes.before[k]
    for k in range(changes.used[3], changes.used[0]):
        changes.changed[changes.sites[k]] = 0
    changes.used[0] = changes.used[3]
    changes.used[1] = 0
