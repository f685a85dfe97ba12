"""How far charge shifts a place of the dielectric, after any time.

A place is known by its gap. Where it touches, charge is injected by the field of the dielectric, as
traps let it go (Frenkel). Across a gap it is emitted by the field there (Murphy and Good). Charge
that has arrived lowers the field E that brings it,

    dE/dt = -K J(E),    so    t(E) = int dE / (K J),

with K = 1 / (eps0 eps) where it touches, and t / [eps0 (eps g + t)] across a gap g. This integral
is exact at all times: nothing is stepped.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.errors import InputError
from mesoscale.settings import DeviceSettings, LifetimeSettings
from mesoscale.switch.charge import PER_CM2
from mesoscale.theory.charging import IMAGE_FORCE, charge_shift, emission_current, frenkel_ratio
from mesoscale.units import NM, VACUUM_PERMITTIVITY

Array = NDArray[np.float64]
Current = Callable[[Array], Array]
"""Current density (A/m^2) by field (V/m)."""

REFERENCE_V_M = 1e8
"""Field of `LifetimeSettings.injection_A_m2`, 1 MV/cm."""
ZERO_C_K = 273.15
LOST = np.concatenate(
    [
        np.geomspace(1e-12, 1e-5, 40),
        np.geomspace(1e-5, 0.3, 1200)[1:],
        np.linspace(0.3, 0.9999, 1200)[1:],
    ]
)
"""Shares of a field at which the time is known that it takes to lose them. It is linear before the
first of them; with half as many a shift changes by less than 1e-4 of itself."""
NEVER = 1e4
"""Logarithm of a time in s that stands for none."""
GUESSES = ("least", "central", "most")
"""What is not known of the rates, from the least charge to the most."""


@dataclass(frozen=True)
class Rates:
    """One guess of the rates.

    Attributes
    ----------
    injection_A_m2 : current that stays where it touches, at 1 MV/cm.
    barrier_eV : of emission.
    most_e_cm2 : charge that the surface holds.
    recovery_exponent : of the power law by which charge leaks in a rest.
    """

    injection_A_m2: float
    barrier_eV: float
    most_e_cm2: float
    recovery_exponent: float = 0.0


def guesses(settings: LifetimeSettings) -> dict[str, Rates]:
    """The rates of least charge, of the middle and of most; a high barrier lets least through."""
    slow, fast = settings.injection_A_m2
    low, high = settings.barrier_eV
    few, many = settings.traps_e_cm2
    keeps, leaks = settings.recovery_exponent
    return {
        "least": Rates(slow, high, few, leaks),
        "central": Rates(
            float(np.sqrt(slow * fast)),
            0.5 * (low + high),
            float(np.sqrt(few * many)),
            0.5 * (keeps + leaks),
        ),
        "most": Rates(fast, low, many, keeps),
    }


def narrowed_guesses(content: Mapping[str, Any]) -> dict[str, Rates]:
    """The guesses that a measured drift leaves, of the content of lifetime/rates.json.

    Raises
    ------
    InputError : it has no posterior.
    """
    if not content["gate"]["passed"]:
        reasons = "; ".join(content["gate"]["reasons"])
        raise InputError(
            f"{content['file']}: the rates have no posterior: {reasons}; look at the errors of the"
            " shifts, or leave the table out"
        )
    return {guess: Rates(**content["guesses"][guess]) for guess in GUESSES}


def slowness_and_times(
    current: Current, start: Array, lowering: Array, lost: Array = LOST
) -> tuple[Array, Array]:
    """Logarithms of 1 / J with nothing lost and at each share, shape (places, shares + 1), and of
    the times (s) that it takes to lose these shares, shape (places, shares).

    Parameters
    ----------
    start, lowering, lost : see `lost_share`.
    """
    edges = np.concatenate([[0.0], lost])
    fields = start[:, None] * (1.0 - edges)
    with np.errstate(divide="ignore", over="ignore", under="ignore", invalid="ignore"):
        slowness = np.minimum(-np.log(current(fields)), NEVER)
        # 1 / J grows as an exponential of the field between two of them
        growth = np.diff(slowness, axis=1)
        mean = np.where(growth > 1e-6, -np.expm1(-growth) / np.maximum(growth, 1e-6), 1.0)
        steps = np.log(start[:, None] * np.diff(edges) / lowering[:, None]) + slowness[:, 1:]
        after = np.minimum(np.logaddexp.accumulate(steps + np.log(mean), axis=1), NEVER)
    return slowness, after


def lost_share(
    current: Current, start: Array, lowering: Array, times: Array, lost: Array = LOST
) -> Array:
    """Share of its field that each place has lost after times (s), shape (places, times).

    Parameters
    ----------
    start : field (V/m) at first, shape (places,).
    lowering : K (V/m per C/m^2), shape (places,).
    lost : shares at which the time is known.

    Raises
    ------
    ValueError : a time below zero.
    """
    if times.min(initial=0.0) < 0.0:
        raise ValueError(f"a time of {times.min():g} s: times are not below zero")
    _, after = slowness_and_times(current, start, lowering, lost)
    with np.errstate(divide="ignore"):
        log_times = np.log(times)
    logarithms = np.log(lost)
    shares = np.empty((start.size, times.size))
    for row, known in zip(shares, after, strict=True):
        row[:] = np.interp(log_times, known, logarithms)
        early = log_times < known[0]
        row[early] = log_times[early] - known[0] + logarithms[0]
    return np.exp(shares)


def shifts_V(
    voltage: float,
    gaps_nm: Array,
    times: Array,
    device: DeviceSettings,
    settings: LifetimeSettings,
    rates: Rates,
    lost: Array = LOST,
) -> Array:
    """Shift (V) of places after being held at a voltage for times (s), shape (gaps, times).

    Parameters
    ----------
    gaps_nm : 0: it touches.
    lost : see `lost_share`.
    """
    shifts = np.zeros((gaps_nm.size, times.size))
    if voltage <= 0.0:
        return shifts
    for places, current, start, lowering in charged_places(
        voltage, gaps_nm, device, settings, rates
    ):
        shifts[places] = voltage * lost_share(current, start, lowering, times, lost)
    return np.minimum(shifts, most_V(device, rates))


def most_V(device: DeviceSettings, rates: Rates) -> float:
    """Shift (V) of a place whose traps are full."""
    density = rates.most_e_cm2 * PER_CM2
    return float(charge_shift(density, device.dielectric_nm, device.permittivity))


def charged_places(
    voltage: float,
    gaps_nm: Array,
    device: DeviceSettings,
    settings: LifetimeSettings,
    rates: Rates,
) -> Iterator[tuple[NDArray[np.bool_], Current, Array, Array]]:
    """Places where charge enters: which they are, its current by the field, the field (V/m) that a
    voltage makes, and K (V/m per C/m^2).
    """
    touching = gaps_nm <= 0.0
    kelvin = device.temperature_C + ZERO_C_K

    def injected(field: Array) -> Array:
        ratio = frenkel_ratio(field, REFERENCE_V_M, settings.optical_permittivity, kelvin)
        return np.asarray(rates.injection_A_m2 * ratio)

    def emitted(field: Array) -> Array:
        # beyond this field there is no barrier
        highest = (1.0 - 1e-9) * rates.barrier_eV**2 / IMAGE_FORCE
        return np.asarray(emission_current(np.minimum(field, highest), rates.barrier_eV))

    if touching.any():
        count = int(touching.sum())
        field = voltage / (device.dielectric_nm * NM)
        lowering = 1.0 / (VACUUM_PERMITTIVITY * device.permittivity)
        yield touching, injected, np.full(count, field), np.full(count, lowering)
    if not touching.all() and settings.electrode == "negative":
        gaps = gaps_nm[~touching]
        vacuum_m = (gaps + device.dielectric_gap_nm) * NM
        lowering = device.dielectric_nm / (
            VACUUM_PERMITTIVITY * (device.permittivity * gaps + device.dielectric_nm)
        )
        yield ~touching, emitted, voltage / vacuum_m, lowering


def held_s(times: Array, settings: LifetimeSettings) -> Array:
    """Time (s) that counts: held, less what the other polarity undoes."""
    return times * settings.duty * abs(1.0 - 2.0 * settings.other_polarity)


def contactless_V(times: Array, settings: LifetimeSettings) -> Array:
    """Shift (V, of the other sign) without contact; it grows with the logarithm of time."""
    return settings.contactless_V * np.log10(1.0 + times)
