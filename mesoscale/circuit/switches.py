"""What a device engineer simulates: the central switch, its corners, draws of its spread, and their
slow loops.

Corners lie some standard deviations out, in the direction of inputs, D0 and properties that moves
the release (sticky, loose) or the pull-in (fast, slow) most: the slope of a plane through the
switches of all points.
"""

from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr, ndtri

from mesoscale.answer.points import Point, point_of, values_at
from mesoscale.answer.release import SOLVED_SHARE
from mesoscale.answer.switches import PadModel, press_pad
from mesoscale.circuit.lumps import LumpErrors, choose_lumps
from mesoscale.circuit.numerics import CIRCUIT
from mesoscale.errors import InputError
from mesoscale.inputs.distributions import InputTable
from mesoscale.pad.cells import FIRST_SEED
from mesoscale.pad.curves import PadCurves, on_deep_enough
from mesoscale.settings import ContactSettings, DeviceSettings
from mesoscale.settings.device import EVEN_CHARGE, SPREAD
from mesoscale.switch.beam import beam_of, lumped_beam
from mesoscale.switch.beam_switch import BeamSwitch
from mesoscale.switch.charge import shift_V
from mesoscale.switch.shifted import as_driven, as_felt

Array = NDArray[np.float64]

CORNERS = {
    "loose": ("release_V", 1.0),
    "sticky": ("release_V", -1.0),
    "slow": ("pull_in_V", 1.0),
    "fast": ("pull_in_V", -1.0),
}
CORNER_DEVIATIONS = (2.0, 1.5, 1.0, 0.5)
"""Of the inputs at a corner: the first with which it can be solved."""
CORNER_CELLS = 64
"""Cells of the pad of a corner, which stands alone."""
LOOP_VOLTAGES = 61
"""Of the slow loop."""
LOOP_ELEMENTS = (128, 96, 160)
"""Finite elements of the slow loop: the first with which all its balances are found."""


@dataclass(frozen=True)
class CircuitSwitch:
    """One switch for circuit simulators.

    Attributes
    ----------
    row : its name, inputs, D0 and properties, pull-in and release, for circuit/circuit.csv.
    settings, pad : its properties, without tilt, and its pad.
    """

    row: dict[str, Any]
    settings: DeviceSettings
    pad: PadCurves


def central_switch(settings: DeviceSettings, pad: PadCurves) -> tuple[CircuitSwitch, LumpErrors]:
    """The central switch on its pad, and the lumps that it needs.

    Raises
    ------
    InputError : a switch that has no circuit; see `choose_lumps`.
    """
    if settings.without_circuit:
        raise InputError(settings.without_circuit)
    shift = shift_V(settings)
    errors, continued = on_deep_enough(pad, partial(choose_lumps, as_felt(settings, shift)))
    pull_in_V, release_V = as_driven(errors.pull_in_V, errors.release_V, shift)
    row = {"switch": "central", "pull_in_V": pull_in_V, "release_V": release_V}
    return CircuitSwitch(row, settings.level, continued), errors


def spread_switches(
    model: PadModel,
    table: InputTable,
    contact: ContactSettings,
    cutoffs_nm: tuple[float, float],
    lumps: int,
) -> list[CircuitSwitch]:
    """Corners of the switch, whose pads are pressed for them, and its first solved points.

    Raises
    ------
    InputError : too many points, or a corner, cannot be solved.
    """
    solved, design, settings = model.solved, model.design, model.central.point.device
    if len(solved) < max(SOLVED_SHARE * len(model.points), 2):
        raise InputError(
            f"device: only {len(solved)} of {len(model.points)} points of the switch can be solved"
        )
    z = ndtri(design.probability[solved])
    corners = []
    plane = np.column_stack([np.ones(len(z)), z])
    for number, (name, (state, sign)) in enumerate(CORNERS.items()):
        slope = np.linalg.lstsq(plane, model.states(state), rcond=None)[0][1:]
        out = sign * slope / (np.linalg.norm(slope) or 1.0)
        for deviations in CORNER_DEVIATIONS:
            values = values_at(ndtr(deviations * out)[None], table, settings, cutoffs_nm)[0]
            point = point_of(values, table.names, settings)
            with suppress(InputError):
                pad = press_pad(point, contact, CORNER_CELLS, FIRST_SEED + number)
                corners.append(_by_lumps(name, point, pad.curves, lumps, deviations))
                break
        else:
            raise InputError(f"device: the corner {name} of the switch cannot be solved")
    drawn = []
    for place in solved:
        switch = model.points[place]
        if switch.pad and len(drawn) < CIRCUIT.draws:
            name = f"draw_{place + 1:02d}"
            with suppress(InputError):
                drawn.append(_by_lumps(name, switch.point, switch.pad.curves, lumps))
    return [*corners, *drawn]


