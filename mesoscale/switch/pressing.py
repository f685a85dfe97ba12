"""How hard a switch presses its pad, and so how far the pad is computed.  Imports nothing heavy:
rules read it.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from mesoscale.settings import DeviceSettings
from mesoscale.settings.device import SPREAD, SpreadSettings
from mesoscale.switch.numerics import SWITCH
from mesoscale.switch.plate import GPA, NM, VACUUM_PERMITTIVITY, plate_from_settings

Array = NDArray[np.float64]
EXACT = SpreadSettings(**dict.fromkeys(SPREAD))


def pressing(settings: DeviceSettings) -> DeviceSettings:
    """The switch that a pad is computed for, without what does not press."""
    return settings.model_copy(update={"tilt_nm": 0.0, "spread": EXACT})


def pressure_to_compute(settings: DeviceSettings) -> Callable[[Array], Array]:
    """Least pressure (GPa) to which the pad of a switch is computed, as a function of the
    separations (nm).

    Raises
    ------
    InputError : see `held_V`.
    """
    voltage_V, dielectric_nm = held_V(settings), plate_from_settings(settings).dielectric_nm

    def least_GPa(separation_nm: Array) -> Array:
        electric = np.maximum(separation_nm + dielectric_nm, 0.5 * dielectric_nm + 1.0) * NM
        return SWITCH.edge * VACUUM_PERMITTIVITY * voltage_V**2 / (2.0 * electric**2) / GPA

    return least_GPa


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
        return plate_from_settings(settings).pull_in_V
    from mesoscale.switch.beam_switch import free_pull_in_V  # compiles: not for rules

    return free_pull_in_V(settings)


def never_closes(settings: DeviceSettings, pull_in_V: float) -> str:
    """One line on a hold voltage below pull-in, which never closes the switch; empty where there is
    none.

    A switch that is closed by more and then held by less has the deepest closing, and so the
    release, of the former."""
    hold = settings.hold_voltage_V
    if hold is None or hold >= (1.0 - SWITCH.pull_in_error) * pull_in_V:
        return ""
    return (
        f"device.hold_voltage_V = {hold:.4g}: never closes this switch, which pulls in at"
        f" {pull_in_V:.4g} V; give the largest voltage that it is closed with, or null for pull-in"
        " itself"
    )
