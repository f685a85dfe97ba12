"""The budget in volts: every effect that an expert would name."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from workflow.report.available import Results
from workflow.report.numbers import number, show
from workflow.report.page import Block, stage, table
from workflow.report.verdict import in_words

HOW = {
    "computed": "computed here",
    "literature": "bound by literature",
    "condition": "a condition",
    "unknown": "not known",
}
LITTLE_V = 0.1
"""Effects that move the release by less are folded away."""


@stage("What the budget leaves small, and its sources", "device/budget.csv", "device/pad_switch.json")
def describe(results: Results) -> Iterator[Block]:
    """The effects, the largest first; what is not known ends the table."""
    rows = results.csv("device/budget.csv")
    yield (
        "Effects below 0.1 V, then the sources of all. Each effect moves the release at central inputs, so that a sum "
        "in quadrature of what the interval holds is near its width, but not equal to it."
    )
    if not rows:
        yield "The switch at central inputs has no release, so there is nothing to move."
        return
    large = [row for row in rows if not number(row["volts"]) < LITTLE_V]
    yield table(_caption(results, rows), large, COLUMNS, front=True)
    yield table("Effects below 0.1 V", [row for row in rows if number(row["volts"]) < LITTLE_V], COLUMNS)
    yield table("Sources", rows, {"effect": _effect, "source": "source"})


def _effect(row: dict[str, Any]) -> str:
    return in_words(row["effect"])


COLUMNS = {
    "effect": _effect,
    "release moves by (V)": lambda row: show(row["volts"], 2),
    "which is": "about",
    "how known": lambda row: HOW[row["how"]],
    "in the interval": lambda row: "yes" if row["held"] == "True" else "no",
    "what would settle it": "settle",
}


def _caption(results: Results, rows: list[dict[str, str]]) -> str:
    """What the table is, and what the interval holds of it."""
    said = "By how many volts each effect moves the release at central inputs"
    answer = results.json("device/pad_switch.json").get("answer")
    held = [number(row["volts"]) for row in rows if row["held"] == "True"]
    if not answer or not held:
        return said
    quadrature = float(np.sqrt(np.nansum(np.square(held))))
    ends = [answer["release_V"]["quantiles"][q] for q in ("0.05", "0.95")]
    return (
        f"{said}. What the interval holds is {show(quadrature)} V, added in quadrature; "
        f"the interval is {show(ends[1] - ends[0])} V wide"
    )
