"""Error of the release on a pad against run time, one numerical choice at a time.

Cells, steps, depths and grid are judged by the release on a pad of the same surfaces that is pressed again for each;
the number of points by the quantiles of the release over all points.
"""

import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.device.electrode import release_or_nan_V
from mesoscale.device.points import PadModel, Point, on_pad_grid, press_pad
from mesoscale.device.release import ENDS
from mesoscale.inputs.distributions import InputTable
from mesoscale.pad.memory import PadLaw
from mesoscale.pad.numerics import PAD
from mesoscale.settings import ContactSettings, DeviceSettings

Array = NDArray[np.float64]
Row = dict[str, Any]

CELLS = (4, 8, 16, 32)
"""Cells of a pad, beside twice as many as the most."""
OTHERS = 4
"""Pads of other surfaces, of each number of cells."""
TIMES = (4.0, 2.0, 0.5)
"""Steps of separation, in units of the pads' own."""
MORE_DEPTHS = 12
SIDES = (2, 4)
"""Finer grids: so many times the pads' sites a side."""
ELEMENTS = (16, 32, 64, 128, 256)
FINEST_ELEMENTS = 512
STICKS_WITHIN = 1e-3
MOST_ATTRACTION = 1e3
RESAMPLES = 200


def accuracy_points(
    model: PadModel,
    table: InputTable,
    contact: ContactSettings,
    cells: int,
    progress: Callable[[float, str], None] | None = None,
) -> Iterator[Row]:
    """Rows of accuracy/pad.csv.

    Parameters
    ----------
    contact : of the scene.
    cells : of the pad of a point.

    Raises
    ------
    InputError : the pad at central inputs cannot be pressed.
    """
    central = model.central
    law, device, coarse = central.pressed.law, central.point.device, on_pad_grid(contact, table)
    press_pad(central.point, coarse, 2, PAD.first_seed)  # compiles
    parts: list[tuple[str, Iterator[Row]]] = [
        ("cells", _cells(central.point, coarse)),
        ("steps", _steps(central.point, coarse, cells)),
        ("depths", _depths(central.point, coarse, cells)),
        ("grid", _grid(central.point, coarse, cells)),
        ("points", _points(model, coarse, cells)),
        ("elements", _elements(law, device)),
    ]
    for done, (name, rows) in enumerate(parts):
        yield from rows
        if progress:
            progress((done + 1) / len(parts), name)


def _row(case: str, knob: str, value: object, error: float, metric: str, reference: str, cost: Array) -> Row:
    """A row; `cost` is wall and processor time (s)."""
    wall_s, cpu_s = cost.tolist()
    return {
        "case": case,
        "knob": knob,
        "value": value,
        "error": error,
        "error_metric": metric,
        "reference": reference,
        "wall_s": wall_s,
        "cpu_s": cpu_s,
    }


def _clock() -> Array:
    return np.array([time.perf_counter(), time.process_time()])


def _release_V(law: PadLaw, device: DeviceSettings, *elements: int) -> tuple[float, Array]:
    """Release (0: stuck; NaN: not computed), and the wall and processor time it took."""
    started = _clock()
    release = release_or_nan_V(device, law, *elements)
    return release, _clock() - started


def _pressed_V(point: Point, contact: ContactSettings, cells: int, first_seed: int = PAD.first_seed, **choices: Any):
    """Release on a pad that is pressed now, and the wall and processor time of pressing it."""
    started = _clock()
    law = press_pad(point, contact, cells, first_seed, **choices).law
    cost = _clock() - started
    return _release_V(law, point.device)[0], cost


def _cells(point: Point, contact: ContactSettings) -> Iterator[Row]:
    """Fewer cells: pads of other surfaces."""
    most = 2 * CELLS[-1]
    wanted, _ = _pressed_V(point, contact, most)
    for count in CELLS:
        tried = [_pressed_V(point, contact, count, PAD.first_seed + (k + 1) * 10_000) for k in range(OTHERS)]
        error = float(np.sqrt(np.nanmean([(release - wanted) ** 2 for release, _ in tried])))
        metric, cost = f"RMS deviation over {OTHERS} pads, V", np.mean([cost for _, cost in tried], axis=0)
        yield _row("release", "cells", count, error, metric, f"{most} cells", cost)


