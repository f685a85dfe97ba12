"""Are the releases of an answer those of pads with many more cells, of other surfaces?

`answer`: points of a finished scene as its answer has them. `other`: the same points on pads of 64
cells of other surfaces. `many`: the points that differ most, on pads of 1,024 independent places
(drawn one by one, as a device has them), each with a cell of its own. `fresh`: further points of
the joint distribution on pads of 64 cells, whose quantiles and share that sticks are set beside
those of the answer. The cells of these pads stand only for themselves: their curves are not shifted
as those of the answer are.
"""

from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np
from scipy.stats import qmc

from evidence.pad.large_surfaces import random_cells
from evidence.scenes import finished
from mesoscale.answer.points import Point, point_of, values_at
from mesoscale.answer.switches import surfaces_of
from mesoscale.errors import InputError
from mesoscale.inputs.contact import ContactInputs
from mesoscale.pad.cells import Cell, sample_cells
from mesoscale.pad.closing import press_cells
from mesoscale.pad.curves import PadCurves
from mesoscale.pad.pilots import Pilots, closed_until
from mesoscale.settings import ContactSettings
from mesoscale.switch import switch_of

OTHER_CELLS = 64
RESAMPLES = 4000
OTHERS = 500_000
"""Number of the first surfaces that no answer has."""


def arguments(parser: ArgumentParser) -> None:
    """Finished scenes, and how many points of each."""
    parser.add_argument("results", nargs="+", type=Path)
    parser.add_argument("--points", type=int, default=24, help="of the answer, on other surfaces")
    parser.add_argument("--worst", type=int, default=3, help="of them, on many cells")
    parser.add_argument("--cells", type=int, default=1024, help="of these")
    parser.add_argument("--fresh", type=int, default=0, help="further points")


def rows(given: Namespace) -> Iterator[dict[str, Any]]:
    """A row for each pad."""
    for folder in given.results:
        points, model = finished(folder)
        device, coarse = points.device, points.on_grid
        apart = {}
        for k, one in enumerate(model.points):
            release = one.states.release_V if one.states else np.nan
            yield _row(
                folder.name,
                "answer",
                k,
                one.pad.count if one.pad else 0,
                release,
                one.error_V,
                0.0,
            )
            if k < given.points:
                other = _pressed(folder.name, "other", k, one.point, coarse, OTHERS + k)
                apart[k] = abs(other["release_V"] - release)
                yield other
        for k in sorted(apart, key=lambda k: -np.nan_to_num(apart[k], nan=np.inf))[: given.worst]:
            cells = random_cells(given.cells, surfaces_of(3 * OTHERS))
            yield _pressed(folder.name, "many", k, model.points[k].point, coarse, cells)
        units = qmc.LatinHypercube(len(points.design.names), rng=1).random(given.fresh)
        values = values_at(units, points.table, device, points.cutoffs_nm)
        for k, row in enumerate(values):
            point = point_of(row, points.table.names, device)
            yield _pressed(folder.name, "fresh", k, point, coarse, 2 * OTHERS + k)


def _pressed(
    scene: str,
    kind: str,
    number: int,
    point: Point,
    contact: ContactSettings,
    cells: Sequence[Cell] | int,
) -> dict[str, Any]:
    """The row of a point on cells, or on 64 of the surfaces of a number."""
    started = process_time()
    inputs, settings = point.contact_of(contact)
    pad_cells = point.device.pad_um2 * 1e6 / settings.length_nm**2
    classes = sample_cells(
        inputs, OTHER_CELLS, surfaces_of(cells if isinstance(cells, int) else OTHERS), pad_cells
    )
    cells = classes if isinstance(cells, int) else cells
    release = release_V(point, inputs, settings, cells, classes)
    return _row(scene, kind, number, len(cells), release, np.nan, process_time() - started)


