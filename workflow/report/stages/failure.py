"""How often the switch fails."""

from collections.abc import Iterator

import numpy as np

from mesoscale.uncertainty.rare_events import LEAST
from workflow.report.available import Results
from workflow.report.drawing import INK, SERIES, draw
from workflow.report.numbers import cell, column, show, spread
from workflow.report.page import Block, Figure, stage, table
from workflow.report.verdict import in_words, volts

SPRINGS = {"thickness_um": ("thickness of the beam", "µm")}
"""What makes a switch stiffer, by its key, and its unit; a plate has a spring."""


@stage("How often it fails", "failure/failure.json", "failure/failure.csv")
def describe(results: Results) -> Iterator[Block]:
    """Failure rate against hold voltage, and the largest voltage that is allowed."""
    rate = results.json("failure/failure.json")
    event = "sticks"
    if rate["release_V"]:
        event = f"is still closed at {volts(rate['release_V'])}"
    yield (
        f"A switch fails where it {event}. Allowed is a share of {rate['allowed']:g}. Nothing here"
        " decides the law of attraction, so each row has its own. Inputs, geometry and pads are"
        " drawn together."
    )
    yield Figure(
        _curve(results),
        "Share that fails against hold voltage, by the response. Points: over all that varies."
        " Dashed: the most of one batch with 95 % confidence, as what is common to its devices is"
        " not known.",
    )
    yield table(
        "Share of the devices that fail; it is uncertain, because what is common to all devices is"
        " not known",
        rate["laws"],
        {
            "attraction": lambda law: f"{show(law['attraction'], 2)} times",
            "median": lambda law: _share(law["given_common"]["0.5"]),
            "5 to 95 % of the belief": lambda law: " to ".join(
                _share(law["given_common"][q]) for q in ("0.05", "0.95")
            ),
            f"chance of no more than {show(rate['allowed'])}": lambda law: f"{law['sure']:.0%}",
        },
        front=True,
    )
    spring, unit = SPRINGS.get(rate["spring"], ("spring", "N/m"))
    yield table(
        "Share that fails, and what is allowed; hold voltage and roughness with"
        f" {rate['confidence']:.0%} confidence",
        rate["laws"],
        {
            "attraction": lambda law: f"{show(law['attraction'], 2)} times",
            f"failing at {volts(rate['hold_V'])} [95 %]": lambda law: spread(
                law["failing"], "probability", "low", "high", 2
            ),
            "largest hold voltage": lambda law: _or_none(law["largest_hold_V"], "V"),
            "least RMS height": lambda law: _or_none(law["least_rms_nm"], "nm", 2),
            f"least {spring}": lambda law: _or_none(law["least_spring"], unit),
        },
    )
    if rate["control"]:
        fails = f"share that fails, with {show(rate['control_attraction'], 2)} times the attraction"
        columns = {
            "if this input is at its median": lambda row: in_words(row["name"]),
            fails: cell("failing_if_known", 2),
        }
        yield table("What to control", rate["control"][:5], columns)


def _share(quantile: dict[str, float]) -> str:
    if quantile["value"] < LEAST:
        return "less than 10⁻¹⁰"
    return show(quantile["value"], 2)


def _or_none(value: float | None, unit: str, digits: int = 3) -> str:
    if value is None:
        return "none"
    return f"{show(value, digits)} {unit}"


def _curve(results: Results) -> str:
    rows = results.csv("failure/failure.csv")

    def plot(axis):
        laws = list(dict.fromkeys(row["attraction"] for row in rows))
        for color, times in zip(SERIES, laws, strict=False):
            curve = [row for row in rows if row["attraction"] == times]
            seen = np.where(column(curve, "failing") > 0, column(curve, "failing"), np.nan)
            axis.plot(
                column(curve, "hold_V"),
                seen,
                "o-",
                color=color,
                label=f"{show(times, 2)} times the attraction",
            )
            axis.plot(
                column(curve, "hold_V"),
                np.maximum(column(curve, "failing_q95"), LEAST),
                "--",
                color=color,
            )
        axis.axhline(
            results.json("failure/failure.json")["allowed"],
            linewidth=0.8,
            color=INK,
            label="allowed",
        )
        axis.set(yscale="log", xlabel="hold voltage (V)", ylabel="share that fails")
        axis.legend(frameon=False)

    return draw("failure", "Share of switches that fail against hold voltage", plot)
