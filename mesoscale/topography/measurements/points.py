"""Points x, y, z of a surface, put on the grid that they lie on; empty places are missing."""

from dataclasses import dataclass

import numpy as np

from mesoscale.errors import InputError

APART = 1e-3  # of their mean distance: coordinates closer than this are the same, rounded
OFF_GRID = 0.1  # of a step, by which rounded coordinates may lie beside their place
WELL_FILLED = 0.03  # share of empty places inside that an advised grid may have
FILLED = 0.25  # smallest share of places with a point: a round aperture fills 0.79


@dataclass(frozen=True)
class Axis:
    """Points along one axis: place (n,) of each, the number of places, and their distance."""

    place: np.ndarray
    count: int
    step: float


def on_grid(
    where: str, x: np.ndarray, y: np.ndarray, z: np.ndarray, stated: tuple[int, int] | None
) -> tuple[np.ndarray, tuple[float, float], str]:
    """Heights (nx, ny) of points (n,), side lengths in the positions' unit, and this step in words.

    Parameters
    ----------
    stated : places along x and y, into which points without a regular grid are sorted; None: the
        points tell.

    Raises
    ------
    InputError : no regular grid, or too few points on it.
    """
    known = np.isfinite(x) & np.isfinite(y)
    x = x[known]
    y = y[known]
    z = z[known]
    if len(x) < 4:
        raise InputError(f"{where}: {len(x)} points with a position; give a map")
    if min(np.ptp(x), np.ptp(y)) <= 0:
        raise InputError(
            f"{where}: all points lie on one line; give positions along it and heights"
        )
    if stated:
        along_x = _sorted_in(x, stated[0])
        along_y = _sorted_in(y, stated[1])
    else:
        along_x = _places(x)
        along_y = _places(y)
    if along_x is None or along_y is None:
        raise InputError(f"{where}: the points lie on no regular grid; {_advice(x, y)}")
    counts = along_x.count, along_y.count
    sites = along_x.place * along_y.count + along_y.place
    size = along_x.count * along_y.count
    if len(np.unique(sites)) < FILLED * size:
        raise InputError(
            f"{where}: {len(x)} points for {counts[0]} x {counts[1]} places; {_advice(x, y)}"
        )
    measured = np.isfinite(z)
    total = np.bincount(sites[measured], z[measured], size)
    points = np.bincount(sites[measured], minlength=size)
    mean = total / np.maximum(points, 1)
    heights = np.where(points > 0, mean, np.nan).reshape(counts)
    holes = int(np.count_nonzero(points == 0))
    lengths = along_x.count * along_x.step, along_y.count * along_y.step
    step = f"put {len(x)} points on a grid of {counts[0]} x {counts[1]}"
    if holes:
        step += f", {holes} without a point"
    return heights, lengths, step


def _places(values: np.ndarray) -> Axis | None:
    """Places of coordinates on the even grid that they show; None where they show none."""
    order = np.sort(values)
    extent = order[-1] - order[0]
    mean = extent / np.sqrt(len(values))
    starts = np.flatnonzero(np.diff(order) > APART * mean) + 1
    bounds = np.r_[0, starts, len(order)]
    centres = np.add.reduceat(order, bounds[:-1]) / np.diff(bounds)
    step = extent / max(1, round(extent / float(np.median(np.diff(centres)))))
    place = np.rint((values - order[0]) / step).astype(int)
    if np.abs(values - order[0] - place * step).max() > OFF_GRID * step:
        return None
    return Axis(place, int(place.max()) + 1, step)


def _sorted_in(values: np.ndarray, count: int) -> Axis:
    """Nearest of `count` even places for each coordinate."""
    step = float(np.ptp(values)) / (count - 1)
    return Axis(np.rint((values - values.min()) / step).astype(int), count, step)


def _advice(x: np.ndarray, y: np.ndarray) -> str:
    """A grid in whose places nearly all have a point, as an option to give."""
    extents = np.array([np.ptp(x), np.ptp(y)])
    step = float(np.sqrt(extents[0] * extents[1] / len(x)))
    counts = np.maximum(2, np.rint(extents / step).astype(int) + 1)
    while counts.min() > 2 and _empty_share(x, y, counts) > WELL_FILLED:
        counts = np.maximum(2, (0.9 * counts).astype(int))
    first, second = counts.tolist()
    return (
        f"state how many places there are along x and y, such as --points {first}x{second}"
        f" (topography.instruments, points: [{first}, {second}]): each then gets the mean of its"
        " points"
    )


def _empty_share(x: np.ndarray, y: np.ndarray, counts: np.ndarray) -> float:
    """Share of the places that have no point, but have some that do on both sides along x."""
    along_x = _sorted_in(x, int(counts[0]))
    along_y = _sorted_in(y, int(counts[1]))
    filled = np.zeros(tuple(counts), dtype=bool)
    filled[along_x.place, along_y.place] = True
    before = np.maximum.accumulate(filled, axis=0)
    after = np.maximum.accumulate(filled[::-1], axis=0)[::-1]
    inside = before & after  # an aperture has none outside
    return 1.0 - float(filled.sum()) / max(1, int(inside.sum()))
