"""A switch as a plate on a spring above a dielectric.

The plate at mean separation s from the dielectric is in balance when

    F(s) = eps0 A (V^2 + U^2) / (2 (s + t/eps)^2)

with F the force that opens it: that of its spring, k (g - s), and that of the pad, on which it lies
flat; U^2 is that of uneven charge (`mesoscale.switch.charge`). V^2 is then a single-valued function
of s. A state is stable where it falls with s; where it turns are pull-in and release. Nothing is
extrapolated: a held state beyond the computed closing, or an opening from a depth that was not
computed, is refused.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq

from mesoscale.errors import InputError, NotComputed
from mesoscale.pad.curves import PadCurves
from mesoscale.settings import DeviceSettings
from mesoscale.switch.charge import uneven_V2
from mesoscale.switch.switch import States, Switch
from mesoscale.units import GPA, NM, VACUUM_PERMITTIVITY

Array = NDArray[np.float64]

FOLD_POINTS = 400
"""Separations between the end of the pad's table and the gap at rest that bracket the folds."""

PULL_IN_POINTS = 4001
"""Separations of the way of a plate over uneven charge."""


@dataclass(frozen=True)
class Plate:
    """A plate on a spring.

    Attributes
    ----------
    spring_N_per_m : stiffness k against a uniform load.
    gap_nm : separation g at rest.
    area_m2 : electrode area A.
    dielectric_nm : thickness t divided by the relative permittivity.
    uneven_V2 : what uneven charge adds to the square of the voltage at separations.
    """

    spring_N_per_m: float
    gap_nm: float
    area_m2: float
    dielectric_nm: float
    uneven_V2: Callable[[ArrayLike], Array] = np.zeros_like

    def spring_force_N(self, separation_nm: ArrayLike) -> Array:
        """Force of the spring, which opens the switch."""
        return self.spring_N_per_m * (self.gap_nm - np.asarray(separation_nm)) * NM

    def balancing_V2(self, separation_nm: ArrayLike, opening_force_N: Array) -> Array:
        """Square of the voltage (V^2) whose attraction balances a force that opens the switch."""
        electric_gap = (np.asarray(separation_nm) + self.dielectric_nm) * NM
        factor = 2 * electric_gap**2 / (VACUUM_PERMITTIVITY * self.area_m2)
        return factor * opening_force_N

    def capacitance_F(self, separation_nm: ArrayLike) -> Array:
        """Parallel-plate capacitance at a mean separation."""
        electric_gap = (np.asarray(separation_nm) + self.dielectric_nm) * NM
        return VACUUM_PERMITTIVITY * self.area_m2 / electric_gap

    @property
    def pull_in_V(self) -> float:
        """Pull-in without contact: sqrt(8 k (g + t/eps)^3 / (27 eps0 A))."""
        gap = (self.gap_nm + self.dielectric_nm) * NM
        return float(
            np.sqrt(8 * self.spring_N_per_m * gap**3 / (27 * VACUUM_PERMITTIVITY * self.area_m2))
        )


@dataclass(frozen=True)
class PlateStates(States):
    """What the plate does on one pad.

    Attributes
    ----------
    hold_nm : separation while held closed (nm).
    """

    hold_nm: float = np.nan


class PlateSwitch(Switch):
    """A plate on a spring, which comes down flat on its pad."""

    def __init__(self, settings: DeviceSettings) -> None:
        super().__init__(settings)
        assert settings.spring_N_per_m is not None
        self.plate = Plate(
            spring_N_per_m=settings.spring_N_per_m,
            gap_nm=settings.gap_um * 1e3,
            area_m2=settings.area_um2 * 1e-12,
            dielectric_nm=settings.dielectric_gap_nm,
        )
        if settings.uneven is not None:
            self.plate = replace(self.plate, uneven_V2=partial(uneven_V2, settings))

    @property
    def pull_in_V(self) -> float:
        """Pull-in without a pad; 0 where uneven charge alone closes it."""
        if self.settings.uneven is None:
            return self.plate.pull_in_V
        way_nm = np.linspace(0.0, self.plate.gap_nm, PULL_IN_POINTS)
        return _volts(float(_balancing_V2(self.plate, way_nm, np.zeros_like(way_nm)).max()))

    def pressed_GPa(self, pad: PadCurves) -> float:
        """Nothing on top of its voltage, which alone presses with more."""
        return 0.0

    def states_on(self, pad: PadCurves) -> PlateStates:
        """Close the plate on a pad, hold it, and release it.

        Raises
        ------
        NotComputed : the held state is not on the computed closing curve.
        InputError : the hold voltage does not hold the plate.
        """
        return closed_on_pad(self.plate, pad, self.settings.hold_voltage_V, self.held_share)

    def held_nm(self, pad: PadCurves) -> tuple[Array, Array]:
        """See `Switch.held_nm`; it lies flat."""
        return np.array([self.states_on(pad).hold_nm]), np.ones(1)


