"""Electrostatic switch that lands on a rough dielectric: force balance, folds, pull-in and release.

A rigid plate (or the mid-span of a fixed-fixed beam) at mean separation s from the dielectric is in
balance when

    k (g - s) + phi A p(s) = eps0 A V^2 / (2 (s + t/eps)^2)

with p the contact pressure of the law (positive = repulsive) and phi the share of the area that is in contact: all of
it while closing, and while opening the strip of a bent beam that comes off last.  Solved for the
voltage, W(s) = V^2 is a single-valued function of s, so the whole equilibrium path, stable or not, is one
sweep in s.  A state is stable where W falls with s; the folds, where it turns, are pull-in and release.
"""

from dataclasses import dataclass

import numpy as np

from mesoscale.device.contact_law import column, flat, onset_nm, pressure_GPa, samples_of, scale_adhesion, take
from mesoscale.law.compact import Law
from mesoscale.settings import DeviceSettings

VACUUM_PERMITTIVITY = 8.8541878128e-12  # F/m, CODATA 2018
NM = 1e-9
GPA = 1e9
ELEMENTS = 32
CHUNK = 1000  # samples swept at once; bounds the memory to some tens of MB


@dataclass(frozen=True)
class Switch:
    """Lumped switch.

    Attributes
    ----------
    spring_N_per_m : stiffness k against a uniform load.
    gap_nm : separation g at rest.
    area_m2 : electrode area A.
    dielectric_nm : thickness t divided by the relative permittivity.
    last_share : share of the area that is in contact just before the switch lets go; 1 for a flat plate.
    """

    spring_N_per_m: float
    gap_nm: float
    area_m2: float
    dielectric_nm: float
    last_share: float = 1.0

    def net_force_N(self, separation_nm: np.ndarray, law: Law | None, share: float = 1.0) -> np.ndarray:
        """Force that opens the switch, electrostatics apart: spring, and contact on a share of the area."""
        force = self.spring_N_per_m * (self.gap_nm - separation_nm) * NM
        if law is not None:
            force = force + share * self.area_m2 * pressure_GPa(separation_nm, law) * GPA
        return force

    def voltage_squared(self, separation_nm: np.ndarray, law: Law | None, share: float = 1.0) -> np.ndarray:
        """W(s) in V^2; negative where adhesion holds the switch without any voltage."""
        return self.balancing_V2(separation_nm, self.net_force_N(separation_nm, law, share))

    def balancing_V2(self, separation_nm: np.ndarray, opening_force_N: np.ndarray) -> np.ndarray:
        """Square of the voltage (V^2) whose attraction balances a force that opens the switch."""
        electric_gap = (separation_nm + self.dielectric_nm) * NM
        factor = 2 * electric_gap**2 / (VACUUM_PERMITTIVITY * self.area_m2)
        return factor * opening_force_N

    def capacitance_F(self, separation_nm: np.ndarray) -> np.ndarray:
        """Parallel-plate capacitance at a mean separation."""
        return VACUUM_PERMITTIVITY * self.area_m2 / ((np.asarray(separation_nm) + self.dielectric_nm) * NM)


def rough_capacitance_F(switch: Switch, separation_nm: np.ndarray, rms_nm: np.ndarray) -> np.ndarray:
    """Capacitance of a flat plate over Gaussian heights, contacting sites flattened to zero gap.

    C/A = eps0 <1 / (max(s + h, 0) + t/eps)>, h normal with deviation rms: each site is a small plate
    capacitor of its own (slopes are neglected).  Always above the plate value at the same mean separation.

    Parameters
    ----------
    separation_nm, rms_nm : arrays of one shape, nm
    """
    separation = np.atleast_1d(np.asarray(separation_nm, dtype=float))
    rms = np.broadcast_to(np.asarray(rms_nm, dtype=float), separation.shape)
    # trapezoidal sum over +-8 deviations: exponentially accurate for the smooth part, 1e-4 at the kink
    heights = np.linspace(-8, 8, 641)
    weights = np.exp(-(heights**2) / 2)
    weights /= weights.sum()
    gaps = np.maximum(separation[:, None] + rms[:, None] * heights, 0.0) + switch.dielectric_nm
    return VACUUM_PERMITTIVITY * switch.area_m2 / NM * (weights / gaps).sum(axis=1)


def beam_stiffness_N_per_m(settings: DeviceSettings) -> float:
    """Stiffness of the beam at rest against a uniform pull of its electrode, where it comes down farthest.

    For a clamped beam that is pulled all along, 32 E b (t/L)^3 without tension, and with a tension little enough
    8 sigma (1 - nu) b t/L more (G. M. Rebeiz, RF MEMS, Wiley 2003, section 2.2).

    Raises
    ------
    InputError : it touches the dielectric at rest.
    """
    from mesoscale.device.beam import beam_of  # compiles: not where a scene is only planned

    beam = beam_of(settings, ELEMENTS)
    at_rest = np.zeros((beam.elements + 1, 2))
    change, _ = beam.step(at_rest, lambda s: (-beam.wired, np.zeros_like(s)))
    return float((beam.width_m * beam.weights_m * beam.wired).sum() / -change[:, 0].min())


