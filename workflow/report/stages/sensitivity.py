"""What matters: Table 3."""

import numpy as np

from workflow.report.available import Results, Row
from workflow.report.drawing import BLUE, ORANGE, SOFT, draw
from workflow.report.numbers import OUTPUTS, SYMBOLS, column, number, show
from workflow.report.page import COMPUTED, Section, Table
from workflow.report.verdict import release_causes


def describe(results: Results) -> Section | None:
    """Table 3."""
    if not results.has("uq/sensitivity.csv"):
        return None
    rows = results.csv("uq/sensitivity.csv")
    names = list(dict.fromkeys(row["input"] for row in rows))
    section = Section(
        "sensitivity",
        "What matters",
        "Mean elementary effect µ* of every input over its full range"
        + (", beside the paper's Table 3." if results.beside_paper else "."),
        COMPUTED,
    )
    outputs = [name for name in OUTPUTS if any(row["output"] == name for row in rows)]
    part = {(row["output"], row["input"]): row for row in rows}
    lines = []
    for name in names:
        cells = [SYMBOLS.get(name, name)]
        for output in outputs:
            factor = OUTPUTS[output][2]
            row = part.get((output, name), {})
            ours, paper = number(row.get("mu_star")) * factor, number(row.get("paper_mu_star")) * factor
            cells.append(f"{show(ours, 2)} ({show(paper, 2)})" if results.beside_paper else show(ours, 2))
        lines.append(cells)
    header = ("input", *(f"{OUTPUTS[name][0]} ({OUTPUTS[name][1]})" for name in outputs))
    section.blocks.append(
        Table("Elementary effects µ*" + " here (and in the paper)" * results.beside_paper, header, lines)
    )
    if causes := release_causes(results):
        shares = {symbol: share for symbol, share in causes}
        d_c = {SYMBOLS.get(name, name): share for name, share in ranking(rows, "d_c_nm")}
        lines = [
            (name, *("–" if share is None else f"{share:.0%}" for share in (d_c.get(name), shares.get(name))))
            for name in dict.fromkeys([*d_c, *shares])
        ]
        header = ("cause", "of the variance of d_c", "of the variance of the release voltage")
        section.blocks.append(
            Table("Share of the spread: where contact begins, and when the switch lets go", header, lines)
        )
        section.files.append("device/pad_switch.json")
    section.add(
        sensitivity_bars(results),
        "The same as bars; lines: scatter over surfaces.",
        "Table 3",
        wide=True,
    )
    if results.beside_paper:
        section.notes.append(
            "For the closing columns C_a and C_r the paper's Table 3 is read with its two labels exchanged, "
            "the only reading consistent with its Table 2."
        )
    section.files.append("uq/sensitivity.csv")
    return section


def ranking(rows: list[Row], output: str) -> list[tuple[str, float]]:
    """Inputs by their share of an output's variance (total Sobol' index), or of the summed squares of the
    elementary effects where no index was computed; largest first."""
    part = [row for row in rows if row["output"] == output]
    if any(np.isfinite(number(row.get("sobol_total"))) for row in part):
        shares = [(row["input"], number(row["sobol_total"])) for row in part]
    else:
        squares = column(part, "mu_star") ** 2
        whole = np.nansum(squares)
        shares = [(row["input"], s / whole if whole > 0 else 0) for row, s in zip(part, squares, strict=True)]
    known = [(name, share) for name, share in shares if np.isfinite(share)]
    return sorted(known, key=lambda pair: -pair[1])


def sensitivity_bars(results: Results) -> str:
    """Table 3 as bars: elementary effects of each output."""
    rows = results.csv("uq/sensitivity.csv")
    names = [name for name in OUTPUTS if any(row["output"] == name for row in rows)]
    inputs = list(dict.fromkeys(row["input"] for row in rows))

    def plot(*axes):
        places = np.arange(len(inputs))
        for axis, name in zip(axes, names, strict=False):
            symbol, unit, factor = OUTPUTS[name]
            part = {row["input"]: row for row in rows if row["output"] == name}
            ours = np.array([number(part[key]["mu_star"]) for key in inputs]) * factor
            spread = np.array([number(part[key].get("mu_star_seed_sd")) for key in inputs]) * factor
            paper = np.array([number(part[key].get("paper_mu_star")) for key in inputs]) * factor
            bars = {"xerr": np.nan_to_num(spread), "error_kw": {"ecolor": SOFT, "elinewidth": 1}}
            if results.beside_paper:
                axis.barh(places - 0.2, ours, 0.38, color=BLUE, label="here", **bars)
                axis.barh(places + 0.2, np.nan_to_num(paper), 0.38, color=ORANGE, label="paper")
            else:
                axis.barh(places, ours, 0.6, color=BLUE, **bars)
            axis.set(title=f"{symbol} ({unit})", yticks=places, ylim=(len(inputs) - 0.5, -0.5))
            axis.set_yticklabels([SYMBOLS.get(key, key) for key in inputs])
            axis.tick_params(labelleft=True)  # on every panel, as narrow screens show each by itself
            axis.grid(axis="y", visible=False)
            axis.set_xlim(left=0)
        if results.beside_paper:
            axes[0].legend()

    return draw("table3fig", "Elementary effects of each input on each output", plot, (9.8, 5.6), 4, 2, sharey=True)
