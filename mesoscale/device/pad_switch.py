"""The switch on the curves of a pad: pull-in, hold, release, with the memory of the held state.

The force balance is that of `mesoscale.device.switch` with the whole electrode flat on the pad. Nothing is
extrapolated: a held state beyond the computed closing, or an opening from a depth that was not computed, is refused.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from mesoscale.device.switch import GPA, Switch
from mesoscale.errors import InputError, NotComputed
from mesoscale.pad.memory import PadLaw

Array = NDArray[np.float64]

POINTS = 400
"""Separations between the end of the pad's table and the gap at rest that bracket the folds."""


@dataclass(frozen=True)
class PadStates:
    """What the switch does on one pad.

    Attributes
    ----------
    pull_in_V : voltage at which the open switch snaps shut.
    hold_nm : separation while held closed (nm).
    hold_MPa : contact pressure while held closed (MPa).
    release_V : voltage at which the closed switch lets go; 0 where it sticks.
    stuck : whether it stays closed without voltage.
    deepest_net_kPa : largest net adhesive pressure of the pad on opening from the held state (kPa).
    """

    pull_in_V: float
    hold_nm: float
    hold_MPa: float
    release_V: float
    stuck: bool
    deepest_net_kPa: float


def solve_on_pad(switch: Switch, law: PadLaw, hold_voltage_V: float | None) -> PadStates:
    """Close the switch on a pad, hold it, and release it.

    Parameters
    ----------
    hold_voltage_V : voltage of the closed switch; None takes its own pull-in voltage.

    Raises
    ------
    NotComputed : the held state is not on the computed closing curve.
    InputError : the hold voltage does not hold the switch.
    """
    outside = np.geomspace(law.separation_nm[-1], switch.gap_nm, POINTS)[1:]
    grid = np.concatenate([law.separation_nm, outside])
    down = _voltage_squared(switch, grid, law.closing_GPa(grid))
    near = grid <= law.separation_nm[-1]
    # the fold of the way down lies far above the pad, where nothing but the spring acts
    peak = int(np.argmax(np.where(near, -np.inf, down)))
    around = np.linspace(grid[peak - 1], grid[min(peak + 1, grid.size - 1)], POINTS)
    pull_in = float(_voltage_squared(switch, around, law.closing_GPa(around)).max())
    hold = pull_in if hold_voltage_V is None else hold_voltage_V**2
    holds = np.flatnonzero(near & (down >= hold))
    if holds.size == 0:
        raise NotComputed(
            f"device.hold_voltage_V: {np.sqrt(hold):.4g} V presses the pad harder than the computed "
            f"{law.closing_GPa(law.separation_nm[0]) * 1e3:.3g} MPa"
        )
    inner = int(holds[-1])
    if inner + 1 == near.sum():
        raise InputError(
            f"device.hold_voltage_V = {np.sqrt(hold):.4g}: too little to keep the switch on the pad (pull-in is at "
            f"{np.sqrt(pull_in):.4g} V); raise it"
        )
    held = brentq(lambda s: _voltage_squared(switch, s, law.closing_GPa(s)) - hold, grid[inner], grid[inner + 1])
    hold_nm = float(np.asarray(held))
    way_up = np.concatenate([[hold_nm], grid[grid > hold_nm]])
    net = law.opening_GPa(way_up, hold_nm)
    up = _voltage_squared(switch, way_up, net)
    # release is the lowest point before the barrier, the fold that the way down met, too
    barrier = int(np.argmax(np.where(way_up > law.separation_nm[-1], up, -np.inf)))
    release = float(up[: barrier + 1].min())
    return PadStates(
        float(np.sqrt(max(pull_in, 0.0))),  # 0: the pad pulls it shut by itself
        hold_nm,
        float(law.closing_GPa(hold_nm)) * 1e3,
        float(np.sqrt(max(release, 0.0))),
        release <= 0.0,
        -float(net.min()) * 1e6,
    )


def _voltage_squared(switch: Switch, separation_nm: Array, pressure_GPa: Array) -> Array:
    force = switch.spring_force_N(separation_nm) + switch.area_m2 * pressure_GPa * GPA
    return switch.balancing_V2(separation_nm, force)
