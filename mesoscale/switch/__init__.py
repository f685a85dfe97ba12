"""A switch on a pad: a bending beam or a plate on a spring, how it closes and how it lets go."""

import numpy as np

from mesoscale.errors import InputError
from mesoscale.pad.curves import PadCurves
from mesoscale.settings import DeviceSettings
from mesoscale.switch.switch import States, Switch, never_closes

__all__ = ["States", "Switch", "never_closes", "release_or_nan_V", "switch_of"]


def switch_of(settings: DeviceSettings, coarse: bool = False) -> Switch:
    """The switch that the settings describe.

    Parameters
    ----------
    coarse : with half as many elements, where switches are only compared with each other.

    Raises
    ------
    InputError : it touches what it lands on at rest.
    """
    if settings.kind == "plate":
        from mesoscale.switch.plate import PlateSwitch

        return PlateSwitch(settings)
    from mesoscale.switch.beam import COARSE_ELEMENTS, ELEMENTS, beam_of  # compiles
    from mesoscale.switch.beam_switch import BeamSwitch

    elements = COARSE_ELEMENTS if coarse else ELEMENTS
    return BeamSwitch(settings, beam_of(settings, elements))


def release_or_nan_V(settings: DeviceSettings, pad: PadCurves, coarse: bool = False) -> float:
    """Release on a pad (V; 0: it sticks); NaN where the switch has no answer."""
    try:
        return switch_of(settings, coarse).states(pad).release_V
    except InputError:
        return np.nan
