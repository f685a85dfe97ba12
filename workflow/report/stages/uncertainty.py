"""Uncertainty of the law: Table 2."""

import numpy as np

from workflow.report.available import Results, Row
from workflow.report.drawing import BLUE, GREEN, ORANGE, SKY, SOFT, draw
from workflow.report.numbers import OUTPUTS, column, number, show
from workflow.report.page import COMPUTED, Section, Table


def describe(results: Results) -> Section | None:
    """Table 2."""
    if not results.has("uq/outputs.csv", "uq/samples.csv"):
        return None
    rows = {row["output"]: row for row in results.csv("uq/outputs.csv")}
    paper = results.beside_paper
    section = Section(
        "uncertainty",
        "Uncertainty of the law",
        f"The distributions of the inputs sent through the {results.response}, which is also behind the first screen, "
        "the explorer and the switch."
        + " Beside it the paper's method, a plane through 2n + 1 runs of each surface, and its Table 2."
        * paper,
        COMPUTED,
    )
    header, lines = _table2(rows, paper)
    caption = "Law parameters on closing and their change on opening"
    section.blocks.append(Table(caption + " (the paper's Table 2)" * paper, header, lines))
    section.add(
        output_distributions(results),
        "Distributions of the outputs by the response; circles: their mean and deviation"
        + ("; squares: those of the paper's method here; diamonds: those the paper states." if paper else "."),
        "Table 2",
        wide=True,
    )
    if paper:
        section.notes.append(
            "The readings of the contact model and the definition of d_c were chosen by their nearness to the paper's "
            "Tables 2 and 3 (reproduction audit), so that part of the agreement is built in."
        )
    if results.has("uq/validation.csv"):
        section.add(
            validation_points(results),
            "How well the responses predict independent runs: 1 is perfect, 0 no better than the mean.",
        )
        section.files.append("uq/validation.csv")
    section.files += ["uq/outputs.csv", "uq/samples.csv", "uq/surrogate.json"]
    return section


def _table2(rows: dict[str, Row], paper: bool) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
    """Header and lines of Table 2, each number under the method that gave it."""
    header = ("output", "by the response (mean ± dev)")
    if paper:
        header += ("by the paper's method, here", "the paper", "the paper, labels exchanged")
        header += ("paper's method less the paper, in scatters of one surface",)
    header += ("runs at central inputs, mean over surfaces", "their scatter", "surface's share of variance")
    lines = []
    for name, (symbol, unit, factor) in OUTPUTS.items():
        if name not in rows:
            continue
        row = rows[name]
        shown = {key: show(number(value) * factor) for key, value in row.items() if key not in ("output", "unit")}
        cells = [f"{symbol} ({unit})", f"{shown['response_mean']} ± {shown['response_dev']}"]
        if paper:
            exchanged = f"{shown['paper_mean_exchanged']} ± {shown['paper_dev_exchanged']}"
            printed = f"{shown['paper_mean']} ± {shown['paper_dev']}"
            cells += [f"{shown['mean']} ± {shown['dev']}", printed, exchanged if exchanged != printed else "–"]
            cells.append(show(row["mean_difference_in_seed_sd"]))
        share = number(row["seed_share"])
        cells += [shown["centre"], shown["centre_seed_sd"], f"{share:.0%}" if np.isfinite(share) else "–"]
        lines.append(tuple(cells))
    return header, lines


def output_distributions(results: Results) -> str:
    """Closing parameters and their change, with mean and deviation by each method."""
    samples = results.csv("uq/samples.csv")
    table = {row["output"]: row for row in results.csv("uq/outputs.csv")}
    names = [name for name in OUTPUTS if name in table]

    def plot(*axes):
        for axis, name in zip(axes, names, strict=False):
            symbol, unit, factor = OUTPUTS[name]
            base = name.removeprefix("delta_")
            values = column(samples, f"closing_{base}")
            if name.startswith("delta_"):
                values = column(samples, f"opening_{base}") - values
            values = values[np.isfinite(values)] * factor
            low, high = np.quantile(values, [0.002, 0.998])
            axis.hist(values, bins=50, range=(low, high), density=True, color=BLUE, alpha=0.55, linewidth=0)
            height = axis.get_ylim()[1]
            marks = [("response_mean", "response_dev", "o", BLUE)]
            if results.beside_paper:
                marks += [("mean", "dev", "s", GREEN), ("paper_mean", "paper_dev", "D", ORANGE)]
            for level, (centre, width, marker, color) in enumerate(marks):
                mean, dev = (number(table[name][key]) * factor for key in (centre, width))
                place = (1.06 + 0.11 * level) * height
                axis.errorbar(mean, place, xerr=dev, fmt=marker, color=color, markersize=4, capsize=3)
            axis.set(ylim=(0, (1.08 + 0.11 * len(marks)) * height), yticks=[], xlabel=f"{symbol} ({unit})")
            axis.grid(False)

    return draw(
        "table2fig",
        "Distributions of the eight outputs with mean and deviation",
        plot,
        (9.4, 4.4),
        4,
        2,
    )


def validation_points(results: Results) -> str | None:
    """Responses against independent runs: quantiles of both."""
    rows = [row for row in results.csv("uq/validation.csv") if row.get("q2")]
    if not rows:
        return None

    def plot(axis):
        places = np.arange(len(rows))
        q2 = column(rows, "q2")
        low, high = column(rows, "q2_low"), column(rows, "q2_high")
        axis.errorbar(np.maximum(q2, -1), places, xerr=[q2 - low, high - q2], fmt="o", color=GREEN, capsize=3)
        axis.axvline(1, color=SOFT, linewidth=0.8)
        axis.axvline(0, color=SKY, linewidth=0.8)
        labels = [OUTPUTS.get(row["output"], (row["output"],))[0] for row in rows]
        axis.set(yticks=places, ylim=(len(rows) - 0.5, -0.5), xlim=(-1.05, 1.05), xlabel="Q² on independent runs")
        axis.set_yticklabels(labels)

    return draw("validation", "Predictive quality of the responses", plot, (5.2, 3.2))
