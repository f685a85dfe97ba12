"""Points of a surface, x, y and z, put on the grid that they lie on; places without a point are missing."""

from dataclasses import dataclass

import numpy as np

from mesoscale.errors import InputError

APART = 1e-3  # of their mean distance: coordinates closer than this are the same, rounded
OFF_GRID = 0.1  # of a step, by which rounded coordinates may lie beside their place
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
    """Heights (nx, ny) of points (n,), the side lengths in the unit of the positions, and this step in words.

    Parameters
    ----------
    stated : places along x and y, into which points without a regular grid are sorted; None: the points tell.

    Raises
    ------
    InputError : no regular grid, or too few points on it.
    """
    known = np.isfinite(x) & np.isfinite(y)
    x, y, z = x[known], y[known], z[known]
    if len(x) < 4:
        raise InputError(f"{where}: {len(x)} points with a position; give a map")
    along_x, along_y = (
        _sorted_in(values, stated[axis]) if stated else _places(where, values) for axis, values in enumerate((x, y))
    )
    counts = along_x.count, along_y.count
    sites = along_x.place * along_y.count + along_y.place
    size = along_x.count * along_y.count
    if len(np.unique(sites)) < FILLED * size:
        raise InputError(f"{where}: {len(x)} points for {counts[0]} x {counts[1]} places; {_advice(len(x))}")
    measured = np.isfinite(z)
    total = np.bincount(sites[measured], z[measured], size)
    number = np.bincount(sites[measured], minlength=size)
    heights = np.where(number > 0, total / np.maximum(number, 1), np.nan).reshape(counts)
    holes = int(np.count_nonzero(number == 0))
    lengths = along_x.count * along_x.step, along_y.count * along_y.step
    step = f"put {len(x)} points on a grid of {counts[0]} x {counts[1]}" + (f", {holes} without a point" * bool(holes))
    return heights, lengths, step


def _places(where: str, values: np.ndarray) -> Axis:
    """Places of coordinates on the even grid that they show."""
    order = np.sort(values)
    extent = order[-1] - order[0]
    if extent <= 0:
        raise InputError(f"{where}: all points lie on one line; give positions along it and heights")
    mean = extent / np.sqrt(len(values))
    starts = np.flatnonzero(np.diff(order) > APART * mean) + 1
    groups = np.split(order, starts)
    centres = np.array([group.mean() for group in groups])
    gaps = np.diff(centres)
    step = float(np.median(gaps))
    step = extent / max(1, round(extent / step))
    place = np.rint((values - order[0]) / step).astype(int)
    if np.abs(values - order[0] - place * step).max() > OFF_GRID * step:
        raise InputError(f"{where}: the points lie on no regular grid; {_advice(len(values))}")
    return Axis(place, int(place.max()) + 1, step)


def _sorted_in(values: np.ndarray, count: int) -> Axis:
    """Nearest of `count` even places for each coordinate."""
    step = float(np.ptp(values)) / (count - 1)
    return Axis(np.rint((values - values.min()) / step).astype(int), count, step)


def _advice(count: int) -> str:
    side = max(2, int(np.sqrt(count)))
    return (
        f"state how many there are along x and y, such as --points {side}x{side} (topography.instruments, points: "
        f"[{side}, {side}]): each place then gets the mean of its points"
    )
