"""What do rests and alternating polarity leave of ten years of charge?

A made-up switch is driven at 70 V by the central guess of the rates, in cycles of 1 ms, 1 s and
1 h. Beside each shift stands that by held time alone, without a leak.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from mesoscale.charging.cycles import driven_V
from mesoscale.charging.gaps import GAPS_NM
from mesoscale.charging.rates import guesses
from mesoscale.settings import DeviceSettings, LifetimeSettings
from mesoscale.studies.lifetime_stability import made_up_gaps

HOLD_V = 70.0
TEN_YEARS_S = 3.15576e8
PERIODS_S = {"ms": 1e-3, "s": 1.0, "h": 3600.0}
DRIVES = ((1.0, 0.0), (0.5, 0.0), (0.1, 0.0), (0.01, 0.0), (1.0, 0.1), (1.0, 0.4), (0.5, 0.4))
"""Shares of the time that it is held, and of that of the other polarity."""
EXPONENTS = (0.05, 0.175, 0.3)


def rows(_given: Any) -> Iterator[dict[str, Any]]:
    """A row for each drive, period and exponent of recovery."""
    gaps = made_up_gaps(DeviceSettings())
    end = np.array([TEN_YEARS_S])
    for duty, other in DRIVES:
        settings = LifetimeSettings(years=10.0, duty=duty, other_polarity=other)
        rates = guesses(settings)["central"]
        held = driven_V(HOLD_V, GAPS_NM, end, gaps.device, settings, rates)
        for period_s in PERIODS_S.values():
            in_cycles = settings.model_copy(update={"period_s": period_s})
            for exponent in EXPONENTS:
                leaking = replace(rates, recovery_exponent=exponent)
                shifts = driven_V(HOLD_V, GAPS_NM, end, gaps.device, in_cycles, leaking)
                yield {
                    "duty": duty,
                    "other_polarity": other,
                    "period_s": period_s,
                    "exponent": exponent,
                    "shift_V": float(gaps.mean_V(shifts)[0]),
                    "by_held_time_V": float(gaps.mean_V(held)[0]),
                }


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Shifts by the middle exponent at periods of 1 ms and 1 h."""
    said = {}
    for row in rows:
        if float(row["exponent"]) != EXPONENTS[1]:
            continue
        percent = (100.0 * float(row[key]) for key in ("duty", "other_polarity"))
        name = "duty_{:.0f}_other_{:.0f}".format(*percent)
        said[f"{name}_held"] = f"{float(row['by_held_time_V']):.2f} V"
        period = next(name for name, of in PERIODS_S.items() if of == float(row["period_s"]))
        said[f"{name}_{period}"] = f"{float(row['shift_V']):.2f} V"
    return said