def release_V(
    point: Point,
    inputs: ContactInputs,
    settings: ContactSettings,
    cells: Sequence[Cell],
    pilots: Sequence[Cell],
) -> float:
    """Release on the mean curves of cells; NaN where they cannot carry the switch.

    Pilots tell how far they are closed: of cells drawn alike, the first have hardly a rough place.
    """
    try:
        level = switch_of(point.device.level)
        grid = closed_until(level.carried_by, Pilots(inputs, settings, pilots)).grid()
        pad = press_cells(inputs, settings, grid, cells)
        curves = PadCurves(
            separation_nm=grid.separation_nm[::-1],
            closing=pad.mean(pad.closing)[:, ::-1],
            depth_nm=grid.depth_nm[::-1],
            opening=pad.mean(pad.opening)[::-1, :, ::-1],
            flats=pad.flats,
        )
        return switch_of(point.device).states(curves).release_V
    except InputError:
        return np.nan


def _row(
    scene: str, kind: str, point: int, cells: int, release_V: float, error_V: float, cpu_s: float
) -> dict[str, Any]:
    names = ("scene", "kind", "point", "cells", "release_V", "error_V", "cpu_s")
    return dict(zip(names, (scene, kind, point, cells, release_V, error_V, cpu_s), strict=True))


def figures(table: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """RMS and mean of the differences, beside the stated error; the worst points; quantiles and
    share that sticks.
    """
    shown = {}
    for scene in dict.fromkeys(row["scene"] for row in table):
        by = {kind: _by_point(table, scene, kind) for kind in ("answer", "other", "many", "fresh")}
        stated = _by_point(table, scene, "answer", "error_V")
        both = [k for k in by["other"] if np.isfinite(by["other"][k] - by["answer"][k])]
        if both:
            apart = np.array([by["answer"][k] - by["other"][k] for k in both])
            errors = np.array([stated[k] for k in both])
            shown[f"{scene}_points"] = str(len(both))
            shown[f"{scene}_rms"] = f"{np.sqrt(np.mean(apart**2)):.2f} V"
            shown[f"{scene}_bias"] = f"{apart.mean():+.2f} V"
            shown[f"{scene}_median_apart"] = f"{np.median(np.abs(apart)):.2f} V"
            shown[f"{scene}_stated"] = f"{np.sqrt(np.nanmean(errors**2)):.2f} V"
            shown[f"{scene}_over_stated"] = _over_stated(apart, errors)
        shown |= {
            f"{scene}_worst_{n}": (
                f"{by['answer'][k]:.2f}, {by['other'][k]:.2f}, {by['many'][k]:.2f} V"
            )
            for n, k in enumerate(by["many"], 1)
        }
        for kind in ("answer", "fresh"):
            release = np.array([value for value in by[kind].values() if np.isfinite(value)])
            if release.size:
                low, middle, high = np.quantile(release, (0.05, 0.5, 0.95))
                said = (
                    f"{middle:.2f} [{low:.2f}, {high:.2f}] V, {np.mean(release == 0.0):.1%} stick"
                )
                shown[f"{scene}_{kind}"] = f"{said}, {release.size} points"
    return shown


def _over_stated(apart: np.ndarray, errors: np.ndarray) -> str:
    """Root mean square of differences over that of stated errors, and its 90 % interval by other
    draws of the points.
    """
    picks = np.random.default_rng(0).integers(apart.size, size=(RESAMPLES, apart.size))
    true, stated = (np.sqrt(np.nanmean(values[picks] ** 2, axis=1)) for values in (apart, errors))
    low, high = np.quantile(true / stated, (0.05, 0.95))
    ratio = np.sqrt(np.mean(apart**2) / np.nanmean(errors**2))
    return f"{ratio:.1f} [{low:.1f}, {high:.1f}]"


def _by_point(
    table: Sequence[Mapping[str, str]], scene: str, kind: str, column: str = "release_V"
) -> dict[int, float]:
    rows = (row for row in table if (row["scene"], row["kind"]) == (scene, kind))
    return {int(row["point"]): float(row[column]) for row in rows}
