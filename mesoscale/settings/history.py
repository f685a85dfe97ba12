"""Settings of repeated closing, with and without creep."""

from typing import Literal

from pydantic import Field, model_validator

from mesoscale.settings.base import Settings

DWELL_STEPS = 12
"""Times within a dwell at which the contact is solved, evenly in ln(1 + t/t0)."""


class HistorySettings(Settings):
    """Repeated closing of one surface, held closed under creep (docs/history.md); off by default."""

    cycles: int = Field(
        default=0,
        ge=0,
        le=100000,
        description="closing-opening cycles of each surface; 0: the stage is not run",
    )
    seeds: int = Field(default=4, ge=1, le=1000, description="surfaces that are followed")
    creep: Literal["none", "power", "logarithmic"] = Field(
        default="none",
        description="how the hardness falls while the contact is held: not, as (1 + m t/t0)^(-1/m), or as "
        "1/(1 + c ln(1 + t/t0))",
    )
    dwell_s: float = Field(
        default=0.0,
        ge=0,
        le=1e12,
        description="time that every cycle holds the largest force; needs a creep law",
        json_schema_extra={"unit": "s"},
    )
    creep_time_s: float = Field(
        default=1.0, ge=1e-12, le=1e12, description="t0 of the creep laws", json_schema_extra={"unit": "s"}
    )
    creep_exponent: float = Field(
        default=30.0,
        ge=1,
        le=1000,
        description="m: an asperity's pressure p relaxes at the rate (p/H)^m",
    )
    creep_strength: float = Field(
        default=0.02,
        ge=0,
        le=10,
        description="c: share of the hardness lost per e-fold of time",
    )

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