def switch_from_settings(settings: DeviceSettings, range_nm: float | None = None) -> Switch:
    """The lumped switch that the settings describe.

    A clamped beam held down at mid-span has the curvature 24 g / L^2 there, so what comes off last are the places
    within a distance x of mid-span with 12 g x^2 / L^2 below the range of adhesion: a share sqrt(range / (3 g)).

    Parameters
    ----------
    range_nm : of the law's near attraction; None: it comes off at once, as the plate of a given spring.
    """
    area = settings.area_um2
    last_share = 1.0
    if range_nm is not None and settings.bends:
        last_share = min(float(np.sqrt(range_nm / (3.0 * settings.gap_um * 1e3))), 1.0)
    return Switch(
        spring_N_per_m=settings.spring_N_per_m or beam_stiffness_N_per_m(settings),
        gap_nm=settings.gap_um * 1e3,
        area_m2=area * 1e-12,
        dielectric_nm=settings.dielectric_nm / settings.permittivity,
        last_share=last_share,
    )


@dataclass(frozen=True)
class SwitchStates:
    """What the sweeps found, one entry per sample of the law.

    Attributes
    ----------
    pull_in_V : voltage at the first fold on the way down; NaN where the switch closes without snapping.
    pull_in_nm : separation at that fold.
    release_V : voltage at which the closed switch lets go; 0 where it never does.
    release_nm : separation at that fold.
    stuck : True where the closed switch stays closed at 0 V.
    critical_fraction : share in contact above which the switch sticks; inf without any net adhesion.
    hold_nm : separation at the hold voltage.
    hold_pressure_GPa : contact pressure there.
    """

    pull_in_V: np.ndarray
    pull_in_nm: np.ndarray
    release_V: np.ndarray
    release_nm: np.ndarray
    stuck: np.ndarray
    critical_fraction: np.ndarray
    hold_nm: np.ndarray
    hold_pressure_GPa: np.ndarray


def solve_switch(switch: Switch, closing: Law, opening: Law, hold_voltage_V: float | None = None) -> SwitchStates:
    """Follow the closing law down and the opening law up for every sample of the law.

    Parameters
    ----------
    closing, opening : laws of the two branches with parameters of shape (samples,).
    hold_voltage_V : voltage of the closed switch; None takes each sample's pull-in voltage.
    """
    samples = max(samples_of(closing), samples_of(opening))
    every = np.arange(samples)
    closing, opening = flat(closing, samples), flat(opening, samples)
    parts = []
    for start in range(0, samples, CHUNK):
        block = every[start : start + CHUNK]
        parts.append(_solve_block(switch, take(closing, block), take(opening, block), hold_voltage_V))
    return SwitchStates(*(np.concatenate([part[i] for part in parts]) for i in range(len(parts[0]))))


def drive_switch(settings: DeviceSettings, closing: Law, opening: Law) -> SwitchStates:
    """Pull-in, hold, release and sticking of the switch that the settings describe, one entry per sample of the laws.

    The laws' attraction is scaled by `settings.adhesion_scale`, and the closed switch is held at
    `settings.hold_voltage_V`.
    """
    closing, opening = (scale_adhesion(law, settings.adhesion_scale) for law in (closing, opening))
    return solve_switch(switch_from_settings(settings, opening.rho_a_nm), closing, opening, settings.hold_voltage_V)


def _separations(switch: Switch, law: Law, inner: int = 160, outer: int = 120) -> np.ndarray:
    """Sorted separations (samples, points) from deep contact to rest, both kinks of the law among them."""
    contact = np.asarray(law.d_c_nm)[:, None]
    onset = onset_nm(law)[:, None]
    # 12 decay lengths are a repulsion of 1.6e5 C_r; the electric gap must stay open
    depth = np.minimum(12 * np.asarray(law.rho_r_nm)[:, None], contact + 0.9 * switch.dielectric_nm)
    depth = np.maximum(depth, 1e-6)
    deep = contact - depth * np.linspace(1, 0, inner)
    near = contact + (onset - contact) * np.linspace(0, 1, 25)[1:]
    # geometric in the electric gap, which W follows, and exact at the smooth fold of an ideal plate
    fold = np.full_like(contact, (2 * switch.gap_nm - switch.dielectric_nm) / 3)
    ratio = (switch.gap_nm + switch.dielectric_nm) / (onset + switch.dielectric_nm)
    far = (onset + switch.dielectric_nm) * ratio ** np.linspace(0, 1, outer)[1:] - switch.dielectric_nm
    far[:, -1] = switch.gap_nm
    grid = np.concatenate([deep, near, far, np.clip(fold, onset, switch.gap_nm)], axis=1)
    return np.sort(grid, axis=1)


