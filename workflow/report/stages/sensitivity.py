"""What matters for the law of one cell: Table 3."""

from collections.abc import Iterator

from workflow.report.available import Results
from workflow.report.gates import faint_outputs
from workflow.report.numbers import OUTPUTS, SYMBOLS, number, show
from workflow.report.page import Block, PageTable, stage


@stage("What matters for the law of one cell", "uncertainty/sensitivity.csv")
def describe(results: Results) -> Iterator[Block]:
    """Table 3."""
    paper = results.beside_paper
    faint = faint_outputs(results)
    rows = results.csv("uncertainty/sensitivity.csv")
    names = list(dict.fromkeys(row["input"] for row in rows))
    by_pair = {(row["output"], row["input"]): row for row in rows}
    lines = []
    grey = []
    for output, (symbol, unit, factor) in OUTPUTS.items():
        if not any(row["output"] == output for row in rows):
            continue
        cells = [f"{symbol} ({unit})"]
        for name in names:
            row = by_pair.get((output, name), {})
            ours = number(row.get("mu_star")) * factor
            theirs = number(row.get("paper_mu_star")) * factor
            effect = show(ours, 2)
            if paper:
                effect += f" ({show(theirs, 2)})"
            cells.append(effect)
        lines.append(cells)
        if output in faint:
            grey.append(cells[0])
    beside = ""
    caption = "Elementary effects µ*"
    if paper:
        beside = ", beside the paper's Table 3"
        caption += " here (and in the paper's Table 3)"
    yield (
        "Mean elementary effect µ*: by how much an output changes when one input moves over its"
        f" full range, averaged over the others, by runs at the nodes{beside}. Grey rows are not to"
        " be trusted."
    )
    yield PageTable(
        caption, ("output", *(SYMBOLS.get(name, name) for name in names)), lines, faint=grey
    )
    if paper:
        yield (
            "For the closing rows C_a and C_r the paper's Table 3 is read with its two labels"
            " exchanged, the only reading consistent with its Table 2."
        )
