"""Error of the release on a pad against run time, one numerical choice at a time.

Cells, steps, depths and grid are judged by the release on a pad of the same surfaces that is pressed again for each;
the number of points by the quantiles of the release over all points.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from mesoscale.device.electrode import release_or_nan_V
from mesoscale.device.points import PadModel, Point, on_pad_grid, press_pad
from mesoscale.device.release import ENDS
from mesoscale.inputs.distributions import InputTable
from mesoscale.pad.memory import PadLaw
from mesoscale.pad.numerics import PAD
from mesoscale.settings import ContactSettings, DeviceSettings
from mesoscale.studies.driver import Array, Knob, Progress, StudyRow, Try, compared, rows_of, timed


@dataclass(frozen=True)
class Tried:
    """What is tried.

    Attributes
    ----------
    cells : of a pad, beside twice as many as the most.
    others : pads of other surfaces, of each number of cells and on each grid.
    sides : finer grids, so many times the pads' sites a side.
    elements : of a beam, beside twice as many as the most.
    """

    cells: tuple[int, ...] = (4, 8, 16, 32)
    others: int = 4
    sides: tuple[int, ...] = (2, 4)
    elements: tuple[int, ...] = (16, 32, 64, 128, 256)


def accuracy_points(
    model: PadModel,
    table: InputTable,
    contact: ContactSettings,
    cells: int,
    progress: Progress | None = None,
    tried: Tried | None = None,
) -> Iterator[StudyRow]:
    """Rows of accuracy/pad.csv.

    Parameters
    ----------
    contact : of the scene.
    cells : of the pad of a point.

    Raises
    ------
    InputError : the pad at central inputs cannot be pressed.
    """
    tried, central, coarse = tried or Tried(), model.central, on_pad_grid(contact, table)
    press_pad(central.point, coarse, 2, PAD.first_seed)  # compiles
    knobs = [
        *_pressed_again(central.point, coarse, cells, tried),
        *_points(model, coarse, cells),
        *_beam(central.pressed.law, central.point.device, tried.elements),
    ]
    yield from rows_of(knobs, progress)


def _pressed_again(point: Point, contact: ContactSettings, cells: int, tried: Tried) -> Iterator[Knob]:
    """Cells, steps, depths and sites of a pad."""

    def release(cells: int = cells, on: ContactSettings = contact, seed: int = PAD.first_seed, **choices: Any) -> float:
        return release_or_nan_V(point.device, press_pad(point, on, cells, seed, **choices).law)

    def releases(first: int, **choices: Any) -> Array:
        return np.array(
            [release(seed=PAD.first_seed + k * 10_000, **choices) for k in range(first, first + tried.others)]
        )

    def rms(tried: Array, wanted: Array) -> float:
        return float(np.sqrt(np.nanmean((tried - wanted) ** 2)))

    most, others = 2 * tried.cells[-1], tried.others
    fewer = [(count, partial(releases, 1, cells=count)) for count in tried.cells]
    nearest = compared(lambda: np.array(release(cells=most)), fewer, rms, others)
    yield Knob("cells", f"RMS deviation over {others} pads, V", f"{most} cells", nearest)

    step = min(PAD.step_rms * point.values["rms"], PAD.longest_step_nm)
    steps = [(step * times, partial(release, step_nm=step * times)) for times in (4.0, 2.0, 1.0)]
    finest = compared(partial(release, step_nm=0.5 * step), steps)
    yield Knob("steps of separation, nm", "deviation, V", f"steps of {0.5 * step:.2g} nm", finest)

    depths = [(count, partial(release, depths=count)) for count in (2, PAD.depths // 2, PAD.depths, 2 * PAD.depths)]
    yield Knob("depths", "deviation, V", "32 depths", compared(partial(release, depths=32), depths))

    # the same seeds draw other surfaces on a finer grid: the difference of pads counts beside their scatter
    *coarser, finest_grid = (
        (finer.pixels, partial(releases, 0, on=finer))
        for times in (1, *tried.sides)
        if (finer := contact.model_copy(update={"pixels": contact.pixels * times}))
    )
    means = compared(finest_grid[1], coarser, lambda some, wanted: abs(some.mean() - wanted.mean()), others)
    yield Knob("sites a side", f"deviation of the mean of {others} pads, V", f"{finest_grid[0]} sites", means)


def _points(model: PadModel, contact: ContactSettings, cells: int) -> Iterator[Knob]:
    """Fewer points: quantiles of the release by random ones of them."""
    release = model.states("release_V") if model.points else np.empty(0)
    if release.size < 4:
        return
    resamples = 200

    def tries() -> Iterator[Try]:
        rng, wanted = np.random.default_rng(0), np.quantile(release, ENDS)
        _, cost = timed(partial(press_pad, model.points[int(model.solved[0])].point, contact, cells, PAD.first_seed))
        count = 16
        while count <= release.size // 2:
            picks = rng.permuted(np.tile(release, (resamples, 1)), axis=1)[:, :count]
            errors = np.sqrt(np.mean((np.quantile(picks, ENDS, axis=1).T - wanted) ** 2, axis=0))
            yield Try(count, errors, count * cost)
            count *= 2

    cases = [f"{end:.0%} quantile of the release" for end in ENDS]
    yield Knob("points", f"RMS deviation of {resamples} choices, V", f"{release.size} points", tries(), cases)


def _beam(law: PadLaw, device: DeviceSettings, elements: tuple[int, ...]) -> Iterator[Knob]:
    """Elements of the bending electrode."""
    if not device.bends:
        return
    finest = 2 * elements[-1]
    tries = [(count, partial(release_or_nan_V, device, law, count)) for count in elements]
    compare = compared(partial(release_or_nan_V, device, law, finest), tries)
    yield Knob("elements of the beam", "deviation, V", f"{finest} elements", compare)
