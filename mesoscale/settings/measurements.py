"""Settings of measurements and of the calibration with them."""

from typing import Literal

from pydantic import Field, model_validator

from mesoscale.settings.base import Settings


class MeasurementTable(Settings):
    """One table of measurements."""

    kind: Literal[
        "closing_curves",
        "opening_curves",
        "contact_begin",
        "pull_off",
        "hardness",
        "modulus",
        "release",
        "pull_in",
        "sticking",
    ] = Field(description="what was measured")
    file: str = Field(description="CSV file, its columns named with their units (docs/calibration.md)")
    zero: Literal["unknown", "known"] = Field(
        default="unknown",
        description="curves: whether separations count from the mean plane, or from a zero that is unknown for each "
        "specimen",
    )
    discrepancy: float = Field(
        default=0.0,
        ge=0,
        le=1000,
        description="standard deviation of the model's own error, common to all data of the table: in nm for curves "
        "and contact_begin, else a share of the value",
    )
    source: str = Field(default="", description="where the measurements come from, shown in the report")


class MeasurementsSettings(Settings):
    """Measurements and the calibration of the inputs with them (docs/calibration.md); off without tables."""

    tables: tuple[MeasurementTable, ...] = Field(
        default=(), description="tables of measurements, one of each kind at most; none: the stage is not run"
    )
    runs: int = Field(
        default=800, ge=50, le=10**6, description="contact cycles over the whole prior behind the responses"
    )
    local_runs: int = Field(
        default=300, ge=20, le=10**6, description="contact cycles where the posterior lies, added at a time"
    )
    rounds: int = Field(
        default=3,
        ge=0,
        le=20,
        description="how often they are added at most, until the responses are exact enough",
    )

    @model_validator(mode="after")
    def _one_table_of_a_kind(self) -> "MeasurementsSettings":
        kinds = [table.kind for table in self.tables]
        twice = sorted({kind for kind in kinds if kinds.count(kind) > 1})
        if twice:
            raise ValueError(f"tables: {', '.join(twice)} given twice; put all data of a kind into one table")
        return self
