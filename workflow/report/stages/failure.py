"""How often the switch fails."""

import numpy as np

from workflow.report.available import Results
from workflow.report.drawing import INK, SERIES, draw
from workflow.report.numbers import column, show
from workflow.report.page import COMPUTED, Section, Table
from workflow.report.verdict import symbol, volts


def describe(results: Results) -> Section | None:
    """Failure rate against hold voltage, and the largest voltage that is allowed."""
    if not results.has("device/failure.json", "device/failure.csv"):
        return None
    rate = results.json("device/failure.json")
    event = f"is still closed at {volts(rate['release_V'])}" if rate["release_V"] else "sticks"
    section = Section(
        "failure",
        "How often it fails",
        f"A switch fails where it {event}. {show(rate['allowed'])} of all may. Statistics does not know the law of "
        "attraction, so each row has its own. Inputs, geometry and pads are drawn together.",
        COMPUTED,
        files=["device/failure.json", "device/failure.csv"],
    )
    section.add(_curve(results), "Share that fails against hold voltage, by the response.")
    header = (
        "attraction",
        f"failing at {volts(rate['hold_V'])} [95 %]",
        "largest hold voltage",
        "least RMS height",
        "least thickness of the beam" if rate["spring"] == "thickness_um" else "least spring",
    )
    unit = "µm" if rate["spring"] == "thickness_um" else "N/m"
    rows = [
        (
            f"{show(law['attraction'], 2)} times",
            f"{show(law['failing']['probability'], 2)} [{_interval(law['failing'])}]",
            "none" if law["largest_hold_V"] is None else volts(law["largest_hold_V"]),
            "none" if law["least_rms_nm"] is None else f"{show(law['least_rms_nm'], 2)} nm",
            "none" if law["least_spring"] is None else f"{show(law['least_spring'])} {unit}",
        )
        for law in rate["laws"]
    ]
    section.blocks.append(Table("Failures; hold voltage, roughness and spring that are allowed", header, rows))
    if rate["control"]:
        known = [(symbol(row["name"]), show(row["failing_if_known"], 2)) for row in rate["control"][:5]]
        header = (
            "if this input is at its median",
            f"fails with {show(rate['control_attraction'], 2)} times the attraction",
        )
        section.blocks.append(Table("What to control", header, known))
    return section


def _interval(failing: dict[str, float]) -> str:
    return f"{show(failing['low'], 2)}, {show(failing['high'], 2)}"


def _curve(results: Results) -> str:
    rows = results.csv("device/failure.csv")

    def plot(axis):
        laws = list(dict.fromkeys(row["attraction"] for row in rows))
        for color, times in zip(SERIES, laws, strict=False):
            curve = [row for row in rows if row["attraction"] == times]
            seen = np.where(column(curve, "failing") > 0, column(curve, "failing"), np.nan)
            axis.plot(column(curve, "hold_V"), seen, "o-", color=color, label=f"{show(times, 2)} times the attraction")
        axis.axhline(results.json("device/failure.json")["allowed"], linewidth=0.8, color=INK, label="allowed")
        axis.set(yscale="log", xlabel="hold voltage (V)", ylabel="share that fails")
        axis.legend(frameon=False)

    return draw("failure", "Share of switches that fail against hold voltage", plot)
