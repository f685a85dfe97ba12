"""What a pad and an answer ask of a switch, whichever electrode it has."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mesoscale.errors import InputError
from mesoscale.pad.curves import PadCurves, attracting, on_deep_enough
from mesoscale.settings import DeviceSettings
from mesoscale.units import GPA, NM, VACUUM_PERMITTIVITY

if TYPE_CHECKING:  # pilots compile, and who reads the states of a switch needs none
    from mesoscale.pad.pilots import Pilots

Array = NDArray[np.float64]

EDGE = 2.5
"""Pressure over that of the voltage alone to which pads are computed at least. The edge of what has
landed bears the electrode, too, and presses with 1.6 to 2.3 of it on pads of Table 1."""
MARGIN = 1.25
"""Over what a switch presses with: the mean of the few pilot cells of a pad is off by 15 %."""
PULL_IN_ERROR = 1e-3
"""Relative error of a pull-in by the number of elements."""
NEVER_CLOSES = "never closes this switch"
"""In the reason of a switch that its hold voltage never closes."""


@dataclass(frozen=True)
class States:
    """What a switch does on one pad.

    Attributes
    ----------
    pull_in_V : voltage at which the open switch snaps shut, or touches where that comes first.
    release_V : voltage at which the closed switch lets go, or has lost the share of its capacitance
        that `device.release_at` states; 0 where it does not.
    capacitance_fF : while held closed.
    deepened : whether the pad was pressed harder than it was computed, so that its curves were
        continued.
    touches : whether it touches the pad, or what stands beside it, before it would snap. It is then
        pressed by what the hold voltage exceeds `pull_in_V` by.
    """

    pull_in_V: float
    release_V: float
    capacitance_fF: float
    deepened: bool = False
    touches: bool = False

    @property
    def numbers(self) -> dict[str, float]:
        """What result files state of it; `touches` only of a switch that does."""
        stated = {
            "pull_in_V": self.pull_in_V,
            "release_V": self.release_V,
            "capacitance_fF": self.capacitance_fF,
            "deepened": float(self.deepened),
        }
        if self.touches:
            stated["touches"] = 1.0
        return stated


class Switch(ABC):
    """A switch of some settings; each kind fills in what is abstract here.

    Raises
    ------
    InputError : settings of a switch that touches what it lands on at rest.
    """

    def __init__(self, settings: DeviceSettings) -> None:
        self.settings = settings

    @classmethod
    def from_settings(cls, settings: DeviceSettings, coarse: bool) -> "Switch":
        """The switch of these settings.

        Parameters
        ----------
        coarse : with half as many elements, if it has any.
        """
        return cls(settings)

    @property
    @abstractmethod
    def pull_in_V(self) -> float:
        """Pull-in without a pad.

        Raises
        ------
        InputError : no voltage pulls it in.
        """

    @property
    def never_closes(self) -> str:
        """One line on a hold voltage that never closes it on any pad; else empty.

        Raises
        ------
        InputError : see `pull_in_V`.
        """
        return never_closes(self.settings, self.pull_in_V)

    @abstractmethod
    def pressed_GPa(self, pad: PadCurves) -> float:
        """Largest net pressure with which it presses a pad on the way to its held state."""

    def carried_by(self, pilots: "Pilots") -> bool:
        """Whether some cells of a pad, closed as far as they are, carry it."""
        least_GPa = float(self.least_GPa(pilots.separation_nm))
        if not pilots.repel(least_GPa):
            return False
        return pilots.carry(MARGIN * self.pressed_GPa(pilots.curves))

    @abstractmethod
    def states_on(self, pad: PadCurves) -> States:
        """Close it on a pad, hold it, and let it go.

        Raises
        ------
        NotComputed : it presses harder than the pad was computed.
        InputError : it never lands, or is not held.
        """

    @abstractmethod
    def held_nm(self, pad: PadCurves) -> tuple[Array, Array]:
        """Separations of the places of the held electrode, and their shares of its pull.

        Raises
        ------
        NotComputed, InputError : see `states_on`.
        """

    def states(self, pad: PadCurves) -> States:
        """`states_on` a pad that is continued as far as the switch presses it.

        Raises
        ------
        InputError : see `states_on`; the hold voltage never closes the switch.
        """
        states, continued = on_deep_enough(pad, self.states_on)
        if line := never_closes(self.settings, states.pull_in_V, states.touches):
            raise InputError(line)
        return replace(states, deepened=continued is not pad)

    def closed_on(self, pad: PadCurves, quickly: bool = False) -> Callable[[float, float], bool]:
        """Whether the closed switch is still closed at a voltage, with so many times the attraction
        of the pad; a function of both.

        Parameters
        ----------
        quickly : in longer steps, where a switch is moved in steps.

        Raises
        ------
        InputError : see `states_on`; the function raises the same.
        """

        def still_closed(voltage: float, times: float) -> bool:
            release_V = self.states_on(attracting(pad, times)).release_V
            return release_V == 0.0 or release_V < voltage

        return still_closed

    @cached_property
    def hold_V(self) -> float:
        """Voltage that holds it closed: as set, or that of its pull-in without a pad.

        Raises
        ------
        InputError : see `pull_in_V`.
        """
        return self.settings.hold_voltage_V or self.pull_in_V

    @property
    def held_share(self) -> float:
        """Share of the held capacitance below which the switch counts as released."""
        share = self.settings.release_at
        return 0.0 if share == "jump" else share

    def least_GPa(self, separation_nm: Array | float) -> Array:
        """Pressure to which its pad is computed at least, at separations of any shape.

        Raises
        ------
        InputError : see `pull_in_V`.
        """
        dielectric_nm = self.settings.dielectric_gap_nm
        gap_m = np.maximum(separation_nm + dielectric_nm, 0.5 * dielectric_nm + 1.0) * NM
        return EDGE * VACUUM_PERMITTIVITY * self.hold_V**2 / (2.0 * gap_m * gap_m) / GPA


def never_closes(settings: DeviceSettings, pull_in_V: float, touches: bool = False) -> str:
    """One line on a hold voltage below pull-in, which never closes the switch; else empty.

    A switch that is closed by more and then held by less has the deepest closing, and so the
    release, of the former.

    Parameters
    ----------
    touches : whether it touches at this voltage before it would snap, and so must be held by more.
    """
    hold_V = settings.hold_voltage_V
    if hold_V is None:
        if not touches:
            return ""
        return (
            f"device.hold_voltage_V: null holds the beam with {pull_in_V:.4g} V, at which it"
            " touches before it would snap and is not pressed; raise hold_voltage_V above that, or"
            " place electrode nearer to contact"
        )
    if hold_V >= (1.0 - PULL_IN_ERROR) * pull_in_V:
        return ""
    closes = "touches" if touches else "pulls in"
    return (
        f"device.hold_voltage_V = {hold_V:.4g}: {NEVER_CLOSES}, which {closes} at"
        f" {pull_in_V:.4g} V; give the largest voltage that it is closed with, or null for pull-in"
        " itself"
    )
