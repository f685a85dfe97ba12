"""Does a drift that was measured at two voltages foretell that at a third?

Truths are drawn from the ranges of `lifetime`. Their drift is that of `shifts_V` itself, on a
made-up switch, at 60 and 70 V, with noise of the stated error. The posterior then foretells the
shift at other voltages and times. Stated before: seeds 1 to 20; it passes if the true shift at 50 V
after a day lies within the 90 % interval in at least 16 of them.
"""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mesoscale.calibration.drift import drift_model, narrow_rates, prior_of_rates, rates_of
from mesoscale.calibration.measurements import Measurements
from mesoscale.charging.gaps import GAPS_NM, HeldGaps
from mesoscale.charging.rates import LOST, shifts_V
from mesoscale.settings import DeviceSettings, LifetimeSettings
from mesoscale.studies.lifetime_stability import made_up_gaps

Array = NDArray[np.float64]

SEEDS = range(1, 21)
HOLDS_V = (60.0, 70.0)
TIMES_S = np.geomspace(10.0, 86400.0, 8)
ERROR_V = 0.05
FORETOLD = {"third": (50.0, 86400.0), "between": (65.0, 86400.0), "decade": (50.0, 3.15576e8)}
"""Voltages (V) and times (s) that were not measured: the third voltage after a day, one between the
two, and the third one after ten years."""
DRAWS = 200
COARSE = LOST[::8]
"""Shares of a lost field for draws, whose shifts then err by some tenths of a per cent."""
SETTINGS = LifetimeSettings(years=10.0)


def rows(_given: Any) -> Iterator[dict[str, Any]]:
    """A row for each truth and each shift that is foretold."""
    gaps = made_up_gaps(DeviceSettings())
    for seed in SEEDS:
        yield from foretold_rows(seed, gaps)


def foretold_rows(seed: int, gaps: HeldGaps) -> Iterator[dict[str, Any]]:
    """What a made-up drift of this seed foretells, beside the truth."""
    rng = np.random.default_rng(seed)
    prior = prior_of_rates(SETTINGS)
    truth = prior.transform(rng.random((1, len(prior.rows))))[0]
    holds = np.repeat(HOLDS_V, TIMES_S.size)
    times = np.tile(TIMES_S, len(HOLDS_V))
    exact = np.concatenate([_shift_V(truth, volts, TIMES_S, gaps) for volts in HOLDS_V])
    columns = {
        "hold": holds,
        "time": times,
        "shift": exact + ERROR_V * rng.standard_normal(exact.size),
        "shift_error": np.full(exact.size, ERROR_V),
    }
    data = Measurements("drift", columns, ("made up",) * exact.size, False, 0.0, "made up")
    drift = narrow_rates(data, drift_model(data, gaps, 0.0, 0.0, SETTINGS), SETTINGS)
    for name, (volts, seconds) in FORETOLD.items():
        time = np.array([seconds])
        shifts = [_shift_V(draw, volts, time, gaps, COARSE)[0] for draw in drift.x[:DRAWS]]
        known = float(_shift_V(truth, volts, time, gaps)[0])
        low, middle, high = np.quantile(shifts, [0.05, 0.5, 0.95]).tolist()
        anywhere = prior.sample(DRAWS // 2, seed)
        before = [_shift_V(draw, volts, time, gaps, COARSE)[0] for draw in anywhere]
        yield {
            "seed": seed,
            "foretold": name,
            "hold_V": volts,
            "time_s": seconds,
            "truth_V": known,
            "q05_V": low,
            "q50_V": middle,
            "q95_V": high,
            "prior_width_V": float(np.ptp(np.quantile(before, [0.05, 0.95]))),
            "inside": low <= known <= high,
            "converged": drift.chain.converged,
            "probability": drift.probability,
        }


def _shift_V(draw: Array, hold_V: float, times: Array, gaps: HeldGaps, lost: Array = LOST) -> Array:
    """Mean shift of the pulled area."""
    shifts = shifts_V(hold_V, GAPS_NM, times, gaps.device, SETTINGS, rates_of(draw), lost)
    return gaps.mean_V(shifts)


def figures(rows: Sequence[dict[str, str]]) -> dict[str, str]:
    """How many truths lie inside, and how much narrower the interval is than before."""
    said = {}
    for name in FORETOLD:
        some = [row for row in rows if row["foretold"] == name]
        inside = sum(row["inside"] == "True" for row in some)
        widths = [
            (float(row["q95_V"]) - float(row["q05_V"])) / float(row["prior_width_V"])
            for row in some
        ]
        said[name] = f"{inside} of {len(some)}"
        said[f"{name}_width"] = f"{100 * np.median(widths):.0f} %"
    return said
