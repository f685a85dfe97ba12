"""Inputs in use, as the paper's Table 1."""

import json
from collections.abc import Iterator

import numpy as np

from workflow.report.available import Results, Row
from workflow.report.numbers import number, show, shown_unit
from workflow.report.page import Block, stage, table
from workflow.report.verdict import in_words


@stage("Inputs", "inputs.csv")
def describe(results: Results) -> Iterator[Block]:
    """Table 1 in use."""
    rows = results.csv("inputs.csv")
    columns = {
        "input": lambda row: in_words(row["parameter"]),
        "unit": lambda row: shown_unit(row["unit"]),
        "distribution": _distribution,
        "varies": lambda row: {"common": "one unknown value", "each": "device to device"}[row["varies"]],
        "origin": "origin",
        "source": "file",
    }
    yield ""
    title = "Inputs in use (the paper's Table 1)" if results.beside_paper else "Inputs in use"
    yield table(title, rows, columns, front=True)
    of_pad = results.csv("pad/inputs.csv") if results.has("pad/inputs.csv") else []
    if other := [row for row in of_pad if row not in rows]:
        yield table("Of a pad, which holds all places of the film", other, columns, front=True)


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
