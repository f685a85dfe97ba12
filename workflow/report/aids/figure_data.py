"""What a figure shows, as CSV that the page itself carries."""

import csv
import io
from collections.abc import Iterator, Sequence
from typing import Any
from urllib.parse import quote

import numpy as np
from matplotlib.collections import Collection, PathCollection, PolyCollection
from matplotlib.patches import Rectangle

MOST_POINTS = 100
"""Of a series; of a longer one every n-th stands for it, as all of them lie in the files named below the figure."""


def csv_link(axes: Sequence[Any], name: str) -> str:
    """Link that saves the figure's numbers; empty for a figure without lines, bands, points or bars."""
    rows = [(panel, *row) for panel, axis in enumerate(axes, start=1) for row in _rows(axis)]
    if not rows:
        return ""
    stream = io.StringIO()
    for panel, axis in enumerate(axes, start=1):
        words = f"panel {panel}: {axis.get_title()}; x: {axis.get_xlabel()}; y: {axis.get_ylabel()}"
        stream.write("# " + " ".join(words.split()) + "\n")
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerow(("panel", "series", "x", "y"))
    writer.writerows((panel, series, f"{x:.5g}", f"{y:.5g}") for panel, series, x, y in rows)
    data = quote(stream.getvalue(), safe=",:;()+")
    href = f"data:text/csv;charset=utf-8,{data}"
    return f'<a class="csv" download="{name}.csv" href="{href}">Numbers of this figure (CSV)</a>'


def _rows(axis: Any) -> Iterator[tuple[str, float, float]]:
    """Series, x and y of everything that is drawn in the coordinates of the data."""
    for number, line in enumerate(axis.get_lines(), start=1):
        if line.get_transform() == axis.transData:  # others mark a place across the whole panel
            points = np.column_stack([np.asarray(values, dtype=float) for values in line.get_data()])
            yield from _named(_name(line, f"line {number}"), points)
    for number, part in enumerate(axis.collections, start=1):
        yield from _collection(part, number)
    for number, bar in enumerate((patch for patch in axis.patches if isinstance(patch, Rectangle)), start=1):
        (left, bottom), (right, top) = bar.get_bbox().get_points().tolist()
        yield from _named(f"bar {number}, corners", np.array([(left, bottom), (right, top)]))


def _collection(part: Collection, number: int) -> Iterator[tuple[str, float, float]]:
    if isinstance(part, PathCollection):
        yield from _named(_name(part, f"points {number}"), np.asarray(part.get_offsets(), dtype=float))
    elif isinstance(part, PolyCollection):
        for path in part.get_paths():
            yield from _named(_name(part, f"band {number}") + ", outline", np.asarray(path.vertices, dtype=float))


def _name(artist: Any, otherwise: str) -> str:
    label = str(artist.get_label())
    return otherwise if not label or label.startswith("_") else label


def _named(series: str, points: np.ndarray) -> Iterator[tuple[str, float, float]]:
    points = points[np.isfinite(points).all(axis=1)]
    step = max(1, -(-len(points) // MOST_POINTS))
    return ((series, x, y) for x, y in points[::step].tolist())
