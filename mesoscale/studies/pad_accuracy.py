"""Error of the release on a pad against run time, one numerical choice at a time.

Cells, steps, depths and sites are judged by the release at central inputs on pads of several
surfaces, which are the same for all values of a choice. The number of points is judged by the
quantiles of the release over all points.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from mesoscale.answer.known import ENDS
from mesoscale.answer.points import Point
from mesoscale.answer.switches import PadModel, solve_point, surfaces_of
from mesoscale.contact.surface import shared_wave, shortest_wave
from mesoscale.inputs.contact import ContactInputs
from mesoscale.pad.cells import Cell, sample_cells
from mesoscale.pad.closing import press_cells
from mesoscale.pad.grid import DEPTHS, PadGrid, usual_step_nm
from mesoscale.pad.pilots import Pilots, closed_until
from mesoscale.settings import ContactSettings
from mesoscale.studies.driver import (
    RELEASE,
    Array,
    Choice,
    Errors,
    Knob,
    Progress,
    Quantity,
    StudyRow,
    rows_of,
    timed,
)
from mesoscale.switch import release_or_nan_V, switch_of

PADS = 4
"""Pads of different surfaces on which a choice is tried."""
CELL_PADS = 6
"""The same for the number of cells: its error is chance, which few pads do not tell."""
FIRST_PAD = 200_000
"""Number of the first of these pads, beyond those of the points of an answer and of a failure rate.
"""
STEPS, BY_DEPTHS, SITES = "steps of separation, nm", "depths", "sites of the shortest wave"
CELLS, POINTS = "cells of a point's pad", "points"
RESAMPLES = 400
GROUPS = 8
"""Groups of points that are left out one at a time, for the error of a quantile's error."""


def accuracy_points(
    model: PadModel, contact: ContactSettings, cells: int, progress: Progress | None = None
) -> Iterator[StudyRow]:
    """Rows of accuracy/pad.csv without the stage.

    Parameters
    ----------
    contact : on the grid of the pads.
    cells : of the pad of a point.

    Raises
    ------
    InputError : the pad at central inputs cannot be pressed.
    """
    point = model.central.point
    pads = _pads(point, contact, cells, PADS)
    solve_point(point, contact, 2, surfaces_of(FIRST_PAD))  # compiles, so that no value pays for it
    knobs = [
        _cells(model, contact, cells),
        _steps(pads, point.values["rms"]),
        _depths(pads),
        *_sites(point, contact, cells),
        *_points(model, contact, cells),
    ]
    yield from rows_of(knobs, progress)


@dataclass(frozen=True)
class SamplePad:
    """A pad that is pressed again and again, with one numerical choice changed at a time."""

    point: Point
    inputs: ContactInputs
    settings: ContactSettings
    cells: Sequence[Cell]

    def grid(self, depths: int = DEPTHS) -> PadGrid:
        """Its separations, opened from so many depths."""
        pilots = Pilots(self.inputs, self.settings, self.cells)
        switch = switch_of(self.point.device.level)
        return closed_until(switch.carried_by, pilots).grid(depths)

    def release_V(self, grid: PadGrid, settings: ContactSettings | None = None) -> float:
        """Release of the point's switch on it (V); NaN where it has no answer."""
        settings = settings or self.settings
        pad = press_cells(self.inputs, settings, grid, self.cells)
        # elements of the beam are another choice: half as many cost half, and move all values alike
        return release_or_nan_V(self.point.device, pad.curves, coarse=True)


def _pads(point: Point, contact: ContactSettings, cells: int, count: int) -> list[SamplePad]:
    """So many pads of a point, each of other surfaces."""
    inputs, settings = point.contact_of(contact)
    on_pad = point.device.pad_um2 * 1e6 / settings.length_nm**2
    seeds = [surfaces_of(FIRST_PAD + number) for number in range(count)]
    return [
        SamplePad(point, inputs, settings, sample_cells(inputs, cells, seed, on_pad))
        for seed in seeds
    ]


def _releases(
    pads: Sequence[SamplePad], grids: Sequence[PadGrid], settings: ContactSettings | None = None
) -> Array:
    """Releases on pads, each at its separations, shape (pads, 1)."""
    return np.array(
        [[pad.release_V(grid, settings)] for pad, grid in zip(pads, grids, strict=True)]
    )


