"""Shift of places by a drive in cycles, between whose holds charge leaks.

A cycle is a hold, a shorter hold of the other polarity, and a rest. Of what a cycle has added the
share S(r) = (1 + r / tau)^-n is left after rests of r in all: the power law of traps whose rates of
emission are gamma distributed, each of which leaks on its own. So the shift before cycle N is

    q_N = sum_k g_k S((N - k) r),    g_N = G(q_N),

with the rest r of a cycle and what its holds add, G, by the integral of `rates`. Gains g are known
at cycles whose numbers grow geometrically, and straight between two of them. Each is the root of
one rising function, so that no step can fail.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from mesoscale.charging.cycle_kernels import gained_in_cycle, rested_weights, shifts_of_place
from mesoscale.charging.rates import (
    LOST,
    Rates,
    charged_places,
    held_s,
    most_V,
    shifts_V,
    slowness_and_times,
)
from mesoscale.settings import DeviceSettings, LifetimeSettings

Array = NDArray[np.float64]

FIRST_CYCLES = 16
"""Cycles that are known one by one."""
PER_DECADE = 20
"""Known cycles a decade beyond; with four times as many a shift changes by less than 0.1 %."""


def driven_V(
    voltage: float,
    gaps_nm: Array,
    times: Array,
    device: DeviceSettings,
    settings: LifetimeSettings,
    rates: Rates,
) -> Array:
    """Shift (V) of places, with the sign of the drive, after it has been on for times (s).

    Shape (gaps, times). Without a period of the drive the time counts that it is held.
    """
    sign = np.sign(1.0 - 2.0 * settings.other_polarity)
    if settings.period_s is None:
        held = held_s(times, settings)
        return sign * shifts_V(voltage, gaps_nm, held, device, settings, rates)
    return sign * cycled_V(voltage, gaps_nm, times, device, settings, rates)


def cycled_V(
    voltage: float,
    gaps_nm: Array,
    times: Array,
    device: DeviceSettings,
    settings: LifetimeSettings,
    rates: Rates,
    per_decade: int = PER_DECADE,
) -> Array:
    """Shift (V) of places, with the sign of the longer hold, at the end of that hold in the cycles
    that end at times (s), shape (gaps, times); in a first cycle that is not over, at the time.

    Parameters
    ----------
    settings : with the period of the drive.

    Raises
    ------
    ValueError : a time below zero.
    """
    if times.min(initial=0.0) < 0.0:
        raise ValueError(f"a time of {times.min():g} s: times are not below zero")
    period_s = settings.period_s
    assert period_s is not None
    shifts = np.zeros((gaps_nm.size, times.size))
    if voltage <= 0.0 or not times.size:
        return shifts
    held = settings.duty * period_s
    other_s = min(settings.other_polarity, 1.0 - settings.other_polarity) * held
    table_V = voltage
    if other_s:  # a place that the other hold has charged feels more
        table_V = 2.0 * voltage
    drive = np.array([voltage, table_V, held - other_s, other_s])
    full_traps_V = most_V(device, rates)
    completed = times >= period_s
    cycles = known_cycles(times[completed] / period_s, per_decade)
    rest_ratio = (1.0 - settings.duty) * period_s / settings.recovery_s
    weights = _weights(tuple(cycles.tolist()), rest_ratio, rates.recovery_exponent)
    edges = np.concatenate([[0.0], LOST])
    log_cycles = np.log(cycles)
    for places, current, start, lowering in charged_places(
        table_V, gaps_nm, device, settings, rates
    ):
        slowness, log_times = slowness_and_times(current, start, lowering)
        log_rates = np.log(lowering / start)[:, None] - slowness
        rows = shifts[places]
        for row, rates_of, times_of in zip(rows, log_rates, log_times, strict=True):
            held_shifts = shifts_of_place(weights, drive, full_traps_V, edges, rates_of, times_of)
            row[completed] = np.interp(np.log(times[completed] / period_s), log_cycles, held_shifts)
            for place in np.flatnonzero(~completed):
                begun = np.array([voltage, table_V, min(times[place], drive[2]), 0.0])
                row[place], _, _ = gained_in_cycle(
                    0.0, begun, full_traps_V, edges, rates_of, times_of
                )
        shifts[places] = rows
    return shifts


def known_cycles(numbers: Array, per_decade: int) -> Array:
    """Numbers of the cycles at which gains are known: the first ones, some `numbers`, and between
    them in steps that grow geometrically.
    """
    first = np.arange(1.0, FIRST_CYCLES + 1.0)
    last = max(float(numbers.max(initial=1.0)), FIRST_CYCLES)
    count = int(np.ceil(per_decade * np.log10(last / FIRST_CYCLES)))
    later = FIRST_CYCLES * 10.0 ** (np.arange(count + 1) / per_decade)
    return np.unique(np.concatenate([first, np.rint(later), np.rint(numbers)]))


@lru_cache(maxsize=64)
def _weights(cycles: tuple[float, ...], rest_ratio: float, exponent: float) -> Array:
    return rested_weights(np.array(cycles), rest_ratio, exponent)
