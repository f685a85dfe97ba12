"""Does another device release on pads of the scene's device as on pads that are pressed for it?

`asperity what-if` and the budget solve another device on the pads that a run has pressed. Here each
of twelve devices has a pad of its own, too, of the same surfaces, as `pressed_anew_V`. `error_V` is
what the answer states for the number of cells. Rows `free` are of a sticking aluminium bridge: the
value of one property that frees it by the table of the page, and its release there and halfway back
to its own value, on pads pressed anew.
"""

from argparse import ArgumentParser, Namespace
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from mesoscale.answer.points import Point, central_point
from mesoscale.answer.reserve import freed_by_device, freed_by_surface
from mesoscale.answer.switches import press_pad, solved_on, surfaces_of
from mesoscale.errors import InputError
from mesoscale.inputs.table import film_table, input_table
from mesoscale.pad.pressed import Pad
from mesoscale.settings import ContactSettings, DeviceSettings
from mesoscale.settings.contact import AirSettings
from mesoscale.switch import switch_of

OTHERS: list[dict[str, float]] = [
    {"hold_voltage_V": 80.0},
    {"hold_voltage_V": 100.0},
    {"gap_um": 3.0},
    {"gap_um": 4.0},
    {"thickness_um": 3.5},
    {"thickness_um": 4.5},
    {"length_um": 470.0},
    {"length_um": 560.0},
    {"residual_stress_MPa": 20.0},
    {"youngs_modulus_GPa": 70.0},
    {"dielectric_nm": 150.0},
    {"dielectric_nm": 300.0},
]
"""What differs from the default device."""
CELLS = 16
SCATTER = (0.0, 0.1)
"""Of the logarithm of the RMS from place to place; its middle counts."""
BRIDGE = DeviceSettings(
    length_um=300.0,
    width_um=100.0,
    thickness_um=1.0,
    gap_um=1.5,
    youngs_modulus_GPa=70.0,
    residual_stress_MPa=40.0,
    dielectric_nm=150.0,
    hold_voltage_V=35.0,
)
"""Of aluminium over nitride."""
SMOOTH_NM = 4.0
"""RMS height of the smoothest films of Table 1; on 8.5 nm the bridge lets go."""


def arguments(parser: ArgumentParser) -> None:
    """None."""


def rows(_: Namespace) -> Iterator[dict[str, Any]]:
    """A row a device, then a row a property that frees the bridge."""
    point, pad, contact = central_of_table_1()
    for changes in OTHERS:
        yield compared(point, pad, contact, changes)
    yield from _freed()


def central_of_table_1(
    device: DeviceSettings | None = None, contact: ContactSettings | None = None
) -> tuple[Point, Pad, ContactSettings]:
    """The central point of the paper's Table 1, its pad, and the contact."""
    if contact is None:
        contact = ContactSettings(mechanics="asperity", pixels=128, attraction="clamped")
    table = film_table(input_table(), {}, SCATTER)
    point = central_point(table, contact, device or DeviceSettings())
    return point, press_pad(point, contact, CELLS, surfaces_of(0)), contact


def compared(
    point: Point, pad: Pad, contact: ContactSettings, changes: Mapping[str, float]
) -> dict[str, Any]:
    """A device on the pad of another, and on a pad of its own."""
    changed = replace(point, device=point.device.model_copy(update=dict(changes)))
    on_other = solved_on(changed, pad)
    assert on_other.states is not None, on_other.refused
    (key,) = changes
    return {
        "what": "device",
        "key": key,
        "value": changes[key],
        "release_V": on_other.states.release_V,
        "pressed_anew_V": _anew_V(changed, contact),
        "error_V": on_other.error_V,
        "continued": on_other.states.deepened,
    }


def _anew_V(point: Point, contact: ContactSettings) -> float | None:
    """Release on a pad that is pressed for the point; None without an answer."""
    try:
        pad = press_pad(point, contact, CELLS, surfaces_of(0))
        return switch_of(point.device).states(pad.curves).release_V
    except InputError:
        return None


def _freed() -> Iterator[dict[str, Any]]:
    air = AirSettings(humidity=0.4)
    contact = ContactSettings(mechanics="coupled", pixels=128, attraction="clamped", air=air)
    point, _, contact = central_of_table_1(BRIDGE, contact)
    point = _with(point, "rms", SMOOTH_NM)
    pad = press_pad(point, contact, CELLS, surfaces_of(0))
    central = solved_on(point, pad)
    if not central.sticks:
        raise InputError(f"the bridge is to stick: {central.outcome}")
    assert central.states is not None
    of_device = freed_by_device(BRIDGE, pad.curves, central.states.pull_in_V)
    of_surface = freed_by_surface(central, contact, CELLS)
    for row in (*of_device, *of_surface):
        for place, share in (("free", 1.0), ("halfway", 0.5)):
            if row["frees"] is None:
                yield {"what": place, "key": row["key"]}
                continue
            value = row["value"] + share * (row["frees"] - row["value"])
            changed = _with(point, row["key"], value)
            release_V = _anew_V(changed, contact)
            yield {"what": place, "key": row["key"], "value": value, "pressed_anew_V": release_V}


def _with(point: Point, key: str, value: float) -> Point:
    """The point with another property of its device, or another input."""
    if key in DeviceSettings.model_fields:
        return replace(point, device=point.device.model_copy(update={key: value}))
    return replace(point, values=point.values | {key: value})


def figures(table: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """The largest difference of a release, and the stated errors."""
    devices = [row for row in table if row["what"] == "device"]
    apart = [abs(float(row["release_V"]) - float(row["pressed_anew_V"])) for row in devices]
    stated = [float(row["error_V"]) for row in devices]
    return {
        "devices": str(len(devices)),
        "most_apart": f"{max(apart):.2g} V",
        "least_error": f"{min(stated):.2g} V",
        "most_error": f"{max(stated):.2g} V",
    }
