"""What a device engineer simulates: the switch in motion, its spread as draws, and its corners.

Corners lie some standard deviations out (`FAR`), in the direction of inputs, D0 and properties that moves the release
(sticky, loose) or the pull-in (fast, slow) most: the slope of a plane through the switches of many draws.
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
from mesoscale.device.lumps import COUNTS, Study, lumps_of, move, study_lumps
from mesoscale.device.release import SOLVED, Model, Point, pad_at, point_of, values_at
from mesoscale.device.spread import varied
from mesoscale.errors import InputError
from mesoscale.inputs.distributions import InputTable
from mesoscale.pad.local import LocalPad
from mesoscale.pad.memory import PadLaw
from mesoscale.settings import DeviceSettings
from mesoscale.settings.device import SPREAD

Array = NDArray[np.float64]

POINTS, DRAWS = 64, 16
"""Switches behind the corners, and those of them that are written."""
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
    table: InputTable, settings: DeviceSettings, cutoffs_nm: tuple[float, float], model: Model, lumps: int = COUNTS[-1]
) -> list[Version]:
    """Corners and draws of the switch.

    Raises
    ------
    InputError : too many draws, or a corner, cannot be solved.
    """
    from scipy.stats import qmc  # slow to import

    count, given = len(table.rows) + 1 + len(varied(settings)), (table, settings, cutoffs_nm, model)
    units = qmc.LatinHypercube(count, rng=0).random(POINTS)
    made = [_version(f"draw_{k + 1:02d}", row, *given, lumps) for k, row in enumerate(units)]
    solved = [k for k, version in enumerate(made) if version is not None]
    if len(solved) < SOLVED * POINTS:
        raise InputError(f"device: only {len(solved)} of {POINTS} draws of the switch can be solved")
    z, drawn = ndtri(units[solved]), [version for version in made if version is not None]
    corners = []
    for name, (answer, sign) in CORNERS.items():
        slope = np.linalg.lstsq(
            np.column_stack([np.ones(len(z)), z]), np.array([version.row[answer] for version in drawn]), rcond=None
        )[0][1:]
        out = sign * slope / (np.linalg.norm(slope) or 1.0)
        tried = (_version(name, ndtr(far * out), *given, lumps, far) for far in FAR)
        if (corner := next((version for version in tried if version), None)) is None:
            raise InputError(f"device: the corner {name} of the switch cannot be solved, {FAR[-1]:g} deviations out")
        corners.append(corner)
    return [*corners, *drawn[:DRAWS]]


def _version(
    name: str,
    units: Array,
    table: InputTable,
    settings: DeviceSettings,
    cutoffs_nm: tuple[float, float],
    model: Model,
    lumps: int,
    far: float = 0.0,
) -> Version | None:
    """The switch at probabilities of what varies; None where it has no solution."""
    values = values_at(units[None], table, settings, *cutoffs_nm)[0]
    point: Point = point_of(values, table.names, settings)
    device = point.device.model_copy(update={"tilt_nm": 0.0})

    def solve(law: PadLaw) -> BeamStates:
        return solve_bent(lumped_beam(device, lumps), device, law)

    try:
        states, law = with_pad(solve, pad_at(point, model))
    except InputError:
        return None
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