def _solve_block(switch: Switch, closing: Law, opening: Law, hold_voltage_V: float | None) -> tuple[np.ndarray, ...]:
    down, up = column(closing), column(opening)
    # pull-in: the highest point of W above the contact, on the way down
    grid = _separations(switch, closing)
    curve = switch.voltage_squared(grid, down)
    above = grid >= onset_nm(down)
    peak = np.argmax(np.where(above, curve, -np.inf), axis=1)
    pull_in_nm, pull_in_W = _refine(lambda s: -switch.voltage_squared(s, down), grid, peak)
    pull_in_W = -pull_in_W
    first = np.argmax(above, axis=1)
    snaps = peak > first
    pull_in_V = np.where(snaps, np.sqrt(np.maximum(pull_in_W, 0)), np.nan)

    # held closed: the first equilibrium met on the way down
    hold_W = np.full(len(grid), hold_voltage_V**2) if hold_voltage_V is not None else pull_in_W
    inside = grid < onset_nm(down)
    holds = np.where(inside & (curve >= hold_W[:, None]), np.arange(grid.shape[1]), -1).max(axis=1)
    hold_nm = _crossing(lambda s: switch.voltage_squared(s, down) - hold_W[:, None], grid, holds)
    hold_pressure = pressure_GPa(hold_nm[:, None], down)[:, 0]

    # release: the lowest point of W between the repulsive wall and the barrier
    grid = _separations(switch, opening)
    curve = switch.voltage_squared(grid, up, switch.last_share)
    columns = np.arange(grid.shape[1])
    wall = np.argmax(np.where(grid <= np.asarray(up.d_c_nm), curve, -np.inf), axis=1)
    barrier = np.argmax(np.where(grid >= onset_nm(up), curve, -np.inf), axis=1)
    path = (columns >= wall[:, None]) & (columns <= barrier[:, None])
    lowest = np.argmin(np.where(path, curve, np.inf), axis=1)
    release_nm, release_W = _refine(lambda s: switch.voltage_squared(s, up, switch.last_share), grid, lowest)
    stuck = release_W <= 0
    release_V = np.sqrt(np.maximum(release_W, 0))

    # critical share: spring and adhesion just balance where adhesion is relatively strongest
    def fraction(separation: np.ndarray) -> np.ndarray:
        adhesion = np.maximum(-pressure_GPa(separation, up), 1e-300) * GPA * switch.area_m2
        with np.errstate(over="ignore"):  # no adhesion: infinite
            return switch.spring_N_per_m * (switch.gap_nm - separation) * NM / adhesion

    weakest = np.argmin(np.where(path, fraction(grid), np.inf), axis=1)
    _, critical = _refine(fraction, grid, weakest)
    critical = np.where(critical > 1e100, np.inf, critical)
    return pull_in_V, pull_in_nm, release_V, release_nm, stuck, critical, hold_nm, hold_pressure


def _refine(function, grid: np.ndarray, index: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Minimum of `function` near the grid's best point, by golden sections between its neighbours.

    The kinks of the law are grid points, so each bracket holds one smooth piece or a kink minimum.
    """
    rows = np.arange(len(grid))
    best = grid[rows, index]
    value = function(best[:, None])[:, 0]
    ratio = (np.sqrt(5) - 1) / 2
    # one side at a time: a kink then sits at the end of a bracket and cannot mislead it
    for low, high in (
        (grid[rows, np.maximum(index - 1, 0)], grid[rows, index]),
        (grid[rows, index], grid[rows, np.minimum(index + 1, grid.shape[1] - 1)]),
    ):
        for _ in range(45):
            left = high - ratio * (high - low)
            right = low + ratio * (high - low)
            go_left = function(left[:, None])[:, 0] < function(right[:, None])[:, 0]
            low, high = np.where(go_left, low, left), np.where(go_left, right, high)
        middle = (low + high) / 2
        trial = function(middle[:, None])[:, 0]
        best = np.where(trial < value, middle, best)
        value = np.minimum(trial, value)
    return best, value


def _crossing(function, grid: np.ndarray, index: np.ndarray) -> np.ndarray:
    """Where `function` falls through zero between grid points index and index + 1; NaN where index is -1."""
    rows = np.arange(len(grid))
    low = grid[rows, np.maximum(index, 0)]
    high = grid[rows, np.minimum(index + 1, grid.shape[1] - 1)]
    for _ in range(60):
        middle = (low + high) / 2
        positive = function(middle[:, None])[:, 0] >= 0
        low, high = np.where(positive, middle, low), np.where(positive, high, middle)
    return np.where(index >= 0, (low + high) / 2, np.nan)
