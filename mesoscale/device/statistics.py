"""Distributions of what switches do, and what is known of one without solving it."""

from typing import Any

import numpy as np

from mesoscale.device.switch import NM, VACUUM_PERMITTIVITY, Switch
from mesoscale.settings import DeviceSettings

PULL_IN = 1e-3
"""Error of pull-in by the number of elements."""
QUANTILES = (0.05, 0.16, 0.25, 0.5, 0.75, 0.84, 0.95)


def describe(values: np.ndarray) -> dict[str, Any]:
    """Mean, deviation and quantiles of the finite values."""
    values = np.asarray(values, dtype=float)
    finite = values[np.isfinite(values)]
    if finite.size == 0:
        return {"samples": 0, "mean": None, "std": None, "quantiles": {}}
    quantiles = np.quantile(finite, QUANTILES)
    return {
        "samples": int(finite.size),
        "mean": float(finite.mean()),
        "std": float(finite.std(ddof=1)) if finite.size > 1 else 0.0,
        "quantiles": {f"{q:g}": float(value) for q, value in zip(QUANTILES, quantiles, strict=True)},
    }


def probability(count: int, total: int) -> dict[str, float | int]:
    """Share of `count` in `total` with its 95 % Wilson interval, which stays sensible at 0 and 1."""
    from scipy.stats import binomtest  # slow to import

    ends = binomtest(count, total).proportion_ci(0.95, method="wilson")
    return {
        "value": count / total,
        "low": float(ends.low),
        "high": float(ends.high),
        "count": int(count),
        "samples": int(total),
    }


def analytic_pull_in_V(switch: Switch) -> float:
    """Pull-in of an ideal plate: sqrt(8 k (g + t/eps)^3 / (27 eps0 A))."""
    gap = (switch.gap_nm + switch.dielectric_nm) * NM
    return float(np.sqrt(8 * switch.spring_N_per_m * gap**3 / (27 * VACUUM_PERMITTIVITY * switch.area_m2)))


def never_closes(settings: DeviceSettings, pull_in_V: float) -> str:
    """One line on a hold voltage below pull-in, which never closes the switch; empty where there is none.

    A switch that is closed by more and then held by less has the deepest closing, and so the release, of the former.
    """
    hold = settings.hold_voltage_V
    if hold is None or hold >= (1.0 - PULL_IN) * pull_in_V:
        return ""
    return (
        f"device.hold_voltage_V = {hold:.4g}: never closes this switch, which pulls in at {pull_in_V:.4g} V; give the "
        "largest voltage that it is closed with, or null for pull-in itself"
    )