def closed_on_pad(
    plate: Plate, pad: PadCurves, hold_voltage_V: float | None, held_share: float = 0.0
) -> PlateStates:
    """Close a plate on a pad, hold it, and release it.

    Parameters
    ----------
    hold_voltage_V : voltage of the closed switch; None takes its own pull-in voltage.
    held_share : of the held capacitance, below which it counts as released.

    Raises
    ------
    NotComputed : the held state is not on the computed closing curve.
    InputError : the hold voltage does not hold the plate.
    """
    outside = np.geomspace(pad.separation_nm[-1], plate.gap_nm, FOLD_POINTS)[1:]
    grid = np.concatenate([pad.separation_nm, outside])
    near = grid <= pad.separation_nm[-1]
    down_V2 = _balancing_V2(plate, grid, pad.closing_GPa(grid))
    pull_in_V2 = _pull_in_V2(plate, pad, grid, down_V2, near)
    hold_V2 = pull_in_V2 if hold_voltage_V is None else hold_voltage_V**2
    holds = np.flatnonzero(near & (down_V2 >= hold_V2))
    if holds.size == 0:
        raise NotComputed(
            f"device.hold_voltage_V: {np.sqrt(hold_V2):.4g} V presses the pad harder than the"
            f" computed {pad.closing_GPa(pad.separation_nm[0]) * 1e3:.3g} MPa"
        )
    inner = int(holds[-1])
    if inner + 1 == near.sum():
        raise InputError(
            f"device.hold_voltage_V = {np.sqrt(hold_V2):.4g}: too little to keep the switch on the"
            f" pad (pull-in is at {np.sqrt(pull_in_V2):.4g} V); raise it"
        )

    def missing_V2(separation_nm: float) -> Array:
        return _balancing_V2(plate, separation_nm, pad.closing_GPa(separation_nm)) - hold_V2

    held = brentq(missing_V2, grid[inner], grid[inner + 1])
    hold_nm = float(np.asarray(held))
    farthest_nm = np.inf
    if held_share > 0.0:
        farthest_nm = (hold_nm + plate.dielectric_nm) / held_share - plate.dielectric_nm
    release_V2 = _release_V2(plate, pad, grid, hold_nm, farthest_nm)
    return PlateStates(
        pull_in_V=_volts(pull_in_V2),
        release_V=_volts(release_V2),
        capacitance_fF=float(plate.capacitance_F(hold_nm)) * 1e15,
        hold_nm=hold_nm,
    )


def _pull_in_V2(
    plate: Plate, pad: PadCurves, grid: Array, down_V2: Array, near: NDArray[np.bool_]
) -> float:
    """Square of the voltage at the fold of the way down.

    It lies far above the pad, where nothing but the spring acts.
    """
    fold = int(np.argmax(np.where(near, -np.inf, down_V2)))
    around = np.linspace(grid[fold - 1], grid[min(fold + 1, grid.size - 1)], FOLD_POINTS)
    return float(_balancing_V2(plate, around, pad.closing_GPa(around)).max())


def _release_V2(
    plate: Plate, pad: PadCurves, grid: Array, hold_nm: float, farthest_nm: float
) -> float:
    """Square of the voltage at the lowest point of the way up before its barrier, the fold that the
    way down met, too; up to a separation where it counts as released.
    """
    further = grid[grid > hold_nm]
    if farthest_nm < further[-1]:
        further = np.append(further[further < farthest_nm], farthest_nm)
    rising = np.concatenate([[hold_nm], further])
    up_V2 = _balancing_V2(plate, rising, pad.opening_GPa(rising, hold_nm))
    beyond = rising > pad.separation_nm[-1]
    barrier = rising.size - 1
    if beyond.any():
        barrier = int(np.argmax(np.where(beyond, up_V2, -np.inf)))
    return float(up_V2[: barrier + 1].min())


def _balancing_V2(plate: Plate, separation_nm: ArrayLike, pressure_GPa: Array) -> Array:
    """Square of the voltage that balances spring and pad at separations."""
    force_N = plate.spring_force_N(separation_nm) + plate.area_m2 * pressure_GPa * GPA
    return plate.balancing_V2(separation_nm, force_N) - plate.uneven_V2(separation_nm)


def _volts(squared_V2: float) -> float:
    """Voltage of a square; 0 where the pad pulls the plate shut by itself."""
    return float(np.sqrt(max(squared_V2, 0.0)))
