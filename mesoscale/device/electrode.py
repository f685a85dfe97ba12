"""What a switch does on a pad, whichever electrode it has: one that bends, or a plate on a spring."""

import numpy as np
from numpy.typing import NDArray

from mesoscale.device.beam_switch import solve_beam
from mesoscale.device.pad_switch import solve_on_pad
from mesoscale.device.pressing import held_V
from mesoscale.device.statistics import never_closes
from mesoscale.device.switch import switch_from_settings
from mesoscale.errors import InputError, NotComputed
from mesoscale.pad.curves import PadCells
from mesoscale.pad.memory import PadLaw, law_of
from mesoscale.settings import DeviceSettings

ELEMENTS = 64
"""Of the beam: release is within 0.5 % of that of 1024 elements, but near sticking."""
LESS = (0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3)
"""Shares of the voltage that are tried where the held state was not computed."""
RESAMPLES = 24
"""Resampled pads: their standard deviation is known to 15 %."""


def solve_electrode(settings: DeviceSettings, law: PadLaw) -> dict[str, float]:
    """What the switch does on a pad: its bending electrode, or a flat plate where its spring is given.

    Raises
    ------
    InputError : see `solve_beam` and `solve_on_pad`.
    """
    if settings.spring_N_per_m is None:
        beam = solve_beam(settings, law, ELEMENTS)
        return {
            "pull_in_V": beam.pull_in_V,
            "release_V": beam.release_V,
            "capacitance_fF": beam.capacitance_fF,
            "landed_share": beam.landed_share,
        }
    switch = switch_from_settings(settings)
    plate = solve_on_pad(switch, law, settings.hold_voltage_V)
    capacitance = float(switch.capacitance_F(np.array(plate.hold_nm))) * 1e15
    return {
        "pull_in_V": plate.pull_in_V,
        "release_V": plate.release_V,
        "capacitance_fF": capacitance,
        "landed_share": 1.0,
    }


def solve_or_bound(settings: DeviceSettings, law: PadLaw) -> dict[str, float]:
    """As `solve_electrode`; where the held state was not computed, a proof that the switch sticks, if there is one.

    The switch is held by less, so that every place is closed less deeply. The well on opening deepens with the closing,
    so what sticks then sticks when it is held by its own voltage, too. What the bound does not give is NaN.

    Raises
    ------
    InputError : see `solve_electrode`; the hold voltage never closes the switch; the held state was not computed, and
        the bound does not decide.
    """
    state = _held_or_bounded(settings, law)
    if line := never_closes(settings, state["pull_in_V"]):
        raise InputError(line)
    return state


def _held_or_bounded(settings: DeviceSettings, law: PadLaw) -> dict[str, float]:
    try:
        return {**solve_electrode(settings, law), "bounded": 0.0}
    except NotComputed as error:
        for share in LESS:
            less = settings.model_copy(update={"hold_voltage_V": share * held_V(settings)})
            try:
                state = solve_electrode(less, law)
            except NotComputed:
                continue
            except InputError:
                break  # held by less it does not even land
            if state["release_V"] == 0.0:
                return {**state, "capacitance_fF": np.nan, "landed_share": np.nan, "bounded": 1.0}
            break
        raise error


def releases_by_cells(settings: DeviceSettings, cells: PadCells, hamaker: float) -> NDArray[np.float64]:
    """Release voltages (V) on pads of resampled cells, shape (resamples,): what their finite number leaves open.

    Raises
    ------
    InputError : see `solve_or_bound`.
    """
    rng = np.random.default_rng(np.random.SeedSequence([0, 0xCE1]))
    share = np.full(cells.count, 1.0 / cells.count)
    weights = [rng.multinomial(cells.count, share) / cells.count for _ in range(RESAMPLES)]
    return np.array([solve_or_bound(settings, law_of(cells, hamaker, drawn))["release_V"] for drawn in weights])
