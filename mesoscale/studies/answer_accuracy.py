"""Error of a release against run time by the choices of the beam, on pads that the scene has
pressed.
"""

from collections.abc import Callable, Iterator, Sequence
from functools import partial

import numpy as np

from mesoscale.answer.points import PadModel, Solved
from mesoscale.errors import InputError
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
from mesoscale.switch.beam_kernels import OPENING_NM
from mesoscale.switch.beam_switch import solve_beam
from mesoscale.switch.electrode import with_pad
from mesoscale.switch.numerics import SWITCH

SWITCHES = 4
"""Switches that are solved with each choice."""
ELEMENTS, STEPS, TOLERANCE = (
    "elements of the beam",
    "steps of opening, nm",
    "relative error of a release",
)
QUANTITIES = (RELEASE, Quantity("pull-in", "V"))


def accuracy_points(model: PadModel, progress: Progress | None = None) -> Iterator[StudyRow]:
    """Rows of accuracy/answer.csv without the stage; none of a plate on a spring, which has no such
    choices.
    """
    if not model.central.point.device.bends:
        return
    switches = samples_of(model, SWITCHES)
    solve = partial(states, switches)
    solve(SWITCH.coarse_elements)  # compiles, so that no value pays for it

    def knob(
        name: str,
        shipped: float,
        values: Sequence[float],
        best: float,
        compute: Callable[..., Array],
    ) -> Knob:
        choices = [Choice(value, partial(compute, value)) for value in values]
        samples = f"{len(switches)} switches of the scene"
        return Knob(
            name, QUANTITIES, choices, shipped, f"{name}: {best:g}", partial(compute, best), samples
        )

    elements = [round(factor * SWITCH.elements) for factor in (0.125, 0.25, 0.5, 1, 2)]
    steps = [factor * OPENING_NM for factor in (2, 1, 0.5)]
    usual = SWITCH.release_tolerance
    tolerances = [factor * usual for factor in (10, 1, 0.1)]
    knobs = [
        knob(ELEMENTS, SWITCH.elements, elements, 4 * SWITCH.elements, solve),
        knob(STEPS, OPENING_NM, steps, OPENING_NM / 4, partial(solve, SWITCH.elements)),
        knob(
            TOLERANCE, usual, tolerances, 1e-3 * usual, partial(solve, SWITCH.elements, OPENING_NM)
        ),
    ]
    yield from rows_of(knobs, progress)


def samples_of(model: PadModel, switches: int) -> list[Solved]:
    """So many switches at most: the central one and some of the solved points, of all parts of the
    design.
    """
    solved = model.solved
    count = min(switches - 1, solved.size)
    chosen = solved[np.linspace(0, solved.size - 1, count).round().astype(int)] if count else []
    points = [model.points[k] for k in chosen]
    return [switch for switch in (model.central, *points) if switch.pad is not None]


def states(
    switches: Sequence[Solved],
    elements: int,
    opening_nm: float = OPENING_NM,
    tolerance: float = SWITCH.release_tolerance,
) -> Array:
    """Release and pull-in (V) of switches, shape (switches, 2); NaN where one has no answer."""
    voltages = np.full((len(switches), 2), np.nan)
    for row, switch in zip(voltages, switches, strict=True):
        device = switch.point.device
        solve = partial(
            solve_beam, device, elements=elements, opening_nm=opening_nm, tolerance=tolerance
        )
        try:
            beam, _ = with_pad(solve, switch.pressed.law)
        except InputError:
            continue
        row[:] = beam.release_V, beam.pull_in_V
    return voltages
