"""A switch whose electrode has crept while it was held closed.

Its strain hardly changes then, and its stress falls. Let it have lost a share. That share of the
bending and stretching of the hold needs no stress any more, in a material that is linear: the
electrode rests where it was drawn to, in part, and pulls back by less. It moves fast, and elastic,
from there on.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mesoscale.errors import InputError
from mesoscale.pad.curves import PadCurves, on_deep_enough
from mesoscale.settings import DeviceSettings
from mesoscale.switch.switch import Switch

Array = NDArray[np.float64]


@dataclass(frozen=True)
class HeldShape:
    """The shape of a held electrode.

    Attributes
    ----------
    nodal : height (m) and slope of a beam over its rest, shape (nodes, 2); None of a plate.
    separation_nm : mean separation.
    strain : largest strain by the hold; 0 of a plate, whose spring nobody knows.
    """

    nodal: Array | None
    separation_nm: float
    strain: float


def held_shape(device: DeviceSettings, pad: PadCurves) -> HeldShape:
    """The shape of a switch without even charge, while its voltage holds it.

    Raises
    ------
    InputError : see `Switch.states`.
    """
    if device.kind == "plate":
        from mesoscale.switch.plate import PlateSwitch

        plate = PlateSwitch(device)
        (separations, _), _ = on_deep_enough(pad, plate.held_nm)
        return HeldShape(None, float(separations[0]), 0.0)
    from mesoscale.switch.beam_switch import BeamSwitch

    switch = BeamSwitch(device)
    moving, _ = on_deep_enough(pad, switch.held)
    bent, stretched = switch.beam.strains(moving.nodal)
    largest = float(np.abs(bent).max()) * 0.5e-6 * device.thickness_um + abs(stretched)
    return HeldShape(moving.nodal, float(moving.separation_nm().mean()), largest)


def crept_switch(device: DeviceSettings, held: HeldShape, share: float, pad: PadCurves) -> Switch:
    """The switch after its held electrode has lost a share of its stress.

    Parameters
    ----------
    device : without even charge, with the voltage that holds it.

    Raises
    ------
    InputError : it rests on what it lands on.
    """
    if held.nodal is None:
        from mesoscale.switch.plate import PlateSwitch

        plate = PlateSwitch(device)
        rest_nm = plate.plate.gap_nm - share * (plate.plate.gap_nm - held.separation_nm)
        if rest_nm <= pad.separation_nm[-1]:
            raise InputError(f"lifetime.ageing: the plate has crept down to {rest_nm:.4g} nm")
        plate.plate = replace(plate.plate, gap_nm=rest_nm)
        return plate
    from mesoscale.switch.beam import beam_of, crept
    from mesoscale.switch.beam_switch import BeamSwitch

    return BeamSwitch(device, crept(beam_of(device), held.nodal, share))


def crept_voltages(
    device: DeviceSettings, held: HeldShape, share: float, pad: PadCurves
) -> tuple[float, float]:
    """Pull-in and release (V) after creep; both 0 where it stays closed by itself.

    So it does where it rests on its pad, and where it rests so near that it touches at a voltage
    below that at which it lets go: nothing is left to open.
    """
    try:
        states = crept_switch(device, held, share, pad).states(pad)
    except InputError:
        return 0.0, 0.0
    if states.touches and states.release_V > states.pull_in_V:
        return 0.0, 0.0
    return states.pull_in_V, states.release_V
