"""Many cells under one plane: what a pad is, beside one cell."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from workflow.report.available import CsvRow, Results
from workflow.report.drawing import BLUE, ORANGE, SERIES, SOFT, draw
from workflow.report.numbers import cell, column, show, spread
from workflow.report.page import Block, DoubtNote, Figure, PageTable, stage, table
from workflow.report.verdict import causes_of, in_words

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
            "property": "name",
            "stated": cell("stated"),
            "after": cell("typical"),
            "of its spread remains": lambda row: f"{row['remains']:.0%}",
        },
    )


def _answer(answer: dict[str, Any]) -> Iterator[Block]:
    """What the answer is made of, and which input to measure better."""
    errors = answer["quantile_error_V"]
    solved = answer["points"]
    refused = len(answer["refused"])
    rows = [
        ("pull-in (V)", spread(answer["pull_in_V"]["quantiles"], "0.5", "0.05", "0.95")),
        (
            "capacitance closed (fF)",
            spread(answer["capacitance_fF"]["quantiles"], "0.5", "0.05", "0.95"),
        ),
        ("switches computed; of them without an answer", f"{solved + refused}; {refused}"),
        (
            "standard error of the median and of 5 and 95 %, by their number (V)",
            spread(errors, "0.5", "0.05", "0.95", digits=2),
        ),
        ("error of one of them by the number of its cells (V)", show(answer["cells_error_V"], 2)),
        *(
            (f"share of {CAUSES[cause]}", f"{share:.1%}")
            for cause, share in answer["causes"].items()
        ),
    ]
    yield PageTable(
        "Behind the interval of the release: median and 5 to 95 %", ("quantity", "value"), rows
    )
    if no_cause := causes_of(answer)[1]:
        yield DoubtNote(f"The shares of the variance name no cause: {no_cause}.")
    for kind, caption in KINDS.items():
        yield table(
            caption,
            [row for row in answer["sensitivity"] if row["varies"] == kind],
            {
                "uncertain": lambda row: in_words(row["name"]),
                "share of the variance": lambda row: f"{row['share_of_variance']:.1%}",
                "known exactly, the interval shrinks by": lambda row: (
                    f"{row['interval_shrinks_by']:.1%}"
                ),
            },
        )


def pad_curves(results: Results) -> str:
    """Closing and opening of the pad, and the well on opening."""
    rows = results.csv("pad/curves.csv")
    depths = sorted({float(row["depth_nm"]) for row in rows if row["branch"] == "opening"})
    opened = {
        depth: [row for row in rows if row["depth_nm"] and float(row["depth_nm"]) == depth]
        for depth in depths
    }
    deepest = opened[depths[0]]
    drawn = depths[:: max(1, len(depths) // 4)]

    def plot(range_axis, well):
        closing = [row for row in rows if row["branch"] == "closing"]
        _line(range_axis, closing, 1e-3, BLUE, "closing")
        for depth in drawn:
            _line(
                range_axis,
                opened[depth],
                1e-3,
                ORANGE,
                "opening" if depth == drawn[0] else None,
                "--",
            )
        top = max(column(closing, "net_kPa")) * 1e-3
        range_axis.set(
            yscale="log",
            ylim=(1e-4 * top, 2 * top),
            xlim=(depths[0] - 1, _last_contact(deepest) + 12),
        )
        range_axis.set(
            xlabel="separation (nm)",
            ylabel="net pressure (MPa)",
            title="closing, and opening from each depth",
        )
        range_axis.legend()
        lowest = 0.0
        for place, depth in enumerate(drawn):
            line = opened[depth]
            s, net, error = (
                column(line, name) for name in ("separation_nm", "net_kPa", "standard_error_kPa")
            )
            color = SERIES[place % len(SERIES)]
            well.plot(s, net, color=color, label=f"closed to {depth:.1f} nm")
            well.fill_between(s, net - error, net + error, color=color, alpha=0.15, linewidth=0)
            lowest = min(lowest, float(net.min()))
        well.axhline(0, color=SOFT, linewidth=0.8)
        well.set(xlim=(depths[0], _last_contact(deepest) + 12), ylim=(2.5 * lowest, -2.5 * lowest))
        well.set(
            xlabel="separation (nm)",
            ylabel="net pressure (kPa)",
            title="near the last contact, on opening",
        )
        well.legend()

    return draw(
        "pad-curves", "Mean pressure of a pad against separation", plot, (9.4, 3.4), columns=2
    )


def _line(
    axis, rows: list[CsvRow], scale: float, color: str, label: str | None, style: str = "-"
) -> None:
    net = column(rows, "net_kPa") * scale
    axis.plot(
        column(rows, "separation_nm"),
        np.where(net > 0, net, np.nan),
        style,
        color=color,
        label=label,
    )


def _last_contact(rows: list[CsvRow]) -> float:
    """Largest separation at which any cell pushes (nm)."""
    touching = column(rows, "repulsive_MPa") > 0
    return float(column(rows, "separation_nm")[touching].max())