def _cells(model: PadModel, contact: ContactSettings, cells: int) -> Knob:
    """Fewer or more cells, beside a pad of many."""
    point = model.central.point
    counts = sorted({max(cells // 2, 2), cells, 2 * cells})

    def releases(count: int, pads: int) -> Array:
        sampled = _pads(point, contact, count, pads)
        return _releases(sampled, [pad.grid() for pad in sampled])

    known = model.central.pressed.count
    many = max(2 * counts[-1], known)

    def best() -> Array:
        if many > known:
            return releases(many, 1)
        curves = model.central.pressed.curves
        return np.array([[release_or_nan_V(point.device, curves, coarse=True)]])

    choices = [Choice(count, partial(releases, count, CELL_PADS)) for count in counts]
    return Knob(
        CELLS, [RELEASE], choices, cells, f"a pad of {many} cells", best, f"{CELL_PADS} pads"
    )


def _steps(pads: Sequence[SamplePad], rms_nm: float) -> Knob:
    """Longer steps, beside half of that in use, at separations from which the pads are opened in
    any case.
    """
    step = usual_step_nm(rms_nm)
    grids = [pad.grid() for pad in pads]

    def releases(merged: int) -> Array:
        return _releases(pads, [thinned(grid, merged) for grid in grids])

    def best() -> Array:
        return _releases(pads, [halved(grid) for grid in grids])

    choices = [Choice(merged * step, partial(releases, merged)) for merged in (4, 2, 1)]
    return Knob(
        STEPS, [RELEASE], choices, step, f"steps of {0.5 * step:.3g} nm", best, f"{PADS} pads"
    )


def thinned(grid: PadGrid, merged: int) -> PadGrid:
    """A grid with so many steps as one; its ends and depths stay."""
    last = grid.separation_nm.size - 1
    chosen_places = np.unique(np.concatenate([np.arange(0, last, merged), [last], grid.depths]))
    return PadGrid(grid.separation_nm[chosen_places], np.searchsorted(chosen_places, grid.depths))


def halved(grid: PadGrid) -> PadGrid:
    """A grid with two steps for each."""
    nearest = grid.separation_nm
    both = np.empty(2 * nearest.size - 1)
    both[::2] = nearest
    both[1::2] = 0.5 * (nearest[1:] + nearest[:-1])
    return PadGrid(both, 2 * grid.depths)


def _depths(pads: Sequence[SamplePad]) -> Knob:
    """Fewer or more depths from which the pads are opened, at loads in even ratios."""
    # the depths in use, those between them, and those between these
    most = 4 * (DEPTHS - 1) + 1
    grids = [pad.grid(most) for pad in pads]

    def releases(count: int) -> Array:
        return _releases(pads, [opened_from(grid, count) for grid in grids])

    counts = (2, DEPTHS // 2, DEPTHS, 2 * DEPTHS - 1)
    choices = [Choice(count, partial(releases, count)) for count in counts]
    best = partial(releases, most)
    return Knob(BY_DEPTHS, [RELEASE], choices, DEPTHS, f"{most} depths", best, f"{PADS} pads")


def opened_from(grid: PadGrid, count: int) -> PadGrid:
    """A grid with so many of its depths, the first and the last among them."""
    chosen = np.linspace(0.0, grid.depths.size - 1.0, count).round().astype(int)
    return PadGrid(grid.separation_nm, grid.depths[np.unique(chosen)])


def _sites(point: Point, contact: ContactSettings, cells: int) -> Iterator[Knob]:
    """Sites for a wave, on surfaces without the shortest waves: half of the sites then hold what is
    left.

    All grids show these same surfaces. Twice as many sites a side take eight times as long, and
    twenty times where asperities are coupled: these are not tried on more than the scene has.
    """
    half = contact.pixels // 2
    if contact.pixels % 2 or half < 32:
        return
    on_half = contact.model_copy(update={"pixels": half})
    # of the point: its inputs may hold a cut-off
    waves = shortest_wave(point.contact_of(contact)[1])
    cutoff = min(0.5 * waves, shared_wave(on_half))
    sides = [half, 2 * half]
    if contact.mechanics == "asperity":
        sides.append(4 * half)
    pads = [with_waves(pad, cutoff) for pad in _pads(point, contact, cells, PADS)]
    on_sides = [pads[0].settings.model_copy(update={"pixels": side}) for side in sides]
    finest = [SamplePad(pad.point, pad.inputs, on_sides[-1], pad.cells) for pad in pads]
    grids = [pad.grid() for pad in finest]
    sites = [round(2.0 * settings.nyquist_per_nm / cutoff, 3) for settings in on_sides]
    *tried, best = [partial(_releases, pads, grids, settings) for settings in on_sides]
    choices = [Choice(count, compute) for count, compute in zip(sites, tried, strict=False)]
    words = f"{sites[-1]:.3g} sites, waves up to {cutoff:.3g} 1/nm"
    yield Knob(SITES, [RELEASE], choices, sites[0], words, best, f"{PADS} pads")


def with_waves(pad: SamplePad, cutoff_per_nm: float) -> SamplePad:
    """The pad without the waves beyond a cut-off."""
    settings = pad.settings.model_copy(update={"q1_per_nm": cutoff_per_nm})
    return SamplePad(pad.point, pad.inputs, settings, pad.cells)


def _points(model: PadModel, contact: ContactSettings, cells: int) -> Iterator[Knob]:
    """Fewer or more points: standard errors of quantiles of the release, by drawing so many of the
    solved points.
    """
    release = model.states("release_V") if model.points else np.empty(0)
    if release.size < 2 * GROUPS:
        return
    point = model.points[int(model.solved[0])].point
    _, cost = timed(partial(solve_point, point, contact, cells, surfaces_of(1)))

    def errors(count: int) -> Errors:
        groups = np.arange(release.size) % GROUPS
        without = [quantile_errors(release[groups != group], count) for group in range(GROUPS)]
        spread = np.std(without, axis=0) * np.sqrt(GROUPS - 1)
        return Errors(quantile_errors(release, count), spread, cost.times(count))

    quantities = [Quantity(f"{end:.0%} quantile of the release", "V", volts=1.0) for end in ENDS]
    counts = [round(factor * release.size) for factor in (0.25, 0.5, 1, 2, 4)]
    choices = [Choice(count, partial(errors, count)) for count in counts]
    words = f"quantiles of all {release.size} solved points"
    yield Knob(
        POINTS, quantities, choices, release.size, words, samples=f"{RESAMPLES} draws of them"
    )


def quantile_errors(values: NDArray[np.float64], count: int) -> Array:
    """Standard errors of the quantiles `ENDS` of so many values that are drawn from those given."""
    rng = np.random.default_rng(np.random.SeedSequence([0, 0xB007]))
    picks = rng.integers(values.size, size=(RESAMPLES, count))
    return np.quantile(values[picks], ENDS, axis=1).std(axis=1)
