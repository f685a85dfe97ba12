"""Uncertainty of the law: Table 2."""

import numpy as np

from workflow.report.available import Results
from workflow.report.drawing import BLUE, GREEN, ORANGE, SKY, SOFT, draw
from workflow.report.numbers import OUTPUTS, column, number, show
from workflow.report.page import COMPUTED, Section, Table


def describe(results: Results) -> Section | None:
    """Table 2."""
    if not results.has("uq/outputs.csv", "uq/samples.csv"):
        return None
    rows = {row["output"]: row for row in results.csv("uq/outputs.csv")}
    section = Section(
        "uncertainty",
        "Uncertainty of the law",
        "The distributions of the inputs sent through responses of the contact model, beside the paper's Table 2.",
        COMPUTED,
    )
    lines = []
    for name, (symbol, unit, factor) in OUTPUTS.items():
        if name not in rows:
            continue
        row = rows[name]
        values = {key: number(row.get(key)) * factor for key in row if key not in ("output", "unit")}
        exchanged = ""
        if values.get("paper_mean_exchanged", values["paper_mean"]) != values["paper_mean"]:
            exchanged = f"{show(values['paper_mean_exchanged'])} ± {show(values['paper_dev_exchanged'])}"
        lines.append(
            (
                f"{symbol} ({unit})",
                f"{show(values['mean'])} ± {show(values['dev'])}",
                f"{show(values['paper_mean'])} ± {show(values['paper_dev'])}",
                exchanged or "–",
                show(number(row.get("mean_difference_in_seed_sd"))),
                show(values.get("centre")),
                show(values.get("centre_seed_sd")),
                f"{number(row.get('seed_share')):.0%}" if np.isfinite(number(row.get("seed_share"))) else "–",
            )
        )
    header = (
        "output",
        "here (mean ± dev)",
        "paper",
        "paper, labels exchanged",
        "mean less the paper's, in scatters of one surface",
        "at central inputs",
        "its scatter over surfaces",
        "surface's share of variance",
    )
    section.blocks.append(
        Table("Law parameters on closing and their change on opening (the paper's Table 2)", header, lines)
    )
    section.add(
        output_distributions(results),
        "Distributions of the outputs; circles: mean and deviation here, diamonds: in the paper.",
        "Table 2",
        wide=True,
    )
    if results.has("uq/ratios.csv") and results.csv("uq/ratios.csv"):
        header = ("quantity", "from", "here", "scatter of one surface", "paper")
        keys = ("value", "seed_sd", "paper")
        ratios = [
            (row["quantity"], row["from"], *(show(number(row[key])) for key in keys))
            for row in results.csv("uq/ratios.csv")
        ]
        section.blocks.append(Table("Numbers per RMS roughness", header, ratios))
        section.files.append("uq/ratios.csv")
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


def output_distributions(results: Results) -> str:
    """Closing parameters and their change, with the paper's mean and deviation."""
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
            mean, dev = (number(table[name][f"paper_{key}"]) * factor for key in ("mean", "dev"))
            height = axis.get_ylim()[1]
            if np.isfinite(mean):
                axis.errorbar(mean, 1.08 * height, xerr=dev, fmt="D", color=ORANGE, markersize=4, capsize=3)
            own_mean, own_dev = (number(table[name][key]) * factor for key in ("mean", "dev"))
            axis.errorbar(own_mean, 1.2 * height, xerr=own_dev, fmt="o", color=BLUE, markersize=4, capsize=3)
            axis.set(ylim=(0, 1.3 * height), yticks=[], xlabel=f"{symbol} ({unit})")
            axis.grid(False)

    return draw(
        "table2fig",
        "Distributions of the eight outputs beside the paper's mean and deviation",
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
