"""The switch as a circuit sees it."""

from collections.abc import Iterator

import numpy as np

from workflow.report.available import Results
from workflow.report.drawing import BLUE, GREEN, ORANGE, SOFT, draw
from workflow.report.numbers import cell, column, show
from workflow.report.page import Block, Figure, Table, stage, table
from workflow.report.verdict import volts

FILES = ("circuit.json", "circuit.csv", "loop.csv", "transient.csv", "failure.csv")


@stage("In a circuit", *(f"device/{name}" for name in FILES))
def describe(results: Results) -> Iterator[Block]:
    """C-V loop with its band, transient, and failure rate; pull-in and release of the corners."""
    circuit, rows = results.json("device/circuit.json"), results.csv("device/circuit.csv")
    study, said = circuit["lumps"], circuit["transient"]
    corners = [row for row in rows if float(row["deviations"]) > 0]
    yield (
        "The folder device/circuit has the switch as SPICE netlists: central, four corners and "
        f"{len(rows) - len(corners)} draws. {study['lumps']} pairs of lumps stand for the electrode. Beside finite "
        f"elements pull-in differs by {study['pull_in']:.1%}, release by {study['release']:.1%}; these themselves err "
        f"by {study['reference']:.1%}."
    )
    yield Figure(
        _figure(results),
        "Left: slow loop; the bands hold 90 % of the draws. Middle: a step of "
        f"{volts(said['drive_V'])}, then none. Right: share that fails against hold voltage.",
        wide=True,
    )
    times = [
        ("closes after (µs)", _or_never(said["closing_us"])),
        ("hits with (m/s)", show(said["impact_m_s"], 2)),
        ("bounces by (nm)", _or_never(said["bounce_nm"])),
        ("opens after (µs)", _or_never(said["opening_us"])),
    ]
    yield Table(f"A step of {volts(said['drive_V'])}", ("mid-span", "value"), times)
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
    if said["deepest_nm"] < said["table_ends_nm"]:
        yield (
            f"The impact closes the pad to {show(said['deepest_nm'])} nm; its curves end at "
            f"{show(said['table_ends_nm'])} nm and go on in a line. The bounce is rough."
        )


def _or_never(value: float | None) -> str:
    return "never" if value is None else show(value, 3)


def _figure(results: Results) -> str:
    loop, step = results.csv("device/loop.csv"), results.csv("device/transient.csv")
    failing = results.csv("device/failure.csv")

    def plot(slow, fast, rare):
        voltage = column(loop, "voltage_V")
        for way, color in (("up", BLUE), ("down", ORANGE)):
            low, high = (column(loop, f"{way}_{end}_fF") / 1e3 for end in ("q05", "q95"))
            slow.fill_between(voltage, low, high, color=color, alpha=0.2, linewidth=0)
            slow.plot(voltage, column(loop, f"{way}_central_fF") / 1e3, color=color, label=way)
        slow.set(xlabel="voltage (V)", ylabel="capacitance (pF)", title="slow loop")
        slow.legend()
        fast.plot(column(step, "time_us"), column(step, "middle_nm") / 1e3, color=BLUE, label="mid-span (µm)")
        fast.plot(column(step, "time_us"), column(step, "capacitance_fF") / 1e3, color=GREEN, label="capacitance (pF)")
        fast.set(xlabel="time (µs)", title="step of the voltage", ylim=(None, 1.35 * fast.get_ylim()[1]))
        fast.legend(loc="upper right")
        usual = [row for row in failing if np.isclose(float(row["attraction"]), 1.0)]
        for key, color, label in (("failing", BLUE, "fails"), ("beyond", SOFT, "beyond the model")):
            share = column(usual, key)
            rare.plot(column(usual, "hold_V"), np.where(share > 0, share, np.nan), "o-", color=color, label=label)
        rare.set(yscale="log", xlabel="hold voltage (V)", ylabel="share of switches", title="failures")
        rare.legend()

    return draw("circuit", "Capacitance, motion and failures of the switch", plot, (10.6, 3.3), columns=3)
