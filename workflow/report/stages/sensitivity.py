"""What matters for the law of one cell: Table 3."""

from workflow.report.available import Results
from workflow.report.gates import faint_outputs
from workflow.report.numbers import OUTPUTS, SYMBOLS, number, show
from workflow.report.page import COMPUTED, Section, Table


def describe(results: Results) -> Section | None:
    """Table 3."""
    if not results.has("uq/sensitivity.csv"):
        return None
    rows = results.csv("uq/sensitivity.csv")
    names = list(dict.fromkeys(row["input"] for row in rows))
    part = {(row["output"], row["input"]): row for row in rows}
    faint = faint_outputs(results)
    lines, grey = [], []
    for output, (symbol, unit, factor) in OUTPUTS.items():
        if not any(row["output"] == output for row in rows):
            continue
        cells = [f"{symbol} ({unit})"]
        for name in names:
            row = part.get((output, name), {})
            ours, paper = number(row.get("mu_star")) * factor, number(row.get("paper_mu_star")) * factor
            cells.append(f"{show(ours, 2)} ({show(paper, 2)})" if results.beside_paper else show(ours, 2))
        lines.append(cells)
        grey += [cells[0]] if output in faint else []
    section = Section(
        "sensitivity",
        "What matters for the law of one cell",
        "Mean elementary effect µ* of every input over its full range, by runs at the nodes"
        + (", beside the paper's Table 3." if results.beside_paper else ".")
        + " Grey rows are not to be trusted.",
        COMPUTED,
        files=["uq/sensitivity.csv"],
    )
    caption = "Elementary effects µ*" + " here (and in the paper's Table 3)" * results.beside_paper
    header = ("output", *(SYMBOLS.get(name, name) for name in names))
    section.blocks.append(Table(caption, header, lines, faint=grey))
    if results.beside_paper:
        section.notes.append(
            "For the closing rows C_a and C_r the paper's Table 3 is read with its two labels exchanged, "
            "the only reading consistent with its Table 2."
        )
    return section
