"""How hard a switch presses its pad, and so how far the pad is computed.  Imports nothing heavy: rules read it."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mesoscale.device.statistics import analytic_pull_in_V
from mesoscale.device.switch import GPA, NM, VACUUM_PERMITTIVITY, switch_from_settings
from mesoscale.settings import DeviceSettings

CLAMPED = 1.25
"""Square of a clamped beam's pull-in voltage over that of the plate of its mid-span stiffness (70.1 beside 56.9)."""
EDGE = 2.5
"""Local over electrostatic pressure to which pads are computed. The edge of what has landed bears the beam, too: by
1.8 to 1.93, whatever the adhesion, bow or voltage. The rest is for the few pilot cells, whose mean is off by 15 %."""
DEVIATIONS = 1.0
"""Bow (of its deviations) for which draws are computed with that margin; without the margin they last for 2.7."""


@dataclass(frozen=True)
class LargestPressure:
    """Pressure to which a pad is computed at a separation, so that its switch does not press harder.

    Attributes
    ----------
    everywhere_MPa : the same at all separations; None: `EDGE` times the electrostatic pressure.
    voltage_V : with which the switch is held.
    dielectric_nm : thickness of the dielectric over its permittivity.
    """

    everywhere_MPa: float | None
    voltage_V: float
    dielectric_nm: float

    def __call__(self, separation_nm: NDArray[np.float64]) -> NDArray[np.float64]:
        """In GPa, of the shape of the separations."""
        if self.everywhere_MPa is not None:
            return np.full_like(separation_nm, self.everywhere_MPa * 1e-3)
        electric = np.maximum(separation_nm + self.dielectric_nm, 0.5 * self.dielectric_nm + 1.0) * NM
        return EDGE * VACUUM_PERMITTIVITY * self.voltage_V**2 / (2.0 * electric**2) / GPA


def pressure_to_compute(
    settings: DeviceSettings, deviations: float = 0.0, largest_MPa: float | None = None
) -> LargestPressure:
    """Pressure to which the pad of a switch is computed.

    Parameters
    ----------
    deviations : bow to allow for beyond the scene's, in its standard deviations.
    largest_MPa : a pressure to take instead; the switch then does not matter.
    """
    if largest_MPa is not None:
        return LargestPressure(largest_MPa, 0.0, 0.0)
    bow = max(settings.bow_nm, 0.0) + deviations * settings.bow_deviation_nm
    voltage = held_V(settings.model_copy(update={"bow_nm": bow}))
    return LargestPressure(None, voltage, switch_from_settings(settings).dielectric_nm)


def held_V(settings: DeviceSettings) -> float:
    """Voltage with which the switch is held closed: as set, or that of its pull-in without contact."""
    switch = switch_from_settings(settings)
    if settings.hold_voltage_V is not None:
        return settings.hold_voltage_V
    if settings.spring_N_per_m is not None:
        return analytic_pull_in_V(switch)
    return float(np.sqrt(CLAMPED * (1.0 + settings.bow_nm / switch.gap_nm) ** 3)) * analytic_pull_in_V(switch)
