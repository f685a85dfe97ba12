"""Many cells under one plane: what a pad is, beside one cell."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from workflow.report.available import CsvRow, Results
from workflow.report.drawing import BLUE, ORANGE, SERIES, SOFT, draw
from workflow.report.numbers import cell, column, show, spread
from workflow.report.page import Block, DoubtNote, Figure, PageTable, stage, table
from workflow.report.verdict import causes_of, in_words, labelled

QUANTILES = ("0.5", "0.05", "0.95")
"""Median and ends, in the order of `spread`."""
CAUSES = {
    "common": "what all devices have in common and is not known",
    "each": "what differs from device to device",
    "cells": "the finite number of cells",
}
KINDS = {
    "common": "What to measure better: one unknown value for all devices",
    "each": "What to control better: it differs from device to device",
}


@stage("From a cell to a pad", "pad/curves.csv", "answer/pad_switch.json", also=("pad/model.h5",))
def describe(results: Results) -> Iterator[Block]:
    """The pad's curves, and what the answer is made of."""
    switch = results.json("answer/pad_switch.json")
    yield (
        f"{switch['cells_computed']} cells, squares of rough surface of their own, stand for the"
        f" {show(switch['cells_of_pad'])} of the pad, the whole area that lands. They are brought"
        " to one separation and opened together."
    )
    yield Figure(
        pad_curves(results),
        "Pressure of the pad, all that lands, at central inputs. Left: closing, and opening from"
        " several depths. Right: net pressure near the last contact; the band is one standard error"
        " of the mean of the cells.",
        wide=True,
        front=True,
    )
    if answer := switch.get("answer"):
        yield from _answer(answer)
    if measured := switch.get("measured"):
        yield from _measured(measured)
    if opened := switch.get("adhesion"):
        yield table(
            "Adhesion of the pad at central inputs, opened from each load",
            opened,
            {
                "load (MPa)": cell("load_MPa"),
                "energy (µJ/m²)": cell("energy_uJ_m2"),
                "flats so far apart (µJ/m²)": cell("flats_uJ_m2"),
                "pull-off (kPa)": cell("pull_off_kPa"),
            },
        )
    yield (
        "Where the scene does not state how its devices vary (device.spread), their spread is an"
        " assumption."
    )


def _measured(measured: dict[str, Any]) -> Iterator[Block]:
    """What was measured of the device, and what of its properties remains unknown."""
    for name, row in measured["measured"].items():
        quantity, _, unit = name.rpartition("_")
        yield (
            f"Measured {quantity.replace('_', '-')}: {show(row['value'])} ± {show(row['error'], 2)}"
            f" {unit}. As stated, such devices have {show(row['by_stated_device'])} ±"
            f" {show(row['deviation_of_stated_devices'], 2)} {unit}."
        )
    if measured["doubt"]:
        yield f"Doubt: {measured['doubt']}."
    yield table(
        "Properties of the device after what was measured",
        measured["properties"],
        {
            "property": lambda row: labelled(row["name"]),
            "stated": cell("stated"),
            "after": cell("typical"),
            "of its spread remains": lambda row: f"{row['remains']:.0%}",
        },
    )


