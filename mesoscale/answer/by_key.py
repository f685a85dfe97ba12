"""Release of the switch on the central pad against one property of the device at a time, for who
designs it.
"""

from collections.abc import Iterator, Sequence
from typing import Any

from mesoscale.errors import InputError
from mesoscale.pad.memory import PadLaw
from mesoscale.settings import DeviceSettings
from mesoscale.switch.electrode import solve_deepened

OF_A_BEAM = (
    "thickness_um",
    "length_um",
    "gap_um",
    "residual_stress_MPa",
    "dielectric_nm",
    "hold_voltage_V",
)
OF_A_PLATE = ("spring_N_per_m", "width_um", "gap_um", "dielectric_nm", "hold_voltage_V")


def release_by_key(device: DeviceSettings, law: PadLaw) -> list[dict[str, Any]]:
    """What the switch does where one property differs and all else stays: the pad was pressed at
    central inputs.

    From the device's own value outwards, until the switch has no answer: this row has a reason and
    no voltages. `continued` says that the pad is pressed harder than it was computed, so that its
    curves are continued; `own` is the device itself. Without an answer of its own there is nothing
    to compare with, and no row."""
    try:
        here = _voltages(device, law)
    except InputError:
        return []
    rows = []
    for key in OF_A_BEAM if device.bends else OF_A_PLATE:
        value = value_of(device, key, here["pull_in_V"])
        steps = [value * (factor - 1.0) for factor in (0.7, 0.85, 1.2, 1.4)]
        if key == "residual_stress_MPa":  # which may be 0
            steps = [-20.0, -10.0, 10.0, 20.0]
        below, above = (
            [step for step in steps[::-1] if step < 0],
            [step for step in steps if step > 0],
        )
        outwards = [*_outwards(device, law, key, [value + step for step in below])][::-1]
        rows += [*outwards, {"key": key, "value": value, **here, "own": True}]
        rows += _outwards(device, law, key, [value + step for step in above])
    return rows


def _outwards(
    device: DeviceSettings, law: PadLaw, key: str, values: Sequence[float]
) -> Iterator[dict[str, Any]]:
    for value in values:
        row = {"key": key, "value": value, "own": False}
        try:
            yield row | _voltages(device.model_copy(update={key: value}), law)
        except InputError as error:
            yield row | {
                "pull_in_V": None,
                "release_V": None,
                "continued": False,
                "reason": str(error),
            }
            return


def _voltages(device: DeviceSettings, law: PadLaw) -> dict[str, Any]:
    states = solve_deepened(device, law)
    return {
        "pull_in_V": states["pull_in_V"],
        "release_V": states["release_V"],
        "continued": bool(states["deepened"]),
        "reason": "",
    }


def value_of(device: DeviceSettings, key: str, pull_in_V: float) -> float:
    """The device's own value; of what it leaves open, what follows from the rest."""
    value = getattr(device, key)
    return float(pull_in_V if value is None else value)
