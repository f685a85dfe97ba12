"""Error of the release on a pad against run time, one numerical choice at a time.

Everything is done with the cells that the scene has computed; some cells are closed again, to time them and
to see what their steps do.
"""

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.contact.displacement import Displacement
from mesoscale.device.beam import lumped_beam
from mesoscale.device.beam_switch import solve_beam, solve_bent
from mesoscale.device.electrode import solve_deepened
from mesoscale.device.pad_export import tables_of
from mesoscale.device.pad_switch import solve_on_pad
from mesoscale.device.switch import switch_from_settings
from mesoscale.errors import InputError
from mesoscale.inputs.contact import ContactInputs
from mesoscale.pad.cells import PadGrid, close_cells
from mesoscale.pad.curves import PadCells
from mesoscale.pad.memory import Flats, PadLaw, flats_of, law_of
from mesoscale.settings import ContactSettings, DeviceSettings

Array = NDArray[np.float64]
Row = dict[str, Any]

TIMED_CELLS = 2
"""Cells that are closed again."""
GROUPS = 4
ELEMENTS = (16, 32, 64, 128, 256)
FINEST_ELEMENTS = 512
PAIRS = (8, 12, 16, 20, 28)
"""Of lumps, of the electrode in a circuit."""
LOOSER = (1.0, 4.0, 16.0)
"""Factors on the errors that tables for circuits may have."""
STICKS_WITHIN = 1e-3
MOST_ATTRACTION = 1e3
STEPS = (4, 2)
"""Coarser grids: every so many separations of the pad's own."""


def accuracy_points(
    cells: PadCells,
    inputs: ContactInputs,
    contact: ContactSettings,
    device: DeviceSettings,
    seeds: Sequence[int],
    progress: Callable[[float, str], None] | None = None,
) -> Iterator[Row]:
    """Rows of accuracy/pad.csv.

    Parameters
    ----------
    cells : of the pad at central inputs.
    seeds : of surfaces of the pad's cells.
    """
    flats = flats_of(inputs, contact)
    law = law_of(cells, flats)
    again = list(_closed_again(inputs, contact, cells.grid, seeds[:TIMED_CELLS]))
    parts: list[tuple[str, Iterator[Row]]] = [
        ("cells", _cells(cells, flats, device, again[0][1])),
        ("steps", _steps(again)),
        ("depths", _depths(law, device)),
        ("elements", _elements(law, device)),
        ("circuit", _circuit(law, device)),
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


def _release_V(law: PadLaw, device: DeviceSettings, elements: int | None = None) -> tuple[float, Array]:
    """Release (0: stuck; NaN: not computed), and the wall and processor time it took."""
    started = _clock()
    try:
        if not device.bends:
            release = solve_on_pad(switch_from_settings(device), law, device.hold_voltage_V).release_V
        elif elements is None:
            release = solve_deepened(device, law)["release_V"]
        else:
            release = solve_beam(device, law, elements).release_V
    except InputError:
        release = np.nan
    return release, _clock() - started


def _cells(cells: PadCells, flats: Flats, device: DeviceSettings, cost: Array) -> Iterator[Row]:
    """Fewer cells: disjoint groups of them, and the time to compute a group."""
    wanted, _ = _release_V(law_of(cells, flats), device)
    size = 8
    while size <= cells.count // 2:
        groups = [np.arange(k * size, (k + 1) * size) for k in range(min(cells.count // size, GROUPS))]
        deviations = []
        for group in groups:
            weights = np.zeros(cells.count)
            weights[group] = 1.0 / size
            deviations.append(_release_V(law_of(cells, flats, weights), device)[0] - wanted)
        error = float(np.sqrt(np.nanmean(np.square(deviations))))
        metric = f"RMS deviation over {len(groups)} groups, V"
        yield _row("release", "cells", size, error, metric, f"{cells.count} cells", size * cost)
        size *= 2


def _closed_again(
    inputs: ContactInputs, contact: ContactSettings, grid: PadGrid, seeds: Sequence[int]
) -> Iterator[tuple[list[Displacement], Array]]:
    """Cells at the separations of the pad and at every second and fourth of them, with the time of one."""
    list(close_cells(inputs, contact, PadGrid(grid.separation_nm, np.empty(0, int)), seeds[:1]))  # compiles
    for every in (1, *sorted(STEPS)):
        # from the deepest, which stays, and with the depths that the coarse grid has
        kept = np.arange(grid.separation_nm.size)[::-1][::every][::-1]
        depths = np.flatnonzero(np.isin(kept, grid.depths))
        started = _clock()
        closed = list(close_cells(inputs, contact, PadGrid(grid.separation_nm[kept], depths), seeds))
        yield closed, (_clock() - started) / len(seeds)


def _steps(again: Sequence[tuple[list[Displacement], Array]]) -> Iterator[Row]:
    """Coarser steps of separation: the force at the deepest closing, and the well on opening from there."""
    (fine, _), *coarser = again
    for every, (closed, cost) in zip(sorted(STEPS), coarser, strict=True):
        for case, of in (("force at the deepest closing", _force), ("well on opening from there", _well)):
            error = float(np.mean([abs(of(a) / of(b) - 1.0) for a, b in zip(closed, fine, strict=True)]))
            metric = "mean relative deviation over cells"
            yield _row(case, "steps of separation", every, error, metric, "the pad's own steps", cost)


def _force(cell: Displacement) -> float:
    return float(cell.closing[0, -1])


def _well(cell: Displacement) -> float:
    return float(-np.nanmin(cell.opening[-1].sum(axis=0)))


def _depths(law: PadLaw, device: DeviceSettings) -> Iterator[Row]:
    """Fewer depths in the memory, the first and the last always among them."""
    wanted, _ = _release_V(law, device)
    count = law.depth_nm.size
    for fewer in sorted({2, 3, (count + 1) // 2, count - 1} - {count}):
        kept = np.unique(np.linspace(0, count - 1, fewer).round().astype(int))
        release, cost = _release_V(replace(law, depth_nm=law.depth_nm[kept], opening=law.opening[kept]), device)
        yield _row("release", "pad.grid.depths", fewer, abs(release - wanted), "deviation, V", f"{count} depths", cost)


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


def _circuit(law: PadLaw, device: DeviceSettings) -> Iterator[Row]:
    """Nodes of the tables for circuits, and pairs of lumps of a bending electrode."""
    for looser in LOOSER:
        started = _clock()
        tables = tables_of(law, False, looser)
        nodes = sum(pieces[0].x.size for pieces in [tables.closing, *tables.opening])
        metric, cost = "largest error, of the well", _clock() - started
        yield _row("pressure in a circuit", "nodes of its tables", nodes, tables.of_well, metric, "the curves", cost)
    if not device.bends or device.without_lumps:
        return
    flat, reference = device.model_copy(update={"tilt_nm": 0.0}), f"{FINEST_ELEMENTS} elements"
    wanted, _ = _release_V(law, flat, FINEST_ELEMENTS)
    for pairs in PAIRS:
        started = _clock()
        release = solve_bent(lumped_beam(flat, pairs), flat, law).release_V
        cost = _clock() - started
        yield _row(
            "release in a circuit", "pairs of lumps", pairs, abs(release - wanted), "deviation, V", reference, cost
        )


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
