"""What the scene says of its switch, in a sentence: when it lets go, what that hangs on, what to do next."""

from collections.abc import Sequence
from typing import Any

from workflow.report.available import Results
from workflow.report.numbers import SYMBOLS, show
from workflow.report.page import Gate

Card = dict[str, str]
NAMES = {
    "gap_cutoff_nm": ("D₀", "the pull-off of the contact, which tells D₀"),
    "bow_nm": ("bow", "the bow of the electrode at rest"),
    "tilt_nm": ("tilt", "the tilt of the electrode at rest"),
}
CAUSES = {"inputs": "inputs", "gap_cutoff": "D₀", "geometry": "bow and tilt", "cells": "the finite number of cells"}
UPPER_BOUND = "; an upper bound, as the model overrates the pull of tops that were pressed flat"
"""Of coupled mechanics: attraction does not deform the contact (docs/contact.md)."""
DECIDED = 0.95
"""Probability from which on a switch is said to stick, or to let go."""


def verdict(results: Results, gates: Sequence[Gate]) -> str:
    """One sentence on release, its main cause and the next step; empty without a switch on a pad."""
    if not results.has("device/pad_switch.json"):
        return ""
    pad = results.json("device/pad_switch.json")
    answer = pad.get("answer")
    if answer:
        said = f"{_outcome(answer['stuck'], answer['release_V'])}; {_cause(answer)}"
    elif pad["mean"] is not None:
        estimate = pad["estimate"]
        said = _outcome(estimate["stuck"], estimate["release_V"])
        said = f"At central inputs, its electrode flat on the pad: {said[0].lower()}{said[1:]}"
        if pad["beam"]:
            said += f"; where the electrode bends, it {_bending(pad['beam'])}"
    else:
        said = "The release voltage is not known"
    return f"{said}; {_next(pad, gates, results.coupled)}."


def release_cards(results: Results) -> list[Card]:
    """Release and sticking with their intervals and with what these hold."""
    pad = results.json("device/pad_switch.json") if results.has("device/pad_switch.json") else {}
    answer = pad.get("answer")
    if answer:
        held = ", ".join(CAUSES[row["cause"]] for row in answer["causes"] if row["share_of_variance"] > 0)
        electrode = {"bending": "electrode that bends", "flat": "electrode flat on the pad"}[answer["electrode"]]
        held = f"the interval holds {held}" if held else "nothing uncertain changes that"
        return _cards(answer, electrode, held, results.coupled)
    if not pad or pad["mean"] is None:
        return []
    held = f"the interval holds the {pad['cells_computed']} computed cells alone, at central inputs"
    flat = _cards(pad["estimate"], "electrode flat on the pad", held, results.coupled)
    if pad["beam"]:
        flat[0]["detail"] += f"; bending, the electrode {_bending(pad['beam'])}"
    return flat


def release_causes(results: Results) -> list[tuple[str, float]]:
    """Share of the variance of the release voltage of each cause that has one, largest first."""
    pad = results.json("device/pad_switch.json") if results.has("device/pad_switch.json") else {}
    rows = (pad.get("answer") or {}).get("sensitivity", [])
    return [(symbol(row["name"]), row["share_of_variance"]) for row in rows if row["share_of_variance"] > 0]


def symbol(name: str) -> str:
    """How the page calls what varies."""
    return NAMES[name][0] if name in NAMES else SYMBOLS.get(name, name)


def _cards(states: dict[str, Any], electrode: str, held: str, coupled: bool) -> list[Card]:
    release, stuck = states["release_V"]["quantiles"], states["stuck"]
    detail = f"median, {electrode}; 5 to 95 %: {show(release['0.05'])} to {show(release['0.95'])} V, 0 where it sticks"
    if not any(release.values()):
        detail = f"{electrode}; 5 to 95 %: sticks"
    share = f"95 %: {stuck['low']:.0%} to {stuck['high']:.0%}, from {stuck['samples']} switches"
    share += UPPER_BOUND * (coupled and stuck["value"] > 0)
    return [
        {"title": "Release", "value": _volts(release["0.5"]), "detail": f"{detail}; {held}"},
        {"title": "Probability of sticking", "value": f"{stuck['value']:.0%}", "detail": f"{electrode}; {share}"},
    ]


def _volts(value: float) -> str:
    return "sticks" if value == 0 else f"{show(value)} V"


def _outcome(stuck: dict[str, Any], release: dict[str, Any]) -> str:
    if stuck["value"] >= DECIDED:
        return "The switch sticks"
    low, high = (show(release["quantiles"][q]) for q in ("0.05", "0.95"))
    volts = f"{show(release['quantiles']['0.5'])} V (5 to 95 %: {low} to {high} V)"
    if stuck["value"] <= 1 - DECIDED:
        return f"The switch lets go at {volts}"
    return f"Whether the switch lets go is open: it sticks with a probability of {stuck['value']:.0%}, median {volts}"


def _bending(beam: dict[str, Any]) -> str:
    return "sticks, too" if beam["stuck"] else f"lets go at {show(beam['release_V'])} V"


def _cause(answer: dict[str, Any]) -> str:
    largest = max(answer["causes"], key=lambda row: row["share_of_variance"])
    if largest["share_of_variance"] == 0:
        return f"it does so in all {answer['design']['points']} computed combinations of inputs, D₀, bow and tilt"
    if largest["cause"] == "cells" or not answer["sensitivity"]:
        return f"{largest['share_of_variance']:.0%} of the spread is {CAUSES[largest['cause']]}"
    first = answer["sensitivity"][0]
    return f"{first['share_of_variance']:.0%} of the spread comes from {symbol(first['name'])}"


def _next(pad: dict[str, Any], gates: Sequence[Gate], coupled: bool) -> str:
    failed = [gate for gate in gates if gate.used and not gate.passed]
    if failed:
        return f"before anything else, mend what failed: {', '.join(gate.stage for gate in failed)} (reasons below)"
    answer = pad.get("answer")
    if answer:
        cells = next(row["share_of_variance"] for row in answer["causes"] if row["cause"] == "cells")
        rows = answer["sensitivity"]
        if answer["stuck"]["value"] == 1.0 and coupled:
            return "its adhesion is an upper bound, so measure a pull-off force next (target calibrate)"
        if answer["stuck"]["value"] == 1.0:
            return "no better measurement would free it, a stiffer or shorter beam might"
        if not rows or cells > rows[0]["share_of_variance"]:
            return "compute more cells next (pad.cells)"
        what = NAMES[rows[0]["name"]][1] if rows[0]["name"] in NAMES else f"{symbol(rows[0]['name'])} better"
        return f"next, measure {what}: known exactly, it shrinks the interval by {rows[0]['interval_shrinks_by']:.0%}"
    if pad["mean"] is not None and 1 - DECIDED < pad["estimate"]["stuck"]["value"] < DECIDED:
        return "compute more cells next (pad.cells)"
    return "next, measure the bow of the electrode, which decides how much of it lands"
