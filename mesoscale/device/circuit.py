"""What a device engineer simulates: the switch in motion, its spread as draws, and its corners.

Corners lie some standard deviations out (`FAR`), in the direction of inputs, D0 and properties that moves the release
(sticky, loose) or the pull-in (fast, slow) most: the slope of a plane through the switches of all points.
"""

from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtr, ndtri

from mesoscale.device.beam import beam_of, lumped_beam
from mesoscale.device.beam_switch import ELEMENTS, BeamStates, loop_fF, solve_bent
from mesoscale.device.electrode import with_pad
from mesoscale.device.lumps import Study, lumps_of, move, study_lumps
from mesoscale.device.points import PadModel, Point, point_of, press_pad, values_at
from mesoscale.device.release import SOLVED
from mesoscale.errors import InputError
from mesoscale.inputs.distributions import InputTable
from mesoscale.pad.cells import FIRST_SEED
from mesoscale.pad.local import LocalPad
from mesoscale.pad.memory import PadLaw
from mesoscale.settings import ContactSettings, DeviceSettings
from mesoscale.settings.device import SPREAD

Array = NDArray[np.float64]

DRAWS = 16
"""Points whose switches are written."""
CORNER_CELLS = 64
"""Cells of the pad of a corner, which stands alone."""
FAR = (2.0, 1.5, 1.0, 0.5)
"""Deviations of the corners, the first that can be solved."""
CORNERS = {
    "loose": ("release_V", 1.0),
    "sticky": ("release_V", -1.0),
    "slow": ("pull_in_V", 1.0),
    "fast": ("pull_in_V", -1.0),
}
VOLTS = 61
MESHES = (ELEMENTS, 96, 160)
DRIVE = 1.1
"""Voltage of the transient over that of the pull-in."""
HOLD_US, END_US = 150.0, 250.0
KEPT = 1500


@dataclass(frozen=True)
class Version:
    """One switch of the spread.

    Attributes
    ----------
    row : its name, inputs, D0 and properties, pull-in and release, for device/circuit.csv.
    settings, law : its properties, without tilt, and its pad.
    """

    row: dict[str, Any]
    settings: DeviceSettings
    law: PadLaw


def study_on_pad(settings: DeviceSettings, law: PadLaw) -> tuple[Study, PadLaw]:
    """The lumps that the central switch needs, and its pad.

    Raises
    ------
    InputError : a plate on a spring, which has no corners; see `solve_beam`.
    """
    if not settings.bends:
        raise InputError("device.spring_N_per_m: circuits are made of bending electrodes; set it to null")
    return with_pad(lambda pad: study_lumps(settings, pad), law)


def versions(
    model: PadModel, table: InputTable, contact: ContactSettings, cutoffs_nm: tuple[float, float], lumps: int
) -> list[Version]:
    """Corners of the switch, whose pads are pressed for them, and its first solved points.

    Raises
    ------
    InputError : too many points, or a corner, cannot be solved.
    """
    solved, design, settings = model.solved, model.design, model.central.point.device
    if len(solved) < max(SOLVED * len(model.points), 2):
        raise InputError(f"device: only {len(solved)} of {len(model.points)} points of the switch can be solved")
    z, corners = ndtri(design.probability[solved]), []
    for number, (name, (state, sign)) in enumerate(CORNERS.items()):
        plane = np.column_stack([np.ones(len(z)), z])
        slope = np.linalg.lstsq(plane, model.states(state), rcond=None)[0][1:]
        out: Array = np.asarray(sign * slope / (np.linalg.norm(slope) or 1.0), float)

        def corner(far: float, out: Array = out, name: str = name, number: int = number) -> Version | None:
            values = values_at(ndtr(far * out)[None], table, settings, cutoffs_nm)[0]
            point = point_of(values, table.names, settings)
            with suppress(InputError):
                law = press_pad(point, contact, CORNER_CELLS, FIRST_SEED + number).law
                return _version(name, point, law, lumps, far)
            return None

        if (nearest := next((version for far in FAR if (version := corner(far))), None)) is None:
            raise InputError(f"device: the corner {name} of the switch cannot be solved, {FAR[-1]:g} deviations out")
        corners.append(nearest)
    drawn = []
    for k in solved:
        if (pad := model.points[k].pad) and len(drawn) < DRAWS:
            with suppress(InputError):
                drawn.append(_version(f"draw_{k + 1:02d}", model.points[k].point, pad.law, lumps))
    return [*corners, *drawn]


