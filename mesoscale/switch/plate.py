"""A switch as a plate on a spring above a dielectric: its numbers, and what it does on the curves
of a pad.

The plate at mean separation s from the dielectric is in balance when

    F(s) = eps0 A V^2 / (2 (s + t/eps)^2)

with F the force that opens it: that of its spring, k (g - s), and that of the pad, on which it lies
flat. V^2 is then a single-valued function of s. A state is stable where it falls with s; where it
turns are pull-in and release. Nothing is extrapolated: a held state beyond the computed closing, or
an opening from a depth that was not computed, is refused."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from mesoscale.errors import InputError, NotComputed
from mesoscale.settings import DeviceSettings
from mesoscale.switch.numerics import SWITCH

if TYPE_CHECKING:  # rules read this module: it imports nothing heavy
    from mesoscale.pad.memory import PadLaw

Array = NDArray[np.float64]

VACUUM_PERMITTIVITY = 8.8541878128e-12  # F/m, CODATA 2018
NM = 1e-9
GPA = 1e9


@dataclass(frozen=True)
class Plate:
    """A plate on a spring.

    Attributes
    ----------
    spring_N_per_m : stiffness k against a uniform load.
    gap_nm : separation g at rest.
    area_m2 : electrode area A.
    dielectric_nm : thickness t divided by the relative permittivity.
    """

    spring_N_per_m: float
    gap_nm: float
    area_m2: float
    dielectric_nm: float

    def spring_force_N(self, separation_nm: np.ndarray) -> np.ndarray:
        """Force of the spring, which opens the switch."""
        return self.spring_N_per_m * (self.gap_nm - separation_nm) * NM

    def balancing_V2(self, separation_nm: np.ndarray, opening_force_N: np.ndarray) -> np.ndarray:
        """Square of the voltage (V^2) whose attraction balances a force that opens the switch."""
        electric_gap = (separation_nm + self.dielectric_nm) * NM
        factor = 2 * electric_gap**2 / (VACUUM_PERMITTIVITY * self.area_m2)
        return factor * opening_force_N

    def capacitance_F(self, separation_nm: np.ndarray) -> np.ndarray:
        """Parallel-plate capacitance at a mean separation."""
        return (
            VACUUM_PERMITTIVITY
            * self.area_m2
            / ((np.asarray(separation_nm) + self.dielectric_nm) * NM)
        )

    @property
    def pull_in_V(self) -> float:
        """Pull-in without contact: sqrt(8 k (g + t/eps)^3 / (27 eps0 A))."""
        gap = (self.gap_nm + self.dielectric_nm) * NM
        return float(
            np.sqrt(8 * self.spring_N_per_m * gap**3 / (27 * VACUUM_PERMITTIVITY * self.area_m2))
        )


def beam_stiffness_N_per_m(settings: DeviceSettings) -> float:
    """Stiffness of the beam at rest against a uniform pull of its electrode, where it comes down
    farthest.

    For a clamped beam that is pulled all along, 32 E b (t/L)^3 without tension, and with a tension
    little enough 8 sigma (1 - nu) b t/L more (G. M. Rebeiz, RF MEMS, Wiley 2003, section 2.2).

    Raises
    ------
    InputError : it touches the dielectric at rest.
    """
    from mesoscale.switch.beam import beam_of  # compiles: not where a scene is only planned

    beam = beam_of(settings, 32)
    at_rest = np.zeros((beam.elements + 1, 2))
    change, _ = beam.step(at_rest, lambda s: (-beam.wired, np.zeros_like(s)))
    return float((beam.width_m * beam.weights_m * beam.wired).sum() / -change[:, 0].min())


def plate_from_settings(settings: DeviceSettings) -> Plate:
    """The plate that the settings describe; a beam has the spring of `beam_stiffness_N_per_m`."""
    return Plate(
        spring_N_per_m=settings.spring_N_per_m or beam_stiffness_N_per_m(settings),
        gap_nm=settings.gap_um * 1e3,
        area_m2=settings.area_um2 * 1e-12,
        dielectric_nm=settings.dielectric_nm / settings.permittivity,
    )


@dataclass(frozen=True)
class PadStates:
    """What the switch does on one pad.

    Attributes
    ----------
    pull_in_V : voltage at which the open switch snaps shut.
    hold_nm : separation while held closed (nm).
    release_V : voltage at which the closed switch lets go; 0 where it sticks.
    """

    pull_in_V: float
    hold_nm: float
    release_V: float


def solve_on_pad(plate: Plate, law: "PadLaw", hold_voltage_V: float | None) -> PadStates:
    """Close the switch on a pad, hold it, and release it.

    Parameters
    ----------
    hold_voltage_V : voltage of the closed switch; None takes its own pull-in voltage.

    Raises
    ------
    NotComputed : the held state is not on the computed closing curve.
    InputError : the hold voltage does not hold the plate.
    """
    from scipy.optimize import brentq

    outside = np.geomspace(law.separation_nm[-1], plate.gap_nm, SWITCH.fold_points)[1:]
    grid = np.concatenate([law.separation_nm, outside])
    down = _voltage_squared(plate, grid, law.closing_GPa(grid))
    near = grid <= law.separation_nm[-1]
    # the fold of the way down lies far above the pad, where nothing but the spring acts
    peak = int(np.argmax(np.where(near, -np.inf, down)))
    around = np.linspace(grid[peak - 1], grid[min(peak + 1, grid.size - 1)], SWITCH.fold_points)
    pull_in = float(_voltage_squared(plate, around, law.closing_GPa(around)).max())
    hold = pull_in if hold_voltage_V is None else hold_voltage_V**2
    holds = np.flatnonzero(near & (down >= hold))
    if holds.size == 0:
        raise NotComputed(
            f"device.hold_voltage_V: {np.sqrt(hold):.4g} V presses the pad harder than the computed"
            f" {law.closing_GPa(law.separation_nm[0]) * 1e3:.3g} MPa"
        )
    inner = int(holds[-1])
    if inner + 1 == near.sum():
        raise InputError(
            f"device.hold_voltage_V = {np.sqrt(hold):.4g}: too little to keep the switch on the pad"
            f" (pull-in is at {np.sqrt(pull_in):.4g} V); raise it"
        )
    held = brentq(
        lambda s: _voltage_squared(plate, s, law.closing_GPa(s)) - hold,
        grid[inner],
        grid[inner + 1],
    )
    hold_nm = float(np.asarray(held))
    way_up = np.concatenate([[hold_nm], grid[grid > hold_nm]])
    up = _voltage_squared(plate, way_up, law.opening_GPa(way_up, hold_nm))
    # release is the lowest point before the barrier, the fold that the way down met, too
    barrier = int(np.argmax(np.where(way_up > law.separation_nm[-1], up, -np.inf)))
    release = float(up[: barrier + 1].min())
    # a pull-in of 0: the pad pulls it shut by itself
    return PadStates(float(np.sqrt(max(pull_in, 0.0))), hold_nm, float(np.sqrt(max(release, 0.0))))


def _voltage_squared(plate: Plate, separation_nm: Array, pressure_GPa: Array) -> Array:
    force = plate.spring_force_N(separation_nm) + plate.area_m2 * pressure_GPa * GPA
    return plate.balancing_V2(separation_nm, force)
