"""Error of a release against run time by the choices of the beam, on pads that the scene has
pressed.
"""

from collections.abc import Callable, Iterator, Sequence
from functools import partial

import numpy as np

from mesoscale.answer.switches import PadModel, Solved
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
from mesoscale.switch.beam import COARSE_ELEMENTS, ELEMENTS, beam_of
from mesoscale.switch.beam_kernels import OPENING_NM
from mesoscale.switch.beam_switch import RELEASE_TOLERANCE, BeamSwitch

SWITCHES = 4
"""Switches that are solved with each choice."""
BY_ELEMENTS, STEPS, TOLERANCE = (
    "elements of the beam",
    "steps of opening, nm",
    "relative error of a release",
)
QUANTITIES = (RELEASE, Quantity("pull-in", "V"))


def accuracy_points(model: PadModel, progress: Progress | None = None) -> Iterator[StudyRow]:
    """Rows of accuracy/answer.csv without the stage; none of a plate on a spring, which has no such
    choices.
    """
    if model.central.point.device.kind != "beam":
        return
    switches = samples_of(model, SWITCHES)
    solve = partial(states, switches)
    solve(COARSE_ELEMENTS)  # compiles, so that no value pays for it

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

    elements = [round(factor * ELEMENTS) for factor in (0.125, 0.25, 0.5, 1, 2)]
    steps = [factor * OPENING_NM for factor in (2, 1, 0.5)]
    usual = RELEASE_TOLERANCE
    tolerances = [factor * usual for factor in (10, 1, 0.1)]
    in_steps = partial(solve, ELEMENTS)
    within = partial(solve, ELEMENTS, OPENING_NM)
    knobs = [
        knob(BY_ELEMENTS, ELEMENTS, elements, 4 * ELEMENTS, solve),
        knob(STEPS, OPENING_NM, steps, OPENING_NM / 4, in_steps),
        knob(TOLERANCE, usual, tolerances, 1e-3 * usual, within),
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
    tolerance: float = RELEASE_TOLERANCE,
) -> Array:
    """Release and pull-in (V) of switches, shape (switches, 2); NaN where one has no answer."""
    voltages = np.full((len(switches), 2), np.nan)
    for row, switch in zip(voltages, switches, strict=True):
        device = switch.point.device
        try:
            beam = BeamSwitch(device, beam_of(device, elements), opening_nm, tolerance)
            solved = beam.states(switch.pressed.curves)
        except InputError:
            continue
        row[:] = solved.release_V, solved.pull_in_V
    return voltages
