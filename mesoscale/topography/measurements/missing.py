"""Numbers that stand for missing points, and what remains of a map without them.

Programs write a number where nothing was measured: -9999, 0, 1e30, or the ends of the integers of a
format. Such a number betrays itself twice. Many points have it where any other value occurs once,
and the surface jumps to it.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from mesoscale.errors import InputError

LONE = 5.0
"""Values are no heights that lie this many times the range of all others away from them."""
MOST_ALONE = 0.1  # share of points that may lie so far away: more are a surface of two levels
TIES, TIED_SHARE = 8, 2e-4
"""Fewest points, and fewest of all, whose common value is looked at."""
# times as many points as any value nearby: 8-bit heights have hundreds at each
MORE_THAN_NEAR = 10.0
MOST_TIED = 0.5
JUMP = 3.0
"""How the surface jumps to what stands for missing points, over nine tenths of its steps between
neighbours.
"""
SAMPLE = 1_000_000  # points of a large map in which common values are sought
MOST_VALUES = 6
FEW, LARGEST_NM = 3, 1e8
"""Fewer points with a larger height come from a damaged file."""


@dataclass(frozen=True)
class StandIn:
    """A number that stands for missing points.

    Attributes
    ----------
    value_nm : the number, or the middle of the numbers.
    count : of points that have it.
    exact : all of them have the same.
    """

    value_nm: float
    count: int
    exact: bool


def without_stand_ins(heights: np.ndarray) -> tuple[np.ndarray, list[StandIn]]:
    """Heights (n,) or (nx, ny) with NaN for stand-ins of missing points; these."""
    stand_ins: list[StandIn] = []
    while len(stand_ins) < MOST_VALUES:
        known = heights[np.isfinite(heights)]
        if len(known) < 2:
            break
        marked = _lonely(heights, known)
        if marked is not None and _is_damage(heights, marked):
            break
        if marked is None:
            marked = next(
                (mask for value in _common(known) if _jumps(heights, mask := heights == value)),
                None,
            )
        if marked is None:
            break
        values = heights[marked]
        exact = bool(np.ptp(values) == 0)
        stand_ins.append(StandIn(float(np.median(values)), len(values), exact))
        heights = np.where(marked, np.nan, heights)
    return heights, stand_ins


def _lonely(heights: np.ndarray, known: np.ndarray) -> np.ndarray | None:
    """Points beyond a gap in the values that is wide beside all others, or None."""
    largest = max(1, int(MOST_ALONE * len(known)))
    last = len(known) - largest - 1
    few = np.partition(known, (largest, last))
    lowest = np.sort(few[: largest + 1])
    wide = _wide_gaps(lowest, few[largest:].max() - lowest[1:])
    if len(wide):
        return heights <= lowest[wide[-1]]
    highest = np.sort(few[last:])
    wide = _wide_gaps(highest, highest[:-1] - few[: last + 1].min())
    if len(wide):
        return heights >= highest[wide[0] + 1]
    return None


def _wide_gaps(tail: np.ndarray, spread: np.ndarray) -> np.ndarray:
    """Places of gaps between sorted values that are wide beside the spread of all others."""
    gaps = np.diff(tail)
    return np.flatnonzero((gaps > LONE * spread) & (spread > 0))  # else a surface of two levels


def _is_damage(heights: np.ndarray, marked: np.ndarray) -> bool:
    """Is a lonely number too large for any height, and too rare to stand for anything?"""
    values = heights[marked]
    return len(values) < FEW and bool(np.abs(values).max() > LARGEST_NM)


def _common(known: np.ndarray) -> Iterator[float]:
    """Values that far more points have than any value nearby, the most common first."""
    sample = known
    if len(known) > SAMPLE:
        sample = known[:: -(-len(known) // SAMPLE)]
    values, counts = np.unique(sample, return_counts=True)
    fewest = max(TIES, TIED_SHARE * len(sample))
    for place in np.argsort(counts)[::-1][:MOST_VALUES]:
        if counts[place] < fewest:
            return
        below = counts[max(place - 10, 0) : place]
        near = np.r_[below, counts[place + 1 : place + 11]]
        if len(near) < 10:  # steps and gratings without noise
            continue
        if MORE_THAN_NEAR * near.max() < counts[place] < MOST_TIED * len(sample):
            yield float(values[place])


def _jumps(heights: np.ndarray, marked: np.ndarray) -> bool:
    """Does the surface jump at these points? A true plateau it meets as any other point."""
    steps = []
    met = []
    for axis in range(heights.ndim):
        step = np.abs(np.diff(heights, axis=axis))
        count = step.shape[axis]
        first = np.take(marked, range(count), axis)
        second = np.take(marked, range(1, count + 1), axis)
        steps.append(step[~first & ~second])
        met.append(step[first ^ second])
    usual = np.concatenate(steps)
    across = np.concatenate(met)
    usual = usual[np.isfinite(usual)]
    across = across[np.isfinite(across)]
    if not len(usual) or not len(across):
        return False
    return bool(np.median(across) > JUMP * np.quantile(usual, 0.9))


SMALL_HOLE = 1e-3
"""Share of a map up to which a hole is filled, and not cut off."""


def cropped(
    where: str, heights: np.ndarray, crop: str | tuple[int, int, int, int]
) -> tuple[np.ndarray, tuple[slice, slice]]:
    """A part of heights (nx, ny), and which.

    Parameters
    ----------
    asked : `largest`, the largest rectangle without missing points, small holes apart; or first and
        last place along x and along y.

    Raises
    ------
    InputError : a part that lies outside the map.
    """
    if isinstance(crop, str):
        window = _largest_rectangle(~_large_holes(heights))
    else:
        x1, x2, y1, y2 = crop
        nx, ny = heights.shape
        if not (x1 < x2 <= nx and y1 < y2 <= ny):
            raise InputError(
                f"{where}: cut to {x1}:{x2}, {y1}:{y2} of {nx} x {ny} pixels (--crop,"
                f" topography.instruments crop); accepted are 0:{nx}, 0:{ny} and what lies inside"
            )
        window = slice(x1, x2), slice(y1, y2)
    return heights[window], window


def _large_holes(heights: np.ndarray) -> np.ndarray:
    """(nx, ny) bool: missing points of holes that are too large to be filled."""
    from scipy.ndimage import label

    missing = ~np.isfinite(heights)
    numbered: Any = label(missing)
    holes = numbered[0]
    sizes = np.bincount(holes.ravel())
    return missing & (sizes[holes] > SMALL_HOLE * heights.size)


def _largest_rectangle(known: np.ndarray) -> tuple[slice, slice]:
    """The largest rectangle of a mask (nx, ny) in which all is true.

    Row by row, each column is as high as what is true above it; a stack finds the largest rectangle
    under these.
    """
    best = 0
    largest = (slice(0, 0), slice(0, 0))
    high = np.zeros(known.shape[1], dtype=int)
    for row, line in enumerate(known):
        high = np.where(line, high + 1, 0)
        # first column and height of rectangles that are still open
        open_columns: list[tuple[int, int]] = []
        for column, height in enumerate([*high.tolist(), 0]):
            start = column
            while open_columns and open_columns[-1][1] >= height:
                start, tall = open_columns.pop()
                if tall * (column - start) > best:
                    best = tall * (column - start)
                    largest = slice(row + 1 - tall, row + 1), slice(start, column)
            open_columns.append((start, height))
    return largest
