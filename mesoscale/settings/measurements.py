"""Settings of measurements and of the calibration with them."""

from typing import Literal

from pydantic import model_validator

from asperity.guards.settings import Settings, key


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
        "drift",
    ] = key(..., "what was measured")
    file: str = key(..., "CSV file, its columns named with their units (docs/calibration.md)")
    zero: Literal["unknown", "known"] = key(
        "unknown",
        "whether separations of curves count from the mean plane, or each specimen has its own"
        " zero",
    )
    discrepancy: float = key(
        0.0,
        "standard deviation of the model's error: nm for curves and contact_begin, else a share",
        "[0, 1000]",
    )
    source: str = key("", "where the measurements come from, shown in the report")


class MeasurementsSettings(Settings):
    """Measurements that calibrate the inputs (docs/calibration.md); off without tables."""

    tables: tuple[MeasurementTable, ...] = key(
        (), "tables, one of each kind at most; none: not run"
    )
    runs: int = key(
        800,
        "contact cycles over the whole prior behind the responses; more follow where the posterior"
        " lies",
        "[50, 1_000_000]",
    )

    @property
    def of_inputs(self) -> tuple[MeasurementTable, ...]:
        """Tables that narrow the inputs; a drift narrows the rates of `lifetime`."""
        return tuple(table for table in self.tables if table.kind != "drift")

    @property
    def drift(self) -> MeasurementTable | None:
        """The table of drift."""
        return next((table for table in self.tables if table.kind == "drift"), None)

    @model_validator(mode="after")
    def _one_table_of_a_kind(self) -> "MeasurementsSettings":
        kinds = [table.kind for table in self.tables]
        twice = sorted({kind for kind in kinds if kinds.count(kind) > 1})
        if twice:
            raise ValueError(
                f"tables: {', '.join(twice)} given twice; put all data of a kind into one table"
            )
        return self
