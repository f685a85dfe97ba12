"""A switch on a pad: a bending beam or a plate on a spring, how it closes and how it lets go."""

import numpy as np

from mesoscale.errors import InputError
from mesoscale.pad.curves import PadCurves
from mesoscale.settings import DeviceSettings
from mesoscale.switch.charge import shift_V
from mesoscale.switch.shifted import ShiftedSwitch, as_felt
from mesoscale.switch.switch import States, Switch

__all__ = ["States", "Switch", "release_or_nan_V", "switch_of"]


def switch_of(settings: DeviceSettings, coarse: bool = False) -> Switch:
    """The switch that the settings describe.

    Parameters
    ----------
    coarse : with half as many elements, where switches are only compared with each other.

    Raises
    ------
    InputError : it touches what it lands on at rest, or its charge takes its hold voltage away.
    """
    kind = _kind_of(settings)
    shift = shift_V(settings)
    if shift == 0.0:
        return kind.from_settings(settings, coarse)
    felt = kind.from_settings(as_felt(settings, shift), coarse)
    return ShiftedSwitch(settings, felt, shift)


def _kind_of(settings: DeviceSettings) -> type[Switch]:
    """The class of a switch. That of a beam compiles when it is imported."""
    if settings.kind == "plate":
        from mesoscale.switch.plate import PlateSwitch

        return PlateSwitch
    from mesoscale.switch.beam_switch import BeamSwitch

    return BeamSwitch


def release_or_nan_V(settings: DeviceSettings, pad: PadCurves, coarse: bool = False) -> float:
    """Release on a pad (V; 0: it sticks); NaN where the switch has no answer."""
    try:
        return switch_of(settings, coarse).states(pad).release_V
    except InputError:
        return np.nan
