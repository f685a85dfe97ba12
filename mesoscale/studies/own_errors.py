"""Numerical errors that every run tells of itself: of its contact and of its switch, at little
cost.

Each choice in use is compared with one finer, so that the rows are those of an accuracy table with
one value. The targets `accuracy` and `stability` tell more.
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from mesoscale.answer.points import Point
from mesoscale.answer.switches import press_pad, surfaces_of
from mesoscale.contact.numerics import NUMERICS
from mesoscale.contact.surface import shared_wave
from mesoscale.errors import InputError
from mesoscale.inputs.contact import ContactInputs
from mesoscale.pad.curves import PadCurves
from mesoscale.pad.grid import usual_step_nm
from mesoscale.settings import ContactSettings, DeviceSettings
from mesoscale.studies.contact_accuracy import (
    FORCE_STEPS,
    PIXELS,
    SEEDS,
    cycle_outputs,
    law_quantities,
)
from mesoscale.studies.driver import RELEASE, Array, Choice, Knob, StudyRow, rows_of
from mesoscale.switch import release_or_nan_V
from mesoscale.switch.beam import ELEMENTS, beam_of
from mesoscale.switch.beam_switch import BeamSwitch

STEPS, SITES, BY_ELEMENTS = "steps of separation, nm", "sites a side", "elements of the beam"


def of_contact(inputs: ContactInputs, settings: ContactSettings) -> Iterator[StudyRow]:
    """Rows of a cycle at central inputs, by its steps of force and by its grid.

    The finer grid shows the same surface. It is left out where attraction deforms the contact:
    there it takes minutes.
    """
    outputs = partial(cycle_outputs, inputs)
    waves = settings.model_copy(update={"q1_per_nm": shared_wave(settings)})
    usual = outputs(waves, NUMERICS)
    finer_path = replace(NUMERICS, force_steps=4 * NUMERICS.force_steps)
    compared = [(FORCE_STEPS, NUMERICS.force_steps, "four times as many", (waves, finer_path))]
    if settings.mechanics != "adhesive":
        finer_grid = waves.model_copy(update={"pixels": 2 * settings.pixels})
        compared.append(
            (PIXELS, settings.pixels, "twice as many, the same waves", (finer_grid, NUMERICS))
        )
    for name, value, words, finer in compared:
        choices = [Choice(value, lambda: usual)]
        samples = f"{len(SEEDS)} surfaces"
        yield from rows_of(
            [
                Knob(
                    name,
                    law_quantities(inputs),
                    choices,
                    value,
                    words,
                    partial(outputs, *finer),
                    samples,
                )
            ]
        )


def of_switch(
    point: Point, contact: ContactSettings, cells: int, central: PadCurves
) -> Iterator[StudyRow]:
    """Rows of the switch at central inputs, by the grid and the steps of its pad and by the
    elements of its beam.

    Twice as many sites take eight times as long. So the waves are limited to those that half of the
    sites hold, and half is compared with all: the error of two sites a wave, as the pad has them.

    Parameters
    ----------
    contact : on the grid of the pads.
    cells : of a pad.
    central : the scene's own pad at the point, for the beam.
    """

    def release(
        settings: ContactSettings = contact, step_nm: float | None = None, at: Point = point
    ) -> float:
        pad = press_pad(at, settings, cells, surfaces_of(0), step_nm=step_nm)
        return release_or_nan_V(point.device, pad.curves)

    def knob(name: str, value: float, words: str, in_use: float, finer: float) -> Knob:
        return Knob(
            name,
            [RELEASE],
            [Choice(value, lambda: _sample(in_use))],
            value,
            words,
            lambda: _sample(finer),
        )

    half = contact.model_copy(update={"pixels": contact.pixels // 2})
    shortest = shared_wave(half)
    half = half.model_copy(update={"q1_per_nm": shortest})
    smooth = contact.model_copy(update={"q1_per_nm": shortest})
    longer_waves = point
    if "q1" in point.values:  # an input, which the settings do not limit
        values = {**point.values, "q1": min(point.values["q1"], shortest)}
        longer_waves = replace(point, values=values)
    half_V, all_V = (release(settings, at=longer_waves) for settings in (half, smooth))
    usual_step = usual_step_nm(point.values["rms"])
    knobs = [
        knob(SITES, contact.pixels, "half as many for waves twice as long", half_V, all_V),
        knob(STEPS, usual_step, "half as long", release(), release(step_nm=0.5 * usual_step)),
    ]
    if point.device.kind == "beam":
        in_use = release_or_nan_V(point.device, central)
        finer = _finer_release_V(point.device, central)
        knobs.append(knob(BY_ELEMENTS, ELEMENTS, "twice as many", in_use, finer))
    yield from rows_of(knobs)


def _finer_release_V(device: DeviceSettings, pad: PadCurves) -> float:
    """Release of a beam of twice the elements (V); NaN where it has no answer."""
    try:
        return BeamSwitch(device, beam_of(device, 2 * ELEMENTS)).states(pad).release_V
    except InputError:
        return np.nan


def _sample(release_V: float) -> Array:
    """One sample of one quantity."""
    return np.array([[release_V]])
