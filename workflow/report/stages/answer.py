"""The release of the switch if one property of its device were another."""

from collections.abc import Iterator
from typing import Any

from workflow.report.available import Results
from workflow.report.drawing import BLUE, SOFT, draw
from workflow.report.numbers import cell, column, show
from workflow.report.page import Block, Figure, stage, table
from workflow.report.verdict import labelled


@stage("What if the device were another", "answer/pad_switch.json")
def describe(results: Results) -> Iterator[Block]:
    """Release against one key of the device at a time."""
    pad = results.json("answer/pad_switch.json")
    rows = pad.get("by_key", [])
    yield (
        "Each row is solved on the pad at central inputs with one property changed; surface and"
        " materials stay as they are. A switch without a stated hold voltage is held at its own"
        " pull-in voltage."
    )
    reserve = pad.get("reserve")
    if reserve and not reserve["freed_by"]:
        times = show(reserve["bears_times"], 2)
        yield f"At central inputs it sticks only where the pad attracts with {times} times as much."
    if sticking := pad.get("sticking_by_key"):
        yield table(
            f"How many stick, instead of {pad['answer']['stuck']['value']:.0%}, if one property of"
            " the device were another; solved on the pads of all points",
            sticking,
            {
                "property": lambda row: labelled(row["key"]),
                "value": lambda row: show(row["value"]),
                "other value": lambda row: show(row["other"]),
                "stick": lambda row: f"{row['stuck']:.0%}",
            },
            front=True,
        )
    if not rows:
        yield "The switch at central inputs has no answer, so there is nothing to compare with."
        return
    if not any(row["release_V"] for row in rows):
        yield "At central inputs the switch sticks, with each of these changes, too."
        return
    yield Figure(
        by_key(rows),
        "Release at central inputs if one property of the device were another; the grey line is"
        " this scene. At zero the switch sticks. Open circles: the pad is pressed harder than it"
        " was computed, so its curves are continued. Curves end where the switch has no answer; the"
        " table below has pull-in and the reasons.",
        wide=True,
        front=True,
    )
    yield table(
        "Pull-in and release",
        rows,
        {
            "property": lambda row: labelled(row["key"]).replace(" ", "\u00a0"),
            "value": lambda row: show(row["value"]),
            "pull-in (V)": cell("pull_in_V"),
            "release (V)": _release,
            "remark": _remark,
        },
        heads=2,
    )


def _release(row: dict[str, Any]) -> str:
    if row["release_V"] == 0:
        return "sticks"
    return show(row["release_V"])


def _remark(row: dict[str, Any]) -> str:
    """Why there is no answer, or that the curves of the pad were continued for it."""
    if row["continued"] and not row["reason"]:
        return "curves continued"
    return row["reason"].partition(";")[0]


def by_key(rows: list[dict[str, Any]]) -> str:
    """A panel for each property."""
    keys = list(dict.fromkeys(row["key"] for row in rows))
    top = 1.1 * max(row["release_V"] for row in rows if not row["reason"])

    def plot(*axes):
        for axis, key in zip(axes, keys, strict=False):
            of_key = [row for row in rows if row["key"] == key]
            solved = [row for row in of_key if not row["reason"]]
            axis.plot(column(solved, "value"), column(solved, "release_V"), color=BLUE)
            for row in solved:
                face = "none" if row["continued"] else BLUE
                axis.plot(
                    row["value"],
                    row["release_V"],
                    "o",
                    color=BLUE,
                    markerfacecolor=face,
                    markersize=5,
                )
            axis.axvline(
                next(row["value"] for row in solved if row["own"]), color=SOFT, linewidth=0.8
            )
            axis.set(ylim=(-0.03 * top, top), xlabel=labelled(key), ylabel="release (V)")
        for axis in axes[len(keys) :]:
            axis.set_visible(False)

    return draw(
        "by-key",
        "Release against one property of the device at a time",
        plot,
        (8.0, 4.4),
        columns=3,
        rows=2,
    )
