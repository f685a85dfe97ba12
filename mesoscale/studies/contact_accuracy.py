"""Error of a contact against the run time of a cycle, one numerical choice at a time.

The quantities are the law of the closing branch, the end of closing, the energy lost and the
pull-off, on several surfaces. Where the scene has a switch, pads are pressed with the same choice,
and the release is a quantity, too.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from mesoscale.answer.points import Point
from mesoscale.contact.cycle import Cycle, run_cycle
from mesoscale.contact.energy import dissipated_energy, pull_off
from mesoscale.contact.numerics import NUMERICS, Numerics
from mesoscale.contact.surface import shared_wave
from mesoscale.inputs.contact import ContactInputs
from mesoscale.law.fit import fit_branch
from mesoscale.pad.cells import FIRST_SEED, sample_cells
from mesoscale.pad.closing import press_cells
from mesoscale.pad.grid import PadGrid
from mesoscale.settings import ContactSettings
from mesoscale.studies.driver import (
    RELEASE,
    Array,
    Choice,
    Knob,
    Progress,
    Quantity,
    StudyRow,
    rows_of,
)
from mesoscale.switch import release_or_nan_V

SEEDS = (1, 2, 3, 4)
TOUCH_SHARE = 0.03
"""Share of the largest force at which d_c is taken: first contact does not depend on the path, and
would hide its error."""
OUTPUTS = (
    "d_c",
    "C_a",
    "C_r",
    "rho_r",
    "separation at full load",
    "attraction at full load",
    "dissipated energy",
    "pull-off",
)
FORCE_STEPS, PIXELS, GAP_BINS = "force steps", "pixels a side", "bins of the far attraction"
LENGTHS = ("d_c", "separation at full load")

Setup = tuple[ContactSettings, Numerics]
Releases = Callable[[ContactSettings, Numerics], Array]
"""Release on a few pads of the scene's switch, V, shape (pads,), with the contact computed in a
certain way.
"""


def accuracy_points(
    inputs: ContactInputs,
    settings: ContactSettings,
    pads: tuple[ContactSettings, Releases] | None = None,
    progress: Progress | None = None,
) -> Iterator[StudyRow]:
    """Rows of accuracy/contact.csv without the stage.

    Parameters
    ----------
    inputs, settings : of the scene's contact.
    pads : contact on the grid of the scene's pads, and its releases (`releases_on_pads`); None:
        there is no switch.
    """
    outputs = partial(cycle_outputs, inputs)
    yield from rows_of([*_knobs(settings, law_quantities(inputs), outputs, "surfaces")], progress)
    if pads is not None:
        on_grid, releases = pads
        knobs = _knobs(on_grid, [RELEASE], partial(_columns, releases), "pads")
        # a pad is closed by separation: its steps are a choice of the pad; bins err by rounding on
        # one cell already
        of_pads = [knob for knob in knobs if knob.name not in (FORCE_STEPS, GAP_BINS)]
        on_pads = [replace(knob, name=f"{knob.name}, on pads") for knob in of_pads]
        yield from rows_of(on_pads, progress)


def law_quantities(inputs: ContactInputs) -> list[Quantity]:
    """The quantities of `cycle_outputs`."""
    percent_of_rms = inputs.rms / 100
    return [
        Quantity(name, "% of RMS", percent_of_rms) if name in LENGTHS else Quantity(name, "%")
        for name in OUTPUTS
    ]


def releases_on_pads(
    grid: PadGrid, cells: int, point: Point, contact: ContactSettings, numerics: Numerics
) -> Array:
    """Release of a point's switch on pads of different surfaces, V, shape (pads,), NaN where it has
    no answer.

    Parameters
    ----------
    grid : separations of the point's own pad.
    cells : of each pad.
    contact : on the grid of the pads, without the point's inputs.
    """
    inputs, settings = point.contact_of(contact)
    releases = []
    for pad in SEEDS:
        sampled = sample_cells(inputs, cells, FIRST_SEED + 10_000 * pad)
        pressed = press_cells(inputs, settings, grid, sampled, numerics=numerics)
        releases.append(release_or_nan_V(point.device, pressed.curves))
    return np.array(releases)


def _knobs(
    settings: ContactSettings,
    quantities: Sequence[Quantity],
    compute: Callable[..., Array],
    samples: str,
) -> Iterator[Knob]:
    """The numerical choices of a contact; all grids show the same surface, that of the scene's
    cut-off.
    """

    def knob(
        name: str, shipped: Any, best: tuple[str, Setup], values: Sequence[tuple[Any, Setup]]
    ) -> Knob:
        choices = [Choice(value, partial(compute, *setup)) for value, setup in values]
        words, setup = best
        return Knob(
            name,
            quantities,
            choices,
            shipped,
            words,
            partial(compute, *setup),
            f"{len(SEEDS)} {samples}",
        )

    def numerics(
        field: str, best: Any, values: Sequence[Any], **others: Any
    ) -> tuple[Setup, list[tuple[Any, Setup]]]:
        def changed(value: Any) -> Setup:
            return settings, replace(NUMERICS, **{field: value}, **others)

        return changed(best), [(value, changed(value)) for value in values]

    best, values = numerics("force_steps", 320, (5, 10, 20, 40, 80))
    yield knob(FORCE_STEPS, NUMERICS.force_steps, ("320 steps", best), values)
    if settings.mechanics == "adhesive":
        best, values = numerics("unknown_work", 0.001, (0.1, 0.05, 0.02, 0.01, 0.005))
        yield knob("unknown work", NUMERICS.unknown_work, ("unknown work 0.001", best), values)
    if settings.mechanics == "asperity":  # coupled pressures need no flow to settle
        best, values = numerics(
            "flow_tolerance", 1e-5, (0.1, 0.03, 0.01, 1e-3, 1e-4), max_sweeps=5000
        )
        yield knob("flow tolerance", NUMERICS.flow_tolerance, ("tolerance 1e-5", best), values)
        small = {"flow": "increment", "max_sweeps": 100_000}
        best, values = numerics("flow_increment_nm", 0.003, (0.3, 0.1, 0.03, 0.01), **small)
        values.append(("return", (settings, NUMERICS)))
        yield knob(
            "flow increment, nm (paper: 0.3)", "return", ("increments of 0.003 nm", best), values
        )
    best, values = numerics("gap_bins", 65536, (16, 64, 256, 1024, 4096))
    yield knob(GAP_BINS, NUMERICS.gap_bins, ("65536 bins", best), values)
    grids = list(_grids(settings))
    if len(grids) > 1:
        *coarser, finest = grids
        words = f"{finest.pixels} pixels, cut-off {finest.q1_per_nm:.3g} 1/nm"
        values = [(grid.pixels, (grid, NUMERICS)) for grid in coarser]
        yield knob(PIXELS, settings.pixels, (words, (finest, NUMERICS)), values)


def _grids(settings: ContactSettings) -> Iterator[ContactSettings]:
    """Grids from a quarter of the scene's pixels on that resolve its cut-off, else the Nyquist
    limit of its grid.
    """
    cutoff = shared_wave(settings)
    # coupled cycles cost twenty times as much on twice the sites a side
    finer = (2, 4) if settings.mechanics == "asperity" and settings.pixels <= 1024 else (2,)
    for factor in (0.25, 0.5, 1, *finer):
        grid = settings.model_copy(
            update={"pixels": round(factor * settings.pixels), "q1_per_nm": cutoff}
        )
        if grid.pixels >= 32 and grid.nyquist_per_nm >= cutoff * (1 - 1e-9):
            yield grid


def cycle_outputs(inputs: ContactInputs, settings: ContactSettings, numerics: Numerics) -> Array:
    """OUTPUTS on each surface, shape (seeds, outputs)."""
    cycles = [run_cycle(inputs, settings, seed, numerics=numerics) for seed in SEEDS]
    return np.array([_of_cycle(cycle, inputs, settings) for cycle in cycles])


def _of_cycle(cycle: Cycle, inputs: ContactInputs, settings: ContactSettings) -> list[float]:
    """The numbers OUTPUTS of one cycle: law of the closing branch, end of closing, energy."""
    closing = cycle.closing
    rising = np.maximum.accumulate(closing.repulsive_nN)
    d_c = float(np.interp(TOUCH_SHARE * rising[-1], rising, closing.separation_nm))
    forces = closing.repulsive_nN, closing.attractive_nN
    fit = fit_branch(closing.separation_nm, *forces, settings.length_nm**2, inputs.hamaker, d_c)
    return [
        d_c,
        fit.C_a_GPa_nm,
        fit.C_r_GPa,
        fit.rho_r_nm,
        closing.separation_nm[-1],
        closing.attractive_nN[-1],
        dissipated_energy(cycle)[0],
        pull_off(cycle.opening),
    ]


def _columns(releases: Releases, settings: ContactSettings, numerics: Numerics) -> Array:
    """Releases as samples of one quantity."""
    return releases(settings, numerics)[:, None]
