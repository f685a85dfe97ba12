"""How hard a switch presses its pad, and so how far the pad is computed.  Imports nothing heavy: rules read it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mesoscale.device.statistics import analytic_pull_in_V
from mesoscale.device.switch import GPA, NM, VACUUM_PERMITTIVITY, switch_from_settings
from mesoscale.settings import DeviceSettings
from mesoscale.settings.device import SPREAD, SpreadSettings

EDGE = 2.5
"""Local over electrostatic pressure to which pads are computed at least. The edge of what has landed bears the beam,
too, and presses with 1.6 to 2.3 of it on pads of Table 1."""
EXACT = SpreadSettings(**dict.fromkeys(SPREAD))


@dataclass(frozen=True)
class LargestPressure:
    """Least pressure to which the pad of a switch is computed at a separation.

    Attributes
    ----------
    voltage_V : with which the switch is held.
    dielectric_nm : thickness of the dielectric over its permittivity.
    """

    voltage_V: float
    dielectric_nm: float

    def __call__(self, separation_nm: NDArray[np.float64]) -> NDArray[np.float64]:
        """In GPa, of the shape of the separations."""
        electric = np.maximum(separation_nm + self.dielectric_nm, 0.5 * self.dielectric_nm + 1.0) * NM
        return EDGE * VACUUM_PERMITTIVITY * self.voltage_V**2 / (2.0 * electric**2) / GPA


def pressing(settings: DeviceSettings) -> DeviceSettings:
    """The switch that a pad is computed for, without what does not press."""
    return settings.model_copy(update={"tilt_nm": 0.0, "adhesion_scale": 1.0, "spread": EXACT})


def pressure_to_compute(settings: DeviceSettings) -> LargestPressure:
    """Least pressure to which the pad of a switch is computed.

    Raises
    ------
    InputError : see `held_V`.
    """
    return LargestPressure(held_V(settings), switch_from_settings(settings).dielectric_nm)


def held_V(settings: DeviceSettings) -> float:
    """Voltage with which the switch is held closed: as set, or that of its pull-in without contact.

    Raises
    ------
    InputError : see `pull_in_V`.
    """
    return settings.hold_voltage_V or pull_in_V(settings)


def pull_in_V(settings: DeviceSettings) -> float:
    """Pull-in of the switch without contact.

    Raises
    ------
    InputError : a beam that does not pull in, or that stands on the dielectric.
    """
    if not settings.bends:
        return analytic_pull_in_V(switch_from_settings(settings))
    from mesoscale.device.beam_switch import free_pull_in_V  # compiles: not for rules

    return free_pull_in_V(settings)
