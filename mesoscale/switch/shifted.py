"""A switch whose even charge shifts its voltage: solved as it feels the voltage, told as it is
driven.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mesoscale.errors import InputError
from mesoscale.pad.curves import PadCurves
from mesoscale.settings import DeviceSettings
from mesoscale.settings.device import EVEN_CHARGE
from mesoscale.switch.switch import NEVER_CLOSES, States, Switch

Array = NDArray[np.float64]


def as_felt(settings: DeviceSettings, shift_V: float) -> DeviceSettings:
    """The device without its even charge, held with what it feels.

    Raises
    ------
    InputError : its charge takes more than the hold voltage away.
    """
    felt: dict[str, float | None] = dict.fromkeys(EVEN_CHARGE, 0.0)
    if settings.hold_voltage_V is not None:
        felt["hold_voltage_V"] = settings.hold_voltage_V - shift_V
        if settings.hold_voltage_V <= shift_V:
            raise InputError(
                f"device.hold_voltage_V = {settings.hold_voltage_V:.4g}: {NEVER_CLOSES}, whose even"
                f" charge shifts its voltage by {shift_V:.4g} V; raise it, or drive with the other"
                " polarity (the opposite signs of shift_V and charge_e_cm2)"
            )
    return settings.model_copy(update=felt)


def as_driven(pull_in_V: float, release_V: float, shift_V: float) -> tuple[float, float]:
    """Drives at which a switch closes and lets go that feels these voltages.

    Both are 0 where charge alone closes it.
    """
    if abs(shift_V) >= pull_in_V:
        return 0.0, 0.0
    driven_V = 0.0
    if release_V > 0.0:
        driven_V = max(release_V + shift_V, 0.0)
    return pull_in_V + shift_V, driven_V


class ShiftedSwitch(Switch):
    """A switch that feels V - `shift_V` of a drive V, which is positive.

    Its charge alone closes it where the shift exceeds pull-in: then it sticks. Where a drive of the
    other polarity would free it, it counts as stuck, too.

    Parameters
    ----------
    felt : the switch of `as_felt`.
    """

    def __init__(self, settings: DeviceSettings, felt: Switch, shift_V: float) -> None:
        super().__init__(settings)
        self.felt = felt
        self.shift_V = shift_V

    @property
    def pull_in_V(self) -> float:
        """Pull-in of the drive without a pad; 0 where charge alone closes it."""
        with self._told():
            return as_driven(self.felt.pull_in_V, 0.0, self.shift_V)[0]

    @property
    def never_closes(self) -> str:
        """See `Switch.never_closes`."""
        line = self.felt.never_closes
        return f"{line}{self._remark}" if line else ""

    def pressed_GPa(self, pad: PadCurves) -> float:
        """See `Switch.pressed_GPa`."""
        return self.felt.pressed_GPa(pad)

    def least_GPa(self, separation_nm: Array | float) -> Array:
        """See `Switch.least_GPa`."""
        return self.felt.least_GPa(separation_nm)

    def states_on(self, pad: PadCurves) -> States:
        """See `Switch.states_on`; the remaining states are as of the voltage that is felt."""
        with self._told():
            states = self.felt.states_on(pad)
        pull_in_V, release_V = as_driven(states.pull_in_V, states.release_V, self.shift_V)
        return replace(states, pull_in_V=pull_in_V, release_V=release_V)

    def held_nm(self, pad: PadCurves) -> tuple[Array, Array]:
        """See `Switch.held_nm`."""
        return self.felt.held_nm(pad)

    def closed_on(self, pad: PadCurves, quickly: bool = False) -> Callable[[float, float], bool]:
        """See `Switch.closed_on`."""
        with self._told():
            closed = self.felt.closed_on(pad, quickly)
            by_charge = abs(self.shift_V) >= self.felt.pull_in_V

        def still_closed(voltage: float, times: float) -> bool:
            # lowered beyond the shift, it has felt nothing on the way
            return by_charge or closed(max(voltage - self.shift_V, 0.0), times)

        return still_closed

    @property
    def _remark(self) -> str:
        return f" (as felt: charge takes {self.shift_V:.4g} V off each voltage)"

    @contextmanager
    def _told(self) -> Iterator[None]:
        """Reasons speak of voltages as felt, and say so."""
        try:
            yield
        except InputError as error:
            raise type(error)(f"{error}{self._remark}") from None
