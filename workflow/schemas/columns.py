"""Columns that tables of several stages have."""

from mesoscale.law.parameters import LAW
from mesoscale.settings.definitions import INPUTS
from workflow.schemas.table import integer, number, text

INPUT_VALUES = tuple(
    number(row.name, row.unit, f"{row.label} of the run", optional=row.may_lack) for row in INPUTS
)
"""One column per uncertain input in use."""
LAW_VALUES = tuple(number(row.name, row.unit, row.meaning, empty=True) for row in LAW)
SEED = integer("seed", "seed of the random surface")
BRANCH = text("branch", "closing or opening")