def _steps(point: Point, contact: ContactSettings, cells: int) -> Iterator[Row]:
    """Longer and shorter steps of separation."""
    step = min(PAD.step_rms * point.values["rms"], PAD.longest_step_nm)
    wanted, _ = _pressed_V(point, contact, cells, step_nm=step * TIMES[-1])
    for times in (*TIMES[:-1], 1.0):
        release, cost = _pressed_V(point, contact, cells, step_nm=step * times)
        metric, reference = "deviation, V", f"steps of {step * TIMES[-1]:.2g} nm"
        yield _row("release", "steps of separation, nm", step * times, abs(release - wanted), metric, reference, cost)


def _depths(point: Point, contact: ContactSettings, cells: int) -> Iterator[Row]:
    """Fewer and more depths in the memory."""
    wanted, _ = _pressed_V(point, contact, cells, depths=MORE_DEPTHS)
    for depths in (2, 3, PAD.depths, 2 * PAD.depths):
        release, cost = _pressed_V(point, contact, cells, depths=depths)
        yield _row("release", "depths", depths, abs(release - wanted), "deviation, V", f"{MORE_DEPTHS} depths", cost)


def _grid(point: Point, contact: ContactSettings, cells: int) -> Iterator[Row]:
    """Finer grids, on which the same seeds draw other surfaces: the difference of pads counts beside their scatter."""
    releases = {}
    for times in (1, *SIDES):
        finer = contact.model_copy(update={"pixels": contact.pixels * times})
        releases[finer.pixels] = [_pressed_V(point, finer, cells, PAD.first_seed + k * 10_000) for k in range(OTHERS)]
    *coarser, finest = releases
    wanted = float(np.mean([release for release, _ in releases[finest]]))
    for pixels in coarser:
        mean = float(np.mean([release for release, _ in releases[pixels]]))
        metric, cost = f"deviation of the mean of {OTHERS} pads, V", np.mean([c for _, c in releases[pixels]], axis=0)
        yield _row("release", "sites a side", pixels, abs(mean - wanted), metric, f"{finest} sites", cost)


def _points(model: PadModel, contact: ContactSettings, cells: int) -> Iterator[Row]:
    """Fewer points: quantiles of the release by random ones of them."""
    release = model.states("release_V") if model.points else np.empty(0)
    if release.size < 4:
        return
    rng, wanted = np.random.default_rng(0), np.quantile(release, ENDS)
    _, cost = _pressed_V(model.points[int(model.solved[0])].point, contact, cells)
    count = 16
    while count <= release.size // 2:
        picks = rng.permuted(np.tile(release, (RESAMPLES, 1)), axis=1)[:, :count]
        errors = np.sqrt(np.mean((np.quantile(picks, ENDS, axis=1).T - wanted) ** 2, axis=0))
        for end, error in zip(ENDS, errors.tolist(), strict=True):
            metric, reference = f"RMS deviation of {RESAMPLES} choices, V", f"{release.size} points"
            yield _row(f"{end:.0%} quantile of the release", "points", count, error, metric, reference, count * cost)
        count *= 2


def _elements(law: PadLaw, device: DeviceSettings) -> Iterator[Row]:
    """Elements of the bending electrode."""
    if not device.bends:
        return
    wanted, _ = _release_V(law, device, FINEST_ELEMENTS)
    for elements in ELEMENTS:
        release, cost = _release_V(law, device, elements)
        reference = f"{FINEST_ELEMENTS} elements"
        yield _row("release", "elements of the beam", elements, abs(release - wanted), "deviation, V", reference, cost)
    sticks, _ = _sticking(law, device, FINEST_ELEMENTS)
    for elements in ELEMENTS:
        factor, cost = _sticking(law, device, elements)
        metric, reference = "relative deviation", f"{FINEST_ELEMENTS} elements"
        error = abs(factor / sticks - 1.0)
        yield _row("attraction that sticks", "elements of the beam", elements, error, metric, reference, cost)


def _sticking(law: PadLaw, device: DeviceSettings, elements: int) -> tuple[float, Array]:
    """Least factor on the attraction with which the switch sticks (NaN: none found), and the time of a switch."""
    solved = []

    def sticks(factor: float) -> bool:
        times = np.array([[1.0], [factor]])
        flats = replace(law.flats, hamaker=factor * law.flats.hamaker)
        scaled = replace(law, closing=times * law.closing, opening=times * law.opening, flats=flats)
        release, cost = _release_V(scaled, device, elements)
        solved.append(cost)
        return release == 0.0

    low, high = 0.0, 1.0
    while not sticks(high):
        low, high = high, 2.0 * high
        if high > MOST_ATTRACTION:
            return np.nan, np.mean(solved, axis=0)
    while high - low > STICKS_WITHIN * high:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if sticks(middle) else (middle, high)
    return high, np.mean(solved, axis=0)
