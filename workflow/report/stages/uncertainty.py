"""Uncertainty of the law: Table 2."""

from collections.abc import Iterator

import numpy as np

from workflow.report.available import CsvRow, Results
from workflow.report.drawing import BLUE, ORANGE, SOFT, draw
from workflow.report.gates import faint_outputs
from workflow.report.numbers import OUTPUTS, column, number, show
from workflow.report.page import Block, Figure, PageTable, stage

COLORS = {"closing": BLUE, "opening": ORANGE}


@stage(
    "The uncertainty of the law",
    *("uncertainty/outputs.csv", "uncertainty/samples.csv"),
    also=("uncertainty/surrogate.json", "uncertainty/validation.csv"),
)
def describe(results: Results) -> Iterator[Block]:
    """The law's band, and Table 2."""
    paper = results.beside_paper
    yield (
        "The distributions of the inputs sent through the response (regression; mean over random"
        " surfaces). Grey rows are not to be trusted: see responses, below."
        + " Beside it the paper's method, a plane through 2n + 1 runs of each surface, and its "
        "Table 2." * paper
    )
    if results.has("uncertainty/law.csv", "uncertainty/surrogate.json"):
        yield Figure(
            band(results),
            "The law of one cell, closing and after the largest load, up to the pressure that it"
            " was fitted to: median and 5 to 95 % over the inputs.",
        )
    yield _table2(results)
    yield (
        "At the separation d_c of the mean planes the contact begins to push. C_r and ρ_r are scale"
        " and decay length of the repulsion: a contact of large ρ_r is soft. C_a is the adhesion"
        " per nanometre of approach."
    )
    if paper:
        yield (
            "The readings of the contact model and the definition of d_c were chosen by their"
            " nearness to the paper's Tables 2 and 3 (reproduction audit), so that part of the"
            " agreement is built in."
        )


def band(results: Results) -> str:
    """Median and spread of the law over the samples of the inputs, up to the pressure that it was
    fitted to.
    """
    rows = results.csv("uncertainty/law.csv")
    highest = results.fitted_MPa
    spread = {}
    for name in COLORS:
        of_branch = [row for row in rows if row["branch"] == name]
        spread[name] = (
            column(of_branch, "gap_nm"),
            *(column(of_branch, f"pressure_q{q}_GPa") * 1e3 for q in ("05", "50", "95")),
        )
    # separations between the largest pressure and the last contact
    reach = max(float(gap[high > 0].max(initial=0)) for gap, _, _, high in spread.values())
    near = min(float(gap[middle < highest].min()) for gap, _, middle, _ in spread.values())

    def plot(axis):
        for name, color in COLORS.items():
            x, low, middle, high = spread[name]
            inside = middle <= highest
            axis.fill_between(
                x, low, np.minimum(high, highest), color=color, alpha=0.16, linewidth=0
            )
            axis.plot(x[inside], middle[inside], color=color, label=f"{name}, median")
        axis.axhline(0, color=SOFT, linewidth=0.8)
        axis.set(xlim=(max(0.0, 2 * near - reach), 1.05 * reach), ylim=(-0.05 * highest, highest))
        axis.set(xlabel="mean separation (nm)", ylabel="contact pressure (MPa)")
        axis.fill_between([], [], [], color=SOFT, alpha=0.3, label="5 to 95 %")
        axis.legend()

    return draw(
        "law", "Contact pressure against separation with the spread over uncertain inputs", plot
    )


def _table2(results: Results) -> PageTable:
    """Table 2, each number under the method that gave it."""
    paper = results.beside_paper
    rows = {row["output"]: row for row in results.csv("uncertainty/outputs.csv")}
    checks = results.rows("uncertainty/validation.csv")
    explained = {row["output"]: number(row["explained"]) for row in checks}
    header = ("output", "by the response (mean ± dev)")
    if paper:
        header += ("by the paper's method, here", "the paper", "the paper, labels exchanged")
        header += ("paper's method less the paper, in scatters of one surface",)
    header += (
        "runs at central inputs, mean over surfaces",
        "their scatter",
        "the response explains, of what inputs can",
    )
    lines = []
    faint = []
    for name, (symbol, unit, factor) in OUTPUTS.items():
        if name not in rows:
            continue
        row: CsvRow = rows[name]
        panels = {
            key: show(number(value) * factor)
            for key, value in row.items()
            if key not in ("output", "unit")
        }
        cells = [f"{symbol} ({unit})", f"{panels['response_mean']} ± {panels['response_dev']}"]
        if paper:
            exchanged = f"{panels['paper_mean_exchanged']} ± {panels['paper_dev_exchanged']}"
            printed = f"{panels['paper_mean']} ± {panels['paper_dev']}"
            if exchanged == printed:
                exchanged = "–"
            cells += [f"{panels['mean']} ± {panels['dev']}", printed, exchanged]
            cells.append(show(row["mean_difference_in_seed_sd"]))
        share = explained.get(name, np.nan)
        cells += [
            panels["centre"],
            panels["centre_seed_sd"],
            f"{max(share, 0):.0%}" if np.isfinite(share) else "–",
        ]
        lines.append(tuple(cells))
        if name in faint_outputs(results):
            faint.append(cells[0])
    caption = (
        "Law parameters on closing and their change on opening" + " (the paper's Table 2)" * paper
    )
    return PageTable(caption, header, lines, faint=faint)