def _by_lumps(
    name: str, point: Point, pad: PadCurves, lumps: int, deviations: float = 0.0
) -> CircuitSwitch:
    """The switch of a point by so many lumps.

    Raises
    ------
    InputError : see `BeamSwitch.states_on`.
    """
    device = point.device.level
    shift = shift_V(device)
    switch = BeamSwitch(as_felt(device, shift), lumped_beam(device, lumps))
    states, continued = on_deep_enough(pad, switch.states_on)
    pull_in_V, release_V = as_driven(states.pull_in_V, states.release_V, shift)
    written = [name for name in SPREAD if name not in EVEN_CHARGE or name in device.varied]
    properties = {name: getattr(device, name) for name in written if name != "tilt_nm"}
    inputs = {**point.values, "gap_cutoff_nm": point.gap_cutoff_nm, **properties}
    volts = {"pull_in_V": pull_in_V, "release_V": release_V}
    row = {"switch": name, "deviations": deviations, **inputs, **volts}
    return CircuitSwitch(row, device, continued)


def loops(central: CircuitSwitch, drawn: list[CircuitSwitch]) -> list[dict[str, float]]:
    """Rows of circuit/loop.csv: capacitance against voltage, up and down, central and of 90 % of the
    draws; of both polarities where even charge makes them differ.
    """
    top = CIRCUIT.loop_top * max(switch.row["pull_in_V"] for switch in (central, *drawn))
    volts = np.linspace(0.0, top, LOOP_VOLTAGES)
    if any(shift_V(switch.settings) for switch in (central, *drawn)):
        most_V = max(abs(shift_V(switch.settings)) for switch in (central, *drawn))
        outwards = np.linspace(0.0, top + 2.0 * most_V, LOOP_VOLTAGES)
        volts = np.concatenate([-outwards[:0:-1], outwards])
    curves = [_loop_fF(central, volts)]
    for switch in drawn:
        with suppress(InputError):  # a beam that finds no balance on any mesh
            curves.append(_loop_fF(switch, volts))
    if len(curves) <= SOLVED_SHARE * len(drawn):
        raise InputError(
            f"device: the slow loop can be solved for only {len(curves) - 1} of {len(drawn)} draws"
        )
    low, high = np.quantile(np.stack(curves[1:]), (0.05, 0.95), axis=0)
    return [
        {
            "voltage_V": float(voltage),
            **{
                f"{way}_{name}_fF": float(curve[place, k])
                for place, way in enumerate(("up", "down"))
                for name, curve in (("central", curves[0]), ("q05", low), ("q95", high))
            },
        }
        for k, voltage in enumerate(volts)
    ]


def _loop_fF(switch: CircuitSwitch, volts: Array) -> Array:
    """The loop of one switch, shape (2, volts), by the first mesh on which the beam finds all its
    balances; each polarity goes from 0 outwards and back.
    """
    if volts[0] < 0.0:
        negative = volts[volts < 0.0]
        positive = volts[volts >= 0.0]
        others = _outwards_fF(switch, negative[::-1])
        return np.hstack([others[:, ::-1], _outwards_fF(switch, positive)])
    return _outwards_fF(switch, volts)


def _outwards_fF(switch: CircuitSwitch, volts: Array) -> Array:
    """The loop of one polarity, from next to 0 to the highest voltage and back."""
    felt_V = np.abs(volts - shift_V(switch.settings))
    for elements in LOOP_ELEMENTS:
        beam = BeamSwitch(switch.settings, beam_of(switch.settings, elements))
        try:
            loop, _ = on_deep_enough(switch.pad, partial(beam.loop_fF, volts=felt_V))
        except InputError:  # between straight pieces of the pad's curves, steps may cycle
            if elements == LOOP_ELEMENTS[-1]:
                raise
        else:
            return np.stack(loop)
    raise AssertionError("unreachable: the last mesh returns or raises")
