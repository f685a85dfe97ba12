"""Error of the switch for simulators against run time: by its lumps, and by the tables of its
pad.
"""

from collections.abc import Callable, Iterator, Sequence
from functools import partial

import numpy as np

from mesoscale.answer.switches import PadModel, Solved
from mesoscale.circuit.lumps import choose_lumps
from mesoscale.circuit.numerics import CIRCUIT
from mesoscale.circuit.tables import curves_of_tables, tables_of
from mesoscale.errors import InputError
from mesoscale.pad.curves import PadCurves, on_deep_enough
from mesoscale.settings import DeviceSettings
from mesoscale.studies.answer_accuracy import samples_of
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
from mesoscale.switch.beam import COARSE_ELEMENTS, Beam, beam_of, lumped_beam
from mesoscale.switch.beam_switch import BeamStates, BeamSwitch

SWITCHES = 3
"""Switches that are solved with each choice: the central one and others."""
LUMPS, STRAIGHT, CUBIC = (
    "pairs of lumps",
    "allowed error of SPICE tables, over usual",
    "allowed error of Verilog-A tables, over usual",
)
LOOSER = (100.0, 10.0, 1.0)
QUANTITIES = (RELEASE, Quantity("pull-in", "V"), Quantity("capacitance", "%"))

BeamOf = Callable[[DeviceSettings], Beam]
CurvesOf = Callable[[PadCurves], PadCurves]


def accuracy_points(model: PadModel, progress: Progress | None = None) -> Iterator[StudyRow]:
    """Rows of accuracy/circuit.csv without the stage; none of an electrode that has no lumps.

    Raises
    ------
    InputError : the switch at central inputs cannot be solved.
    """
    device = model.central.point.device
    if device.without_circuit:
        return
    switches = samples_of(model, SWITCHES)
    samples = f"{len(switches)} switches of the scene"
    in_use, _ = on_deep_enough(model.central.pressed.curves, partial(choose_lumps, device))
    counts = sorted({*CIRCUIT.lump_counts[::2], in_use.lumps})
    elements = CIRCUIT.reference_elements // 2
    by_lumps = [
        Choice(count, partial(states, switches, partial(lumped_beam, lumps=count)))
        for count in counts
    ]
    exact = partial(states, switches, partial(beam_of, elements=elements))
    knobs = [
        Knob(
            LUMPS, QUANTITIES, by_lumps, in_use.lumps, f"{elements} finite elements", exact, samples
        )
    ]
    usual = partial(beam_of, elements=COARSE_ELEMENTS)
    on_curves = partial(states, switches, usual)
    for name, cubic in ((STRAIGHT, False), (CUBIC, True)):
        choices = [
            Choice(looser, partial(states, switches, usual, partial(on_tables, cubic, looser)))
            for looser in LOOSER
        ]
        knobs.append(
            Knob(name, QUANTITIES, choices, 1.0, "the curves themselves", on_curves, samples)
        )
    yield from rows_of(knobs, progress)


def on_tables(cubic: bool, looser: float, pad: PadCurves) -> PadCurves:
    """The pad as its tables have it, with so many times the usual errors."""
    return curves_of_tables(tables_of(pad, cubic, looser), pad, cubic)


def as_it_is(pad: PadCurves) -> PadCurves:
    """The pad as its curves have it."""
    return pad


def states(switches: Sequence[Solved], beam: BeamOf, made: CurvesOf = as_it_is) -> Array:
    """Release, pull-in (V) and held capacitance (fF) of switches without tilt, shape (switches, 3);
    NaN: no answer.
    """
    solutions = np.full((len(switches), 3), np.nan)
    for row, switch in zip(solutions, switches, strict=True):
        settings = switch.point.device.level

        def states_on(pad: PadCurves, settings: DeviceSettings = settings) -> BeamStates:
            return BeamSwitch(settings, beam(settings)).states_on(made(pad))

        try:
            solved, _ = on_deep_enough(switch.pressed.curves, states_on)
        except InputError:
            continue
        row[:] = solved.release_V, solved.pull_in_V, solved.capacitance_fF
    return solutions
