"""The budget in volts: every effect that an expert would name."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from mesoscale.settings import DeviceSettings
from workflow.report.available import CsvRow, Results
from workflow.report.drawing import BLUE, draw
from workflow.report.numbers import column, number, show
from workflow.report.page import Block, Figure, stage, table
from workflow.report.verdict import NAMES, in_words, labelled

HOW = {
    "computed": "computed here",
    "literature": "bound by literature",
    "condition": "a condition",
    "unknown": "not known",
}
AGEING = {
    "beam": "creep of the beam",
    "tops": "creep of the contact under hold",
    "bonds": "bonds that grow with time",
}
"""Rows of the budget by effect of lifetime/ageing.csv."""
LITTLE_V = 0.1
"""Effects that move the release by less are folded away."""


@stage(
    "What the budget leaves small, and its sources", "answer/budget.csv", "answer/pad_switch.json"
)
def describe(results: Results) -> Iterator[Block]:
    """The effects, the largest first: what the interval holds, then what it leaves out; what is not
    known is last.
    """
    rows = _rows(results)
    yield (
        "Effects below 0.1 V, then the sources of all. Each effect moves the release at central"
        " inputs, so that a sum in quadrature of what the interval holds is near its width, but not"
        " equal to it."
    )
    if not rows:
        yield "The switch at central inputs has no release, so there is nothing to move."
        reserve = results.json("answer/pad_switch.json").get("reserve")
        if reserve and reserve["freed_by"]:
            yield from _of_sticking(reserve)
        return
    large = [row for row in rows if not number(row["volts"]) < LITTLE_V]
    held = [row for row in large if row["held"] == "True"]
    if held:
        yield Figure(
            bars(held),
            "Volts by which each effect moves the release.",
            front=True,
        )
        yield table(_caption(results, rows), held, HELD, front=True)
    unknown = [row for row in large if row["how"] == "unknown"]
    left_out = [row for row in large if row["held"] != "True" and row not in unknown]
    yield table(_left_out(unknown), left_out, LEFT_OUT, front=True)
    yield table("Effects whose volts nobody knows", unknown, LEFT_OUT)
    yield table(
        "Effects below 0.1 V", [row for row in rows if number(row["volts"]) < LITTLE_V], LEFT_OUT
    )
    yield table("Sources", rows, {"effect": _effect, "source": "source"})


def _left_out(unknown: list[CsvRow]) -> str:
    """Caption of what the interval leaves out; names what has no volts."""
    words = "What the interval leaves out, by the volts that the release moves"
    if not unknown:
        return words
    return f"{words}. Nobody knows the volts of: {'; '.join(row['effect'] for row in unknown)}"


def _of_sticking(reserve: dict[str, Any]) -> Iterator[Block]:
    """What frees a switch that sticks, and what moves its reserve."""
    yield table(
        "At central inputs the switch sticks, so nothing is counted in volts. It would let go with"
        f" {show(reserve['bears_times'], 2)} of the attraction of its pad. What frees it: one"
        " property changed at a time, the nearest value with which it lets go",
        reserve["freed_by"],
        {
            "property": lambda row: labelled(row["key"]),
            "value": lambda row: show(row["value"]),
            "lets go at": _frees,
        },
        front=True,
    )
    yield table(
        "What moves this reserve: attraction that the switch bears, over that of its pad, where"
        " one property of the device is at its 5 and its 95 %",
        reserve["moved_by"],
        {
            "property": lambda row: in_words(row["key"]),
            "at 5 %": lambda row: show(row["low"], 2),
            "at 95 %": lambda row: show(row["high"], 2),
        },
        front=True,
    )


def _frees(row: dict[str, Any]) -> str:
    if row["frees"] is None:
        return "none in reach"
    return show(row["frees"])


def bars(rows: list[CsvRow]) -> str:
    """A bar an effect, the largest on top, with its volts at its end."""
    names = [_effect(row) for row in rows]
    moved_V = column(rows, "volts")

    def plot(axis):
        places = np.arange(len(rows))[::-1]
        drawn = axis.barh(places, moved_V, color=BLUE, height=0.62)
        axis.bar_label(drawn, [f"{show(value, 2)} V" for value in moved_V], padding=4)
        axis.set_yticks(places, names)
        axis.set(xlabel="release moves by (V)", xlim=(0.0, 1.12 * np.nanmax(moved_V)))
        axis.grid(False, axis="y")

    return draw("budget-bars", "Volts by effect", plot, (5.0, 0.6 + 0.3 * len(rows)))


def _rows(results: Results) -> list[CsvRow]:
    """The budget, with what the targets `humidity` and `lifetime` computed where they ran."""
    computed = {"humid air": _by_humidity(results)}
    computed |= {name: _by_ageing(results, effect) for effect, name in AGEING.items()}
    rows = [{**row, **computed.get(row["effect"], {})} for row in results.csv("answer/budget.csv")]
    return sorted(rows, key=lambda row: -np.nan_to_num(number(row["volts"]), nan=-1.0))


def _by_humidity(results: Results) -> CsvRow:
    """From the least to the largest release of the humidities that were computed."""
    rows = results.rows("humidity/humidity.csv")
    if len(solved := [row for row in rows if row["release_V"]]) < 2:
        return {}
    release = column(solved, "release_V")
    humidity = column(solved, "humidity")
    about = (
        f"{humidity.min():.0%} to {humidity.max():.0%}, menisci either"
        f" way{'; it may stick' * (0.0 in release)}"
    )
    return {
        "volts": str(np.ptp(release)),
        "about": about,
        "how": "computed",
        "source": "humidity/humidity.csv",
    }


def _by_ageing(results: Results, effect: str) -> CsvRow:
    """By how much an effect of ageing moves the release by the end of a life, by the central
    guess.
    """
    rows = [row for row in results.rows("lifetime/ageing.csv") if row["effect"] == effect]
    if not rows:
        return {}
    ends = {row["guess"]: number(row["release_V"]) for row in rows}
    fresh = number(rows[0]["release_V"])
    least, central, most = (fresh - ends[guess] for guess in ("least", "central", "most"))
    years = results.json("lifetime/lifetime.json")["years"]
    about = (
        f"{show(years)} years of hold, {show(least, 2)} to {show(most, 2)} V by assumed ranges"
        f"{'; it may stick' * (ends['most'] == 0.0)}"
    )
    return {
        "volts": str(central),
        "about": about,
        "how": "computed",
        "source": "lifetime/ageing.csv",
    }


def _effect(row: dict[str, Any]) -> str:
    """A property of the device in full: "stress" and "thickness" alone may be of anything."""
    name = row["effect"]
    return (
        NAMES[name][1].removeprefix("the ")
        if name in DeviceSettings.model_fields
        else in_words(name)
    )


def _volts(row: CsvRow) -> str:
    """Volts, with the remark that ends what they stand for."""
    remark = row["about"].partition("; ")[2]
    return show(row["volts"], 2) + f"; {remark}" * bool(remark)


HELD = {"effect": _effect, "release moves by (V)": _volts, "what to do": "settle"}
LEFT_OUT = {
    "effect": _effect,
    "volts": lambda row: show(row["volts"], 2),
    "which is": lambda row: f"{HOW[row['how']]}: {row['about']}",
    "what would settle it": "settle",
}


def _caption(results: Results, rows: list[CsvRow]) -> str:
    """What the interval holds, in quadrature, beside its width."""
    held = [number(row["volts"]) for row in rows if row["held"] == "True"]
    held_words = (
        "What the interval holds: volts by which each, from its 5 to its 95 %, moves the release"
        f" at central inputs. Together they are {show(float(np.sqrt(np.nansum(np.square(held)))))}"
        " V, added in quadrature"
    )
    switch = results.json("answer/pad_switch.json")
    if switch.get("measured"):
        held_words += ", though measurements tie properties of the device to each other"
    if answer := switch.get("answer"):
        ends_V = [answer["release_V"]["quantiles"][q] for q in ("0.05", "0.95")]
        return f"{held_words}; the interval is {show(ends_V[1] - ends_V[0])} V wide"
    return held_words
