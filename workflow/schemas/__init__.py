"""Schemas of the CSV result files: their columns with type, unit and meaning.

The writer and the reader of results hold every table to its schema; docs/results.md is made of them
(`python -m workflow.schemas`).
"""

from pathlib import PurePath

from workflow.schemas import (
    answer,
    calibration,
    circuit,
    elastic,
    failure,
    hardness,
    history,
    humidity,
    inputs,
    law,
    lifetime,
    pad,
    studies,
    topography,
    uncertainty,
)
from workflow.schemas.table import Table, UnfitTable

__all__ = ["STAGES", "Table", "UnfitTable", "schema_of"]

STAGES: dict[str, tuple[Table, ...]] = {
    "Hardness": hardness.TABLES,
    "Elastic": elastic.TABLES,
    "Topography": topography.TABLES,
    "Inputs": inputs.TABLES,
    "Law": law.TABLES,
    "Uncertainty": uncertainty.TABLES,
    "Pad": pad.TABLES,
    "Answer": answer.TABLES,
    "Failure": failure.TABLES,
    "Circuit": circuit.TABLES,
    "Humidity": humidity.TABLES,
    "History": history.TABLES,
    "Lifetime": lifetime.TABLES,
    "Calibration": calibration.TABLES,
    "Studies of all stages": studies.TABLES,
}
"""All tables by heading; of two that fit a path, the first one counts."""


def schema_of(path: PurePath) -> Table | None:
    """The schema of a result file; None for a file that is not known."""
    return next(
        (table for tables in STAGES.values() for table in tables if table.is_at(path)), None
    )
