"""The same switch by other models, beside the answer."""

from typing import Any

from workflow.report.available import Results
from workflow.report.numbers import show
from workflow.report.page import COMPUTED, Section, Table
from workflow.report.verdict import volts


def describe(results: Results) -> Section | None:
    """One table of all other releases."""
    rows, files = [], []
    if results.has("device/pad_switch.json"):
        rows += _on_pad(results.json("device/pad_switch.json"))
        files += ["device/pad_switch.json"]
    if results.has("device/switch.json"):
        rows += _on_one_cell(results.json("device/switch.json"))
        files += [
            "device/switch.json",
            "device/release.csv",
            "device/stiction.csv",
            "device/law.csv",
            "device/law.json",
        ]
        files += ["device/asperity_contact.sub", "device/asperity_contact.va"]
    if not rows:
        return None
    section = Section(
        "models",
        "The same switch by other models",
        "For comparison, and for circuit simulators. A flat electrode lands everywhere at once, so it sticks more than "
        "one that bends. One cell's law knows nothing of its neighbours.",
        COMPUTED,
        files=files,
    )
    header = ("model", "release (V), median [5 %, 95 %]", "probability of sticking")
    section.blocks.append(Table("Release and sticking by other models", header, rows))
    return section


def _on_pad(pad: dict[str, Any]) -> list[tuple[str, str, str]]:
    rows = []
    if pad.get("beam"):
        rows.append(("electrode that bends, pad at central inputs", volts(pad["beam"]["release_V"]), "–"))
    if pad["mean"] is not None:
        estimate = pad["estimate"]
        stuck = f"{estimate['stuck']['value']:.0%} of resampled pads"
        rows.append(("electrode flat on the pad, central inputs", _spread(estimate["release_V"]), stuck))
    if answer := pad.get("answer"):
        closed = answer["at_curves"]["by_closed_form"]["release_V"]
        rows.append(("closed form of the pad, central inputs", volts(closed), "–"))
    return rows


def _on_one_cell(switches: dict[str, Any]) -> list[tuple[str, str, str]]:
    cases = {"with_adhesion": "plate on one cell's law", "without_adhesion": "the same without adhesion"}
    return [
        (
            f"{words}, over the inputs, where it releases",
            _spread(switches[case]["release_V"]),
            f"{switches[case]['stiction_probability']['value']:.0%}",
        )
        for case, words in cases.items()
    ]


def _spread(described: dict[str, Any]) -> str:
    quantiles = described["quantiles"]
    if not quantiles:
        return "–"
    return f"{volts(quantiles['0.5'])} [{show(quantiles['0.05'])}, {show(quantiles['0.95'])}]"
