"""Settings of the failure rate."""

from pydantic import Field

from mesoscale.settings.base import Settings


class FailureSettings(Settings):
    """Rate at which switches fail (docs/failure.md); off by default."""

    probability: float | None = Field(
        default=None,
        gt=0,
        lt=1,
        description="share of the switches that may fail, such as 1e-6; null: the stage is not run",
    )
    release_V: float = Field(
        default=0.0,
        ge=0,
        le=1e5,
        description="a switch that is still closed at this voltage has failed; 0: one that sticks",
        json_schema_extra={"unit": "V"},
    )
