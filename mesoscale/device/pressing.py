"""How hard a switch presses its pad, and so how far the pad is computed.  Imports nothing heavy: rules read it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mesoscale.device.statistics import analytic_pull_in_V
from mesoscale.device.switch import GPA, NM, VACUUM_PERMITTIVITY, switch_from_settings
from mesoscale.settings import DeviceSettings
from mesoscale.settings.device import LARGEST_BOW_NM

CLAMPED = 1.25
"""Square of a clamped beam's pull-in voltage over that of the plate of its mid-span stiffness (70.1 beside 56.9)."""
EDGE = 2.5
"""Local over electrostatic pressure to which pads are computed at least. The edge of what has landed bears the beam,
too, and presses with 1.6 to 2.3 of it on pads of Table 1."""
DEVIATIONS = 1.0
"""Bow (of its deviations) for which draws are computed; points that press harder use the closed form beyond."""


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


def pressing(settings: DeviceSettings, deviations: float = 0.0) -> DeviceSettings:
    """The switch that a pad is computed for, without what does not press.

    Parameters
    ----------
    deviations : bow to allow for beyond the scene's, in its standard deviations.
    """
    bow = max(settings.bow_nm, 0.0) + deviations * settings.bow_deviation_nm
    rest = {"tilt_nm": 0.0, "bow_deviation_nm": 0.0, "tilt_deviation_nm": 0.0, "adhesion_scale": 1.0}
    return settings.model_copy(update={"bow_nm": min(bow, LARGEST_BOW_NM), **rest})


def pressure_to_compute(settings: DeviceSettings) -> LargestPressure:
    """Least pressure to which the pad of a switch is computed."""
    return LargestPressure(held_V(settings), switch_from_settings(settings).dielectric_nm)


def held_V(settings: DeviceSettings) -> float:
    """Voltage with which the switch is held closed: as set, or that of its pull-in without contact."""
    switch = switch_from_settings(settings)
    if settings.hold_voltage_V is not None:
        return settings.hold_voltage_V
    if settings.spring_N_per_m is not None:
        return analytic_pull_in_V(switch)
    return float(np.sqrt(CLAMPED * (1.0 + settings.bow_nm / switch.gap_nm) ** 3)) * analytic_pull_in_V(switch)
