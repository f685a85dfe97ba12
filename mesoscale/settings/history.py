"""Settings of repeated closing, with and without creep."""

from typing import Literal

from pydantic import model_validator

from asperity.guards.settings import Settings, key

DWELL_STEPS = 12
"""Times within a dwell at which the contact is solved, evenly in ln(1 + t/t0)."""


class HistorySettings(Settings):
    """Repeated closing of one surface, held closed under creep (docs/history.md); off by default."""

    cycles: int = key(0, "closing-opening cycles of each surface; 0: the stage is not run", "[0, 100_000]")
    seeds: int = key(4, "surfaces that are followed", "[1, 1000]")
    creep: Literal["none", "power", "logarithmic"] = key(
        "none",
        "how the hardness falls while the contact is held: not, as (1 + m t/t0)^(-1/m), or as 1/(1 + c ln(1 + t/t0))",
    )
    dwell_s: float = key(0.0, "time that every cycle holds the largest force; needs a creep law", "[0, 1e12] s")
    creep_time_s: float = key(1.0, "t0 of the creep laws", "[1e-12, 1e12] s")
    creep_exponent: float = key(30.0, "m: an asperity's pressure p relaxes at the rate (p/H)^m", "[1, 1000]")
    creep_strength: float = key(0.02, "c: share of the hardness lost per e-fold of time", "[0, 10]")

    @model_validator(mode="after")
    def _a_dwell_needs_creep(self) -> "HistorySettings":
        if self.dwell_s > 0 and self.creep == "none":
            raise ValueError(
                f"dwell_s = {self.dwell_s:g} with creep = none: nothing would happen; choose creep: power or "
                "logarithmic, or dwell_s: 0"
            )
        if self.creep != "none" and self.dwell_s == 0:
            raise ValueError(f"creep = {self.creep} with dwell_s = 0: give the time of each hold in s")
        return self
