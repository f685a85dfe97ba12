"""What a switch does on a pad, whichever electrode it has: one that bends, or a plate on a
spring.
"""

from collections.abc import Callable
from contextlib import suppress
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from mesoscale.errors import InputError, NotComputed
from mesoscale.pad.memory import Flats, PadLaw, deepened
from mesoscale.settings import DeviceSettings
from mesoscale.switch.beam_switch import press_GPa, solve_beam
from mesoscale.switch.numerics import SWITCH
from mesoscale.switch.plate import plate_from_settings, solve_on_pad
from mesoscale.switch.pressing import never_closes

T = TypeVar("T")


def solve_electrode(
    settings: DeviceSettings, law: PadLaw, elements: int = SWITCH.elements
) -> dict[str, float]:
    """What the switch does on a pad: its bending electrode of so many elements, or a flat plate on
    a given spring.

    Raises
    ------
    InputError : see `solve_beam` and `solve_on_pad`.
    """
    if settings.bends:
        beam = solve_beam(settings, law, elements)
        return {
            "pull_in_V": beam.pull_in_V,
            "release_V": beam.release_V,
            "capacitance_fF": beam.capacitance_fF,
        }
    switch = plate_from_settings(settings)
    plate = solve_on_pad(switch, law, settings.hold_voltage_V)
    capacitance = float(switch.capacitance_F(np.array(plate.hold_nm))) * 1e15
    return {
        "pull_in_V": plate.pull_in_V,
        "release_V": plate.release_V,
        "capacitance_fF": capacitance,
    }


def solve_deepened(
    settings: DeviceSettings, law: PadLaw, elements: int = SWITCH.elements
) -> dict[str, float]:
    """As `solve_electrode`; a pad that the switch presses harder than it was computed is continued
    (`deepened` is 1).

    Raises
    ------
    InputError : see `solve_electrode`; the hold voltage never closes the switch.
    NotComputed : it presses more than `2 ** SWITCH.deepened_by` times as hard as the pad was
        computed."""
    state, pad = with_pad(lambda pad: solve_electrode(settings, pad, elements), law)
    if line := never_closes(settings, state["pull_in_V"]):
        raise InputError(line)
    return {**state, "deepened": float(pad is not law)}


def release_or_nan_V(
    settings: DeviceSettings, law: PadLaw, elements: int = SWITCH.elements
) -> float:
    """Release on a pad (V; 0: it sticks); NaN where the switch has no answer."""
    try:
        return solve_deepened(settings, law, elements)["release_V"]
    except InputError:
        return np.nan


def with_pad(solve: Callable[[PadLaw], T], law: PadLaw) -> tuple[T, PadLaw]:
    """What `solve` says of a pad that is continued as far as the switch presses it, and this pad.

    Raises
    ------
    NotComputed : it presses more than `2 ** SWITCH.deepened_by` times as hard as the pad was
        computed."""
    for _ in range(SWITCH.deepened_by):
        try:
            return solve(law), law
        except NotComputed:
            law = deepened(law)
    return solve(law), law


def presser(
    settings: DeviceSettings,
) -> Callable[[NDArray[np.float64], NDArray[np.float64]], float]:
    """Largest net pressure (GPa) of the switch on a pad, from the closing curve of the pad.

    The function takes separations (nm), from near to far, and net pressures (GPa), of shape (n,).
    It gives 0 for a pad that is closed so near to its mean plane that nothing deeper can be
    planned; the switch's answer has the reason."""

    def pressed_GPa(separation_nm: NDArray[np.float64], net_GPa: NDArray[np.float64]) -> float:
        if not settings.bends:
            return 0.0  # a plate presses with less than its voltage alone
        closing = np.stack([np.maximum(net_GPa, 0.0), np.minimum(net_GPa, 0.0)])
        law = PadLaw(separation_nm, closing, separation_nm[:1], closing[None], Flats(0.0, 0.0))
        with suppress(
            NotComputed
        ):  # closed nearly to its mean plane: it is continued as far as that goes
            for _ in range(SWITCH.deepened_by):
                law = deepened(law)
        try:
            return press_GPa(settings, law)
        except NotComputed:
            deepest = law.separation_nm[0]
            return float(law.closing_GPa(deepest)) if deepest < separation_nm[0] else 0.0
        except InputError:
            return 0.0  # a switch that does not pull in presses nothing; its answer has the reason

    return pressed_GPa
