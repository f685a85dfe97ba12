"""Many cells under one plane: what a pad is, beside one cell."""

from typing import Any

import numpy as np

from workflow.report.available import Results, Row
from workflow.report.drawing import BLUE, ORANGE, SERIES, SOFT, draw
from workflow.report.numbers import column, show
from workflow.report.page import COMPUTED, Section, Table
from workflow.report.verdict import symbol

CAUSES = {
    "inputs": "inputs",
    "gap_cutoff": "D₀",
    "device_common": "properties that all devices share",
    "device_each": "properties that differ from device to device",
    "cells": "the finite number of cells",
}


def describe(results: Results) -> Section | None:
    """The pad's curves, and what the answer is made of."""
    if not results.has("pad/curves.csv", "device/pad_switch.json"):
        return None
    switch = results.json("device/pad_switch.json")
    section = Section(
        "pad",
        "From a cell to a pad",
        f"{switch['cells_computed']} cells with surfaces of their own stand for the {show(switch['cells_of_pad'])} of "
        "the electrode. They are brought to one separation and opened together.",
        COMPUTED,
    )
    section.add(
        pad_curves(results),
        "Pressure of the pad at central inputs. Left: closing, and opening from several depths. Right: net pressure "
        "near the last contact; the band is one standard error of the mean of the cells.",
        wide=True,
        front=True,
    )
    if answer := switch.get("answer"):
        section.blocks += _answer(answer)
    if opened := switch.get("adhesion"):
        section.blocks.append(_adhesion(opened))
    section.notes.append(
        "Where the scene does not state how its devices vary (device.spread), their spread is an assumption."
    )
    section.files += ["pad/curves.csv", "pad/model.h5", "device/pad_switch.json"]
    return section


def _answer(answer: dict[str, Any]) -> list[Table]:
    """What the answer is made of, and which input to measure better."""

    def spread(key: str) -> str:
        quantiles = answer[key]["quantiles"]
        return f"{show(quantiles['0.5'])} [{show(quantiles['0.05'])}, {show(quantiles['0.95'])}]" if quantiles else "–"

    errors = answer["quantile_error_V"]
    solved, refused = answer["points"], len(answer["refused"])
    rows = [
        ("pull-in (V)", spread("pull_in_V")),
        ("capacitance closed (fF)", spread("capacitance_fF")),
        ("switches computed; of them without an answer", f"{solved + refused}; {refused}"),
        (
            "standard error of the median and of 5 and 95 %, by their number (V)",
            " ".join((show(errors["0.5"], 2), f"[{show(errors['0.05'], 2)}, {show(errors['0.95'], 2)}]")),
        ),
        ("error of one of them by the number of its cells (V)", show(answer["cells_error_V"], 2)),
        *((f"share of {CAUSES[row['cause']]}", f"{row['share_of_variance']:.1%}") for row in answer["causes"]),
    ]
    measured = [
        (symbol(row["name"]), f"{row['share_of_variance']:.1%}", f"{row['interval_shrinks_by']:.1%}")
        for row in answer["sensitivity"]
    ]
    columns = ("uncertain", "share of the variance", "known exactly, the interval shrinks by")
    return [
        Table("Behind the interval of the release: median and 5 to 95 %", ("quantity", "value"), rows),
        Table("What to measure better for the release", columns, measured),
    ]


def _adhesion(opened: list[dict[str, float]]) -> Table:
    """What opening the pad costs after each load."""
    columns = {
        "load_MPa": "load (MPa)",
        "energy_uJ_m2": "energy (µJ/m²)",
        "flats_uJ_m2": "flats so far apart (µJ/m²)",
        "pull_off_kPa": "pull-off (kPa)",
    }
    rows = [tuple(show(row[key]) for key in columns) for row in opened]
    return Table("Adhesion of the pad at central inputs, opened from each load", tuple(columns.values()), rows)


def pad_curves(results: Results) -> str:
    """Closing and opening of the pad, and the well on opening."""
    rows = results.csv("pad/curves.csv")
    depths = sorted({float(row["depth_nm"]) for row in rows if row["branch"] == "opening"})
    opened = {depth: [row for row in rows if row["depth_nm"] and float(row["depth_nm"]) == depth] for depth in depths}
    deepest = opened[depths[0]]
    shown = depths[:: max(1, len(depths) // 4)]

    def plot(whole, well):
        closing = [row for row in rows if row["branch"] == "closing"]
        _line(whole, closing, 1e-3, BLUE, "closing")
        for depth in shown:
            _line(whole, opened[depth], 1e-3, ORANGE, "opening" if depth == shown[0] else None, "--")
        top = max(column(closing, "net_kPa")) * 1e-3
        whole.set(yscale="log", ylim=(1e-4 * top, 2 * top), xlim=(depths[0] - 1, _last_contact(deepest) + 12))
        whole.set(xlabel="separation (nm)", ylabel="net pressure (MPa)", title="closing, and opening from each depth")
        whole.legend()
        lowest = 0.0
        for place, depth in enumerate(shown):
            line = opened[depth]
            s, net, error = (column(line, name) for name in ("separation_nm", "net_kPa", "standard_error_kPa"))
            color = SERIES[place % len(SERIES)]
            well.plot(s, net, color=color, label=f"closed to {depth:.1f} nm")
            well.fill_between(s, net - error, net + error, color=color, alpha=0.15, linewidth=0)
            lowest = min(lowest, float(net.min()))
        well.axhline(0, color=SOFT, linewidth=0.8)
        well.set(xlim=(depths[0], _last_contact(deepest) + 12), ylim=(2.5 * lowest, -2.5 * lowest))
        well.set(xlabel="separation (nm)", ylabel="net pressure (kPa)", title="near the last contact, on opening")
        well.legend()

    return draw("pad-curves", "Mean pressure of a pad against separation", plot, (9.4, 3.4), columns=2)


def _line(axis, rows: list[Row], scale: float, color: str, label: str | None, style: str = "-") -> None:
    net = column(rows, "net_kPa") * scale
    axis.plot(column(rows, "separation_nm"), np.where(net > 0, net, np.nan), style, color=color, label=label)


def _last_contact(rows: list[Row]) -> float:
    """Largest separation at which any cell pushes (nm)."""
    touching = column(rows, "repulsive_MPa") > 0
    return float(column(rows, "separation_nm")[touching].max())