def _answer(answer: dict[str, Any]) -> Iterator[Block]:
    """What the answer is made of, and which input to measure better."""
    pull_in = spread(answer["pull_in_V"]["quantiles"], *QUANTILES)
    capacitance = spread(answer["capacitance_fF"]["quantiles"], *QUANTILES)
    errors = spread(answer["quantile_error_V"], *QUANTILES, digits=2)
    refused = len(answer["refused"])
    computed = answer["points"] + refused
    rows = [
        ("pull-in (V)", pull_in),
        ("capacitance closed (fF)", capacitance),
        ("switches computed; of them without an answer", f"{computed}; {refused}"),
        ("standard error of the median and of 5 and 95 %, by their number (V)", errors),
        ("error of one of them by the number of its cells (V)", show(answer["cells_error_V"], 2)),
    ]
    for cause, share in answer["causes"].items():
        rows.append((f"share of {CAUSES[cause]}", f"{share:.1%}"))
    caption = "Behind the interval of the release: median and 5 to 95 %"
    yield PageTable(caption, ("quantity", "value"), rows)
    if no_cause := causes_of(answer)[1]:
        yield DoubtNote(f"The shares of the variance name no cause: {no_cause}.")
    shrinks = "known exactly, the interval shrinks by"
    columns = {
        "uncertain": lambda row: in_words(row["name"]),
        "share of the variance": lambda row: f"{row['share_of_variance']:.1%}",
        shrinks: lambda row: f"{row['interval_shrinks_by']:.1%}",
    }
    for kind, caption in KINDS.items():
        rows_of_kind = [row for row in answer["sensitivity"] if row["varies"] == kind]
        yield table(caption, rows_of_kind, columns)


def pad_curves(results: Results) -> str:
    """Closing and opening of the pad, and the well on opening."""
    rows = results.csv("pad/curves.csv")
    depths = sorted({float(row["depth_nm"]) for row in rows if row["branch"] == "opening"})
    closing = [row for row in rows if row["branch"] == "closing"]
    opened = {depth: _opened_from(rows, depth) for depth in depths}
    farthest_nm = _last_contact(opened[depths[0]]) + 12
    drawn = depths[:: max(1, len(depths) // 4)]

    def plot(range_axis, well):
        _plot_MPa(range_axis, closing, "-", color=BLUE, label="closing")
        _plot_MPa(range_axis, opened[drawn[0]], "--", color=ORANGE, label="opening")
        for depth in drawn[1:]:
            _plot_MPa(range_axis, opened[depth], "--", color=ORANGE)
        top = max(column(closing, "net_kPa")) * 1e-3
        range_axis.set(
            yscale="log",
            xlim=(depths[0] - 1, farthest_nm),
            ylim=(1e-4 * top, 2 * top),
            xlabel="separation (nm)",
            ylabel="net pressure (MPa)",
            title="closing, and opening from each depth",
        )
        range_axis.legend()
        lowest = 0.0
        for place, depth in enumerate(drawn):
            line = opened[depth]
            separation = column(line, "separation_nm")
            net = column(line, "net_kPa")
            error = column(line, "standard_error_kPa")
            color = SERIES[place % len(SERIES)]
            well.plot(separation, net, color=color, label=f"closed to {depth:.1f} nm")
            band = {"color": color, "alpha": 0.15, "linewidth": 0}
            well.fill_between(separation, net - error, net + error, **band)
            lowest = min(lowest, float(net.min()))
        well.axhline(0, color=SOFT, linewidth=0.8)
        well.set(
            xlim=(depths[0], farthest_nm),
            ylim=(2.5 * lowest, -2.5 * lowest),
            xlabel="separation (nm)",
            ylabel="net pressure (kPa)",
            title="near the last contact, on opening",
        )
        well.legend()

    return draw(
        "pad-curves", "Mean pressure of a pad against separation", plot, (9.4, 3.4), columns=2
    )


def _opened_from(rows: list[CsvRow], depth_nm: float) -> list[CsvRow]:
    """The rows of the opening from a depth."""
    return [row for row in rows if row["depth_nm"] and float(row["depth_nm"]) == depth_nm]


def _plot_MPa(axis, rows: list[CsvRow], style: str, **line: str) -> None:
    """Plot the net pressure where it pushes, on an axis in logarithm."""
    net_MPa = column(rows, "net_kPa") * 1e-3
    pushing = np.where(net_MPa > 0, net_MPa, np.nan)
    axis.plot(column(rows, "separation_nm"), pushing, style, **line)


def _last_contact(rows: list[CsvRow]) -> float:
    """Largest separation at which any cell pushes (nm)."""
    touching = column(rows, "repulsive_MPa") > 0
    return float(column(rows, "separation_nm")[touching].max())
