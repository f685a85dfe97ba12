"""What the short-wave cut-off and the grid do to the outputs."""

from workflow.report.available import Results
from workflow.report.numbers import OUTPUTS, number, show
from workflow.report.page import COMPUTED, Section, Table
from workflow.report.stages.model_form import SWITCH


def describe(results: Results) -> Section | None:
    """Means over the same surfaces for other cut-offs on the scene's grid, and for other grids at its cut-off."""
    if not results.has("uq/cutoff.csv"):
        return None
    rows = results.csv("uq/cutoff.csv")
    section = Section(
        "cut-off",
        "What the cut-off and the grid do",
        f"{rows[0]['cycles']} surfaces at the medians of the inputs, with all other waves as they are. Rows of one "
        "cut-off and several grids tell the error of the grid; those of one grid tell what the roughness beyond the "
        "cut-off would change.",
        COMPUTED,
    )
    symbols = {**OUTPUTS, **SWITCH}
    header = [f"{symbol} ({unit})" if unit else symbol for symbol, unit, _ in symbols.values()]
    lines = [
        (
            show(row["q1_per_nm"], 3),
            row["pixels"],
            *(show(number(row[name]) * factor) for name, (_, _, factor) in symbols.items()),
            show(row["cpu_s"], 2),
        )
        for row in rows
    ]
    header = ("q₁ (1/nm)", "pixels", *header, "CPU (s)")
    section.blocks.append(Table("Means over the surfaces", header, lines, heads=2))
    section.files.append("uq/cutoff.csv")
    return section
