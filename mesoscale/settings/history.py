"""Settings of repeated closing, with and without creep."""

from asperity.guards.settings import Settings, key

DWELL_STEPS = 12
"""Times within a dwell at which the contact is solved, evenly in ln(1 + t/t0)."""
CREEP_TIME_S = 1.0
"""t0 of the creep laws: the hardness of the inputs is that of fast contacts, up to about this time.
"""
SURFACES = 4
"""Surfaces that are followed."""


class HistorySettings(Settings):
    """Repeated closing of one surface under creep (docs/history.md); off by default."""

    cycles: int = key(
        0, "closing-opening cycles of each surface; 0: the stage is not run", "[0, 10_000]"
    )
    dwell_s: float = key(
        0.0,
        "time that every cycle holds the largest force, while the hardness falls; 0: no creep",
        "[0, 1e12] s",
    )
    creep_strength: float = key(
        0.02, "c: hardness as 1/(1 + c ln(1 + t/t0)), c lost per e-fold of time", "[0, 10]"
    )
    creep_exponent: float | None = key(
        None,
        "m: hardness as (1 + m t/t0)^(-1/m) instead; an asperity's pressure p relaxes at the rate"
        " (p/H)^m",
        "[1, 1000]",
    )
