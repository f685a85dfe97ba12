"""Many cells under one plane: what a pad is, beside one cell."""

from typing import Any

import numpy as np

from workflow.report.available import Results, Row
from workflow.report.contributions import contributions
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
COUNTED = {
    "pad.cells": "cells of the pad",
    "pad.draws": "pads at other inputs",
    "hardness.seeds": "glasses that are pressed",
    "elastic.structures": "glasses behind E*",
}


def describe(results: Results) -> Section | None:
    """The pad's curves, its adhesion against the number of cells, and what the answer is made of."""
    if not results.has("pad/curves.csv", "pad/adhesion.csv", "device/pad_switch.json"):
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
    section.add(
        adhesion_by_cells(results),
        "Largest net adhesive pressure on opening against the number of cells of a pad, with the scatter between "
        "pads. The point at the right is the mean of all computed cells with its standard error.",
    )
    if answer := switch.get("answer"):
        section.blocks += _answer(answer)
        if parts := contributions(results):
            section.blocks.append(_left_open(parts))
        section.notes.append(
            f"asperity plan {results.scene} --budget 1h shows minutes against this error, and counts for them."
        )
    section.notes.append(
        "Where the scene does not state how its devices vary (device.spread), their spread is an assumption."
    )
    section.files += ["pad/curves.csv", "pad/curves.h5", "pad/adhesion.csv", "device/pad_switch.json"]
    return section


def _answer(answer: dict[str, Any]) -> list[Table]:
    """What the answer is made of, and which input to measure better."""

    def spread(key: str) -> str:
        quantiles = answer[key]["quantiles"]
        return f"{show(quantiles['0.5'])} [{show(quantiles['0.05'])}, {show(quantiles['0.95'])}]" if quantiles else "–"

    points = answer["design"]
    rows = [
        ("pull-in (V)", spread("pull_in_V")),
        ("capacitance closed (fF)", spread("capacitance_fF")),
        ("switches computed; of them without an answer", f"{points['points']}; {len(points['refused'])}"),
        ("of them that press harder than pads were computed", str(points["deepened"])),
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


def _left_open(parts: dict[str, Any]) -> Table:
    """What inputs and counts leave open of the release, from `contributions`."""
    rows = [(name, f"{value:.2g}", "no count") for name, value in parts["fixed_V"].items()]
    for key, count in parts["counts"].items():
        rows.append((f"{COUNTED[key]}: {count}", f"{np.sqrt(parts['variance_V2'][key] / count):.2g}", key))
    columns = ("left open by", "deviation of the release (V)", "reduced by")
    return Table("What more computing would narrow: deviations add up by their squares", columns, rows)


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


def adhesion_by_cells(results: Results) -> str:
    """Largest net adhesive pressure against the number of cells."""
    rows = results.csv("pad/adhesion.csv")
    depths = sorted({float(row["depth_nm"]) for row in rows})
    shown = depths[:: max(1, len(depths) // 3)]

    def plot(axis):
        for place, depth in enumerate(shown):
            part = [row for row in rows if float(row["depth_nm"]) == depth]
            groups = [row for row in part if row["method"] == "groups"]
            color = SERIES[place % len(SERIES)]
            cells, mean, scatter = (column(groups, key) for key in ("cells", "net_adhesion_kPa", "pad_scatter_kPa"))
            label = f"closed to {depth:.1f} nm, {float(part[0]['closed_to_MPa']):.1f} MPa"
            axis.errorbar(
                cells * 1.04**place, mean, np.minimum(scatter, 0.95 * mean), fmt="o-", color=color, label=label
            )
            whole = part[-1]
            axis.errorbar(
                float(whole["cells"]) * 1.04**place,
                float(whole["net_adhesion_kPa"]),
                float(whole["standard_error_kPa"]),
                fmt="s",
                color=color,
                mfc="none",
            )
        axis.set(xscale="log", yscale="log", xlabel="cells of the pad", ylabel="net adhesive pressure (kPa)")
        axis.set_ylim(top=30 * axis.get_ylim()[1])  # room for the legend
        axis.legend(loc="upper right")

    return draw("pad-adhesion", "Net adhesive pressure against the number of cells", plot)
