"""The compact law of the curves at central inputs."""

from collections.abc import Iterator

from mesoscale.law.parameters import LAW
from workflow.report.available import Results
from workflow.report.numbers import cell
from workflow.report.page import Block, stage, table


@stage("The law of one cell", "law/nominal.csv", also=("law/parameters.csv",))
def describe(results: Results) -> Iterator[Block]:
    """The parameters of each curve."""
    yield (
        "The force-separation law is fitted to both branches of each curve at central inputs, and"
        " to those of every run of the design."
    )
    columns = {f"{row.symbol} ({row.unit})": cell(row.name) for row in LAW}
    yield table(
        "The law of each curve; a residual is a share of the largest force",
        results.csv("law/nominal.csv"),
        {
            "curve": "curve",
            "branch": "branch",
            **columns,
            "residual": cell("residual"),
            "fit": "status",
        },
        heads=2,
    )
