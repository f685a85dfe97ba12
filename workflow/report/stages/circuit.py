"""The switch as a circuit sees it."""

import numpy as np

from workflow.report.available import Results
from workflow.report.drawing import BLUE, ORANGE, draw
from workflow.report.numbers import column, show
from workflow.report.page import COMPUTED, Section, Table
from workflow.report.verdict import volts


def describe(results: Results) -> Section | None:
    """C-V loop with its band, and failure rate; pull-in and release of the corners."""
    files = [f"device/{name}" for name in ("circuit.json", "circuit.csv", "loop.csv", "failure.csv")]
    if not results.has(*files):
        return None
    circuit, rows = results.json("device/circuit.json"), results.csv("device/circuit.csv")
    errors = circuit["lumps"]
    corners = [row for row in rows if float(row["deviations"]) > 0]
    section = Section(
        "circuit",
        "In a circuit",
        "The folder device/circuit has the switch as SPICE netlists: central, four corners and "
        f"{len(rows) - len(corners)} draws. {errors['lumps']} pairs of lumps stand for the electrode. Beside finite "
        f"elements pull-in differs by {errors['pull_in']:.1%}, release by {errors['release']:.1%}; these err by "
        f"{errors['reference']:.1%}.",
        COMPUTED,
        files=files,
    )
    section.add(
        _figure(results),
        "Left: slow loop; the bands hold 90 % of the draws. Right: share that fails against hold voltage.",
        wide=True,
    )
    lines = [
        (row["switch"], show(float(row["deviations"])), volts(float(row["pull_in_V"])), volts(float(row["release_V"])))
        for row in corners
    ]
    section.blocks.append(Table("Corners", ("corner", "standard deviations out", "pull-in", "release"), lines))
    return section


def _figure(results: Results) -> str:
    loop, failing = results.csv("device/loop.csv"), results.csv("device/failure.csv")

    def plot(slow, rare):
        voltage = column(loop, "voltage_V")
        for way, color in (("up", BLUE), ("down", ORANGE)):
            low, high = (column(loop, f"{way}_{end}_fF") / 1e3 for end in ("q05", "q95"))
            slow.fill_between(voltage, low, high, color=color, alpha=0.2, linewidth=0)
            slow.plot(voltage, column(loop, f"{way}_central_fF") / 1e3, color=color, label=way)
        slow.set(xlabel="voltage (V)", ylabel="capacitance (pF)", title="slow loop")
        slow.legend()
        usual = [row for row in failing if np.isclose(float(row["attraction"]), 1.0)]
        share = column(usual, "failing")
        rare.plot(column(usual, "hold_V"), np.where(share > 0, share, np.nan), "o-", color=BLUE)
        rare.set(yscale="log", xlabel="hold voltage (V)", ylabel="share of switches", title="failures")

    return draw("circuit", "Capacitance and failures of the switch", plot, (9.4, 3.3), columns=2)
