"""The switch as a circuit sees it."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from workflow.report.available import CsvRow, Results
from workflow.report.drawing import BLUE, ORANGE, SOFT, draw
from workflow.report.numbers import cell, column
from workflow.report.page import Block, Figure, stage, table
from workflow.report.verdict import volts


@stage(
    "In a circuit",
    "circuit/circuit.json",
    "circuit/circuit.csv",
    "circuit/loop.csv",
    "failure/failure.csv",
)
def describe(results: Results) -> Iterator[Block]:
    """C-V loop with its band, and failure rate; pull-in and release of the corners."""
    circuit = results.json("circuit/circuit.json")
    rows = results.csv("circuit/circuit.csv")
    errors = circuit["lumps"]
    corners = [row for row in rows if float(row["deviations"]) > 0]
    yield (
        "The folder circuit/models has the switch as SPICE netlists: central, four corners and"
        f" {len(rows) - len(corners)} draws. {errors['lumps']} pairs of lumps stand for the"
        f" electrode. Beside finite elements pull-in differs by {errors['pull_in']:.1%}, release by"
        f" {errors['release']:.1%}; these themselves err by {errors['reference']:.1%}."
    )
    yield Figure(
        _figure(results),
        "Left: slow loop; the bands hold 90 % of the draws. Marks: where it lands, where half of"
        " the held capacitance is left, and where it jumps open. Right: share that fails against"
        " hold voltage.",
        wide=True,
    )
    yield table(
        "Corners",
        corners,
        {
            "corner": "switch",
            "standard deviations out": cell("deviations"),
            "pull-in": lambda row: volts(float(row["pull_in_V"])),
            "release": lambda row: volts(float(row["release_V"])),
        },
    )


def marks(loop: list[CsvRow]) -> dict[str, tuple[float, float]]:
    """Voltage and capacitance (fF) where the central switch lands, has lost half of its held
    capacitance, and jumps open; without those that the loop does not reach. They are those of a
    positive drive.
    """
    loop = [row for row in loop if float(row["voltage_V"]) >= 0.0]
    voltage = column(loop, "voltage_V")
    up_fF = column(loop, "up_central_fF")
    down_fF = column(loop, "down_central_fF")
    held_fF = down_fF[-1]
    reached = {"lands": _first(up_fF > 0.5 * (up_fF[0] + held_fF))}
    reached["half"] = _first(down_fF > 0.5 * held_fF)
    reached["opens"] = _first(down_fF > 1.001 * up_fF)
    curves = {"lands": up_fF, "half": down_fF, "opens": down_fF}
    return {
        name: (float(voltage[place]), float(curves[name][place]))
        for name, place in reached.items()
        if place > 0
    }


def _first(reached: NDArray[np.bool_]) -> int:
    """First position from which on a curve has reached something; 0: it always has, or never."""
    return int(np.argmax(reached))


def _figure(results: Results) -> str:
    loop = results.csv("circuit/loop.csv")
    failing = results.csv("failure/failure.csv")

    def plot(slow, rare):
        voltage = column(loop, "voltage_V")
        for direction, color in (("up", BLUE), ("down", ORANGE)):
            low, high = (column(loop, f"{direction}_{end}_fF") / 1e3 for end in ("q05", "q95"))
            slow.fill_between(voltage, low, high, color=color, alpha=0.2, linewidth=0)
            slow.plot(
                voltage, column(loop, f"{direction}_central_fF") / 1e3, color=color, label=direction
            )
        for name, (volt, held_fF) in marks(loop).items():
            slow.plot(volt, held_fF / 1e3, "o", color=SOFT, markersize=4)
            slow.annotate(name, (volt, held_fF / 1e3), (5, 3), textcoords="offset points")
        slow.set(xlabel="voltage (V)", ylabel="capacitance (pF)", title="slow loop")
        slow.legend()
        usual = [row for row in failing if np.isclose(float(row["attraction"]), 1.0)]
        share = column(usual, "failing")
        rare.plot(column(usual, "hold_V"), np.where(share > 0, share, np.nan), "o-", color=BLUE)
        rare.set(
            yscale="log", xlabel="hold voltage (V)", ylabel="share of switches", title="failures"
        )

    return draw("circuit", "Capacitance and failures of the switch", plot, (9.4, 3.3), columns=2)