def _version(name: str, point: Point, pad: PadLaw, lumps: int, far: float = 0.0) -> Version:
    """The switch of a point by so many lumps.

    Raises
    ------
    InputError : see `solve_bent`.
    """
    device = point.device.model_copy(update={"tilt_nm": 0.0})

    def solve(law: PadLaw) -> BeamStates:
        return solve_bent(lumped_beam(device, lumps), device, law)

    states, law = with_pad(solve, pad)
    properties = {name: getattr(device, name) for name in SPREAD if name != "tilt_nm"}
    inputs = {**point.values, "gap_cutoff_nm": point.gap_cutoff_nm, **properties}
    row = {"switch": name, "deviations": far, **inputs, "pull_in_V": states.pull_in_V, "release_V": states.release_V}
    return Version(row, device, law)


def loops(central: Version, drawn: list[Version]) -> list[dict[str, float]]:
    """Rows of device/loop.csv: capacitance against voltage, up and down, central and of 90 % of the draws."""
    volts = np.linspace(0.0, DRIVE * max(version.row["pull_in_V"] for version in (central, *drawn)), VOLTS)
    curves = [_loop(central, volts)]
    for version in drawn:
        with suppress(InputError):  # a beam that finds no balance on any mesh
            curves.append(_loop(version, volts))
    if len(curves) <= SOLVED * len(drawn):
        raise InputError(f"device: the slow loop can be solved for only {len(curves) - 1} of {len(drawn)} draws")
    low, high = np.quantile(np.stack(curves[1:]), (0.05, 0.95), axis=0)
    return [
        {
            "voltage_V": float(volts[k]),
            **{
                f"{way}_{name}_fF": float(of[place, k])
                for place, way in enumerate(("up", "down"))
                for name, of in (("central", curves[0]), ("q05", low), ("q95", high))
            },
        }
        for k in range(VOLTS)
    ]


def _loop(version: Version, volts: Array, meshes: tuple[int, ...] = MESHES) -> Array:
    """The loop of one switch, shape (2, volts), by the first mesh on which the beam finds all its balances."""
    beam = beam_of(version.settings, meshes[0])
    try:
        solved = with_pad(lambda law: loop_fF(beam, version.settings, law, volts), version.law)[0]
    except InputError:  # between straight pieces of the pad's curves, steps may cycle
        if len(meshes) == 1:
            raise
        return _loop(version, volts, meshes[1:])
    return np.stack(solved)


def transient(central: Version, lumps: int) -> tuple[dict[str, float | None], list[dict[str, float]]]:
    """Closing, bounce and opening of the central switch after a step of voltage; rows of device/transient.csv."""
    drive = DRIVE * central.row["pull_in_V"]
    moving, law = lumps_of(central.settings, lumps), central.law
    motion = move(moving, LocalPad(law), lambda t: drive if t < HOLD_US else 0.0, END_US, (HOLD_US,), precision=1e-3)
    time, middle = motion.time_us, motion.separation_nm[-1]
    touch = float(law.separation_nm[law.closing[0] > 0].max())
    held = time <= HOLD_US
    landed = np.flatnonzero(held & (middle < touch))
    opened = np.flatnonzero(~held & (middle > 0.5 * moving.rest_nm[-1]))
    said = {
        "drive_V": drive,
        "closing_us": float(time[landed[0]]) if landed.size else None,
        "bounce_nm": max(float(middle[held][landed[0] :].max()) - touch, 0.0) if landed.size else None,
        "impact_m_s": -1e-3 * float(motion.velocity_nm_us[-1].min()),
        "opening_us": float(time[opened[0]]) - HOLD_US if opened.size else None,
        "deepest_nm": float(motion.separation_nm[:, held].min()),
        "table_ends_nm": float(law.separation_nm[0]),
    }
    shown = np.unique(np.searchsorted(time, np.linspace(0.0, END_US, KEPT)).clip(max=time.size - 1))
    columns = {"time_us": time, "voltage_V": motion.voltage_V, "middle_nm": middle}
    columns["capacitance_fF"] = 1e15 * motion.capacitance_F
    return said, [{name: float(values[k]) for name, values in columns.items()} for k in shown]
