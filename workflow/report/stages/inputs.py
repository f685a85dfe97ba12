"""Inputs in use, as the paper's Table 1."""

import json

import numpy as np

from workflow.report.available import Results, Row
from workflow.report.numbers import SYMBOLS, number, show, shown_unit
from workflow.report.page import Section, Table


def describe(results: Results) -> Section | None:
    """Table 1 in use."""
    if not results.has("inputs.csv"):
        return None
    rows = results.csv("inputs.csv")
    section = Section("inputs", "Inputs", "", files=["inputs.csv"])
    title = "Inputs in use (the paper's Table 1)" if results.beside_paper else "Inputs in use"
    section.front.append(_table(title, rows))
    of_pad = results.csv("pad/inputs.csv") if results.has("pad/inputs.csv") else []
    if other := [row for row in of_pad if row not in rows]:
        section.front.append(_table("Of a pad, which holds all places of the film", other))
    return section


def _table(title: str, rows: list[Row]) -> Table:
    lines = [
        (
            SYMBOLS.get(row["parameter"], row["parameter"]),
            shown_unit(row["unit"]) or "–",
            _distribution(row),
            row["origin"],
            row.get("file", ""),
        )
        for row in rows
    ]
    return Table(title, ("input", "unit", "distribution", "origin", "source"), lines)


def _distribution(row: Row) -> str:
    kind, _, values = row["distribution"].partition(" ")
    if kind == "samples":
        low, median, high = np.quantile(json.loads(values), [0.05, 0.5, 0.95])
        return f"samples, median {show(median)}, 5 to 95 %: {show(low)} to {show(high)}"
    if row["distribution"] == "fixed":
        return f"fixed at {number(row['a']):.4g}"
    a, b = f"{number(row['a']):.4g}", f"{number(row['b']):.4g}"
    if kind == "fixed":
        return f"fixed at {a}"
    if row["distribution"] == "uniform":
        return f"uniform from {a} to {b}"
    text = f"normal, {a} ± {b}"
    if row["distribution"] == "truncated_normal":
        text += f" within {show(row.get('low'))} to {show(row.get('high'))}"
    return text
