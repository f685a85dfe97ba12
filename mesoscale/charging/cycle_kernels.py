"""Inner loops of a drive in cycles: what a hold adds to a shift, and what rests have left of it."""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]

ONE_BY_ONE = 32.0
"""Cycles that are summed one by one before octaves of them are integrated: the rule of midpoints
is off by less than 1e-4 there."""
POINTS, WEIGHTS = np.polynomial.legendre.leggauss(6)
WALKED = 4
"""Shares of the table that a hold walks through before it looks its time up."""
MOST_STEPS = 200
"""Of Newton's method, of which a dozen are needed; halves of the interval close in 60."""
NO_TIME = 700.0
"""Logarithm of a time in s beyond which nothing happens."""


@njit(cache=True)
def lost_in_hold(
    share: float, hold_s: float, edges: Array, log_rates: Array, log_times: Array
) -> tuple[float, float]:
    """Share of its field that a place loses in a hold, and what its rate is afterwards over that
    before.

    Between two shares the logarithm of the rate is straight, as in `rates.slowness_and_times`.

    Parameters
    ----------
    share : lost before the hold.
    edges, log_rates : shares, from 0 on, and logarithms of the rates (1/s) there.
    log_times : of the times (s) at which they are reached from 0, that of 0 left out.
    """
    last = edges.size - 1
    place = min(np.searchsorted(edges, share, side="right") - 1, last)
    lost = 0.0
    left_s = hold_s
    walked = 0
    first_log_rate = 0.0
    log_rate = 0.0
    while place < last:
        width = edges[place + 1] - edges[place]
        steepness = (log_rates[place] - log_rates[place + 1]) / width
        begun = max(share + lost - edges[place], 0.0)
        log_rate = log_rates[place] - steepness * begun
        if walked == 0:
            first_log_rate = log_rate
        rate = math.exp(log_rate)
        if rate == 0.0:
            break
        still = width - begun
        needed_s = still / rate
        if steepness * still > 1e-9:
            needed_s = math.expm1(min(steepness * still, NO_TIME)) / (steepness * rate)
        if left_s <= needed_s:
            more = rate * left_s
            if steepness * more > 1e-9:
                more = math.log1p(steepness * rate * left_s) / steepness
            return lost + more, math.exp(log_rate - steepness * more - first_log_rate)
        lost += still
        left_s -= needed_s
        place += 1
        walked += 1
        if walked == WALKED and place < last and log_times[place - 1] < NO_TIME:
            reached_s = math.exp(log_times[place - 1])
            until = math.log(reached_s + left_s)
            target = min(np.searchsorted(log_times, until, side="right"), last)
            if target > place:
                left_s = max(reached_s + left_s - math.exp(log_times[target - 1]), 0.0)
                place = target
                lost = edges[place] - share
    if walked == 0:
        return 0.0, 1.0
    return lost, math.exp(log_rate - first_log_rate)


@njit(cache=True)
def gained_in_cycle(
    shift: float,
    drive: Array,
    full_traps_V: float,
    edges: Array,
    log_rates: Array,
    log_times: Array,
) -> tuple[float, float, float]:
    """What the first hold of a cycle adds to a shift (V), what both add, and the slope of that in
    the shift.

    Parameters
    ----------
    drive : voltage (V), that of the table, time of the hold and of that of the other polarity (s).
    full_traps_V : shift of full traps.
    """
    voltage, table_V, hold_s, other_s = drive
    first = 0.0
    gain = 0.0
    growth = 1.0
    sign = 1.0
    for seconds in (hold_s, other_s):
        before = sign * (shift + gain)
        share = max(1.0 - (voltage - before) / table_V, 0.0)
        lost, slope = lost_in_hold(share, seconds, edges, log_rates, log_times)
        more = table_V * lost
        if before + more >= full_traps_V:
            more = full_traps_V - before
            slope = 0.0
        gain += sign * more
        growth *= slope
        if sign > 0.0:
            first = gain
        sign = -sign
    return first, gain, growth - 1.0


@njit(cache=True)
def rested_weights(cycles: Array, rest_ratio: float, exponent: float) -> Array:
    """What is left before a cycle of gains of 1 in the earlier ones, by the cycles at which gains
    are known; between two of them gains are straight. Shape (cycles, cycles).

    Parameters
    ----------
    cycles : numbers of cycles, rising from 1.
    rest_ratio : rest of a cycle, over the time at which the power law begins.
    """
    count = cycles.size
    weights = np.zeros((count, count))
    for row in range(1, count):
        now = cycles[row]
        weights[row, 0] += (1.0 + (now - 1.0) * rest_ratio) ** -exponent
        for place in range(row):
            before = cycles[place]
            span = cycles[place + 1] - before
            ago = max(now - cycles[place + 1], 1.0)
            longest = now - before - 1.0
            while ago <= longest:  # left at the end, where numbers beyond 2^53 do not grow by 1
                # a cycle, or the cycles of an octave of rests
                end = min(2.0 * ago - 1.0, longest)
                if ago < ONE_BY_ONE:
                    end = ago
                length = end - ago + 1.0
                for point in range(POINTS.size):
                    rests = ago - 0.5 + 0.5 * length * (1.0 + POINTS[point])
                    weight = 0.5 * length * WEIGHTS[point]
                    if ago < ONE_BY_ONE:
                        rests = ago
                        weight = 1.0 / POINTS.size
                    weight *= (1.0 + rests * rest_ratio) ** -exponent
                    later = (now - rests - before) / span
                    weights[row, place] += weight * (1.0 - later)
                    weights[row, place + 1] += weight * later
                if end >= longest:
                    break
                ago = end + 1.0
    return weights


@njit(cache=True)
def shifts_of_place(
    weights: Array,
    drive: Array,
    full_traps_V: float,
    edges: Array,
    log_rates: Array,
    log_times: Array,
) -> Array:
    """Shift (V) of a place at the end of the first hold of each known cycle.

    Parameters
    ----------
    weights : see `rested_weights`.
    drive, full_traps_V : see `gained_in_cycle`.
    edges, log_rates, log_times : see `lost_in_hold`.
    """
    count = weights.shape[0]
    gains = np.empty(count)
    held_shifts = np.empty(count)
    highest = min(drive[0], full_traps_V)
    lowest = 0.0
    if drive[3] > 0.0:
        lowest = -highest
    shift = 0.0
    for row in range(count):
        left = 0.0
        for place in range(row):
            left += weights[row, place] * gains[place]
        same_cycle = weights[row, row]
        low = lowest
        high = highest
        shift = min(max(shift, low), high)
        for _ in range(MOST_STEPS):
            _, gain, slope = gained_in_cycle(
                shift, drive, full_traps_V, edges, log_rates, log_times
            )
            excess = shift - left - same_cycle * gain
            if excess > 0.0:
                high = shift
            else:
                low = shift
            step = excess / (1.0 - same_cycle * slope)
            nearer = shift - step
            if nearer < low or nearer > high:
                nearer = 0.5 * (low + high)
            moved = abs(nearer - shift)
            shift = nearer
            if moved <= 1e-13 * highest:
                break
        first, gain, _ = gained_in_cycle(shift, drive, full_traps_V, edges, log_rates, log_times)
        gains[row] = gain
        held_shifts[row] = shift + first
    return held_shifts
