"""Settings of the report."""

from pydantic import Field

from mesoscale.settings import Settings


class ReportSettings(Settings):
    """The page report.html (docs/report.md)."""

    studies: bool = Field(
        default=False,
        description="also run the accuracy and stability studies of all stages and show their tables",
    )
