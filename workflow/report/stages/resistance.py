"""Resistance of an ohmic contact against force."""

from collections.abc import Iterator

import numpy as np

from workflow.report.available import Results
from workflow.report.drawing import BLUE, GREEN, ORANGE, draw
from workflow.report.numbers import column, show
from workflow.report.page import Block, Figure, PageTable, stage

COLORS = {"closing": BLUE, "opening": ORANGE, "closing again": GREEN}


@stage("Ohmic contact", "device/resistance.csv")
def describe(results: Results) -> Iterator[Block]:
    """Resistance of a cell while it closes, opens and closes again."""
    rows = results.csv("device/resistance.csv")
    runs = len({row["run"] for row in rows})
    yield (
        f"Electrical resistance of one cell, by its stiffness. {runs} surfaces, each with its own inputs; "
        "intervals hold 90 % of them."
    )
    quantiles = {}
    for way in COLORS:
        part = [row for row in rows if row["way"] == way]
        force, ohm = (column(part, name).reshape(runs, -1) for name in ("force_nN", "resistance_Ohm"))
        quantiles[way] = (np.median(force, axis=0), *np.quantile(ohm, (0.5, 0.05, 0.95), axis=0))

    def plot(axes):
        for way, (force, middle, low, high) in quantiles.items():
            axes.fill_between(force, low, high, color=COLORS[way], alpha=0.15, linewidth=0)
            line = ":" if way == "closing again" else "-"
            axes.plot(force, middle, line, color=COLORS[way], label=way, linewidth=2)
        axes.set(xscale="log", yscale="log", xlabel="force on the cell (nN)", ylabel="resistance (Ω)")
        axes.legend()

    yield Figure(
        draw("resistance", "Resistance against force", plot),
        "A contact that has been pressed keeps its area: it conducts better when it opens and closes again.",
    )
    lines = [
        (
            show(force[k], 3),
            *(f"{show(q[1][k], 3)} [{show(q[2][k], 3)}, {show(q[3][k], 3)}]" for q in quantiles.values()),
        )
        for force in [quantiles["closing"][0]]
        for k in range(len(force))
    ]
    yield PageTable("Resistance (Ω)", ("force (nN)", *quantiles), lines)
