"""Inputs in use, as the paper's Table 1."""

import json
from collections.abc import Iterator
from typing import Any

import numpy as np

from mesoscale.inputs.distributions import Distribution
from mesoscale.inputs.table import distribution_of, from_rows
from mesoscale.settings.definitions import BY_NAME
from workflow.report.available import CsvRow, Results
from workflow.report.gates import accepted_failures
from workflow.report.numbers import number, show, shown_unit
from workflow.report.page import Block, PageTable, stage, table
from workflow.report.verdict import in_words


@stage("Inputs", "inputs.csv")
def describe(results: Results) -> Iterator[Block]:
    """Table 1 in use."""
    rows = results.csv("inputs.csv")
    failed = accepted_failures(results)
    columns = {
        "input": lambda row: in_words(row["parameter"]),
        "unit": lambda row: shown_unit(row["unit"]),
        "distribution": _distribution,
        "varies": lambda row: {"common": "one unknown value", "each": "device to device"}[
            row["varies"]
        ],
        "origin": lambda row: row["origin"] + ", whose gate failed" * (row["origin"] in failed),
        "source": "file",
    }
    yield ""
    title = "Inputs in use (the paper's Table 1)" if results.beside_paper else "Inputs in use"
    yield table(title, rows, columns, front=True)
    if beside := list(stated_beside_computed(results)):
        header = (
            "input",
            "stated: median, 5 to 95 %",
            "computed: median, 5 to 95 %",
            "the other median moves the release",
        )
        yield PageTable("Stated, although a stage computes it", header, beside, front=True)
    of_pad = results.rows("pad/inputs.csv")
    if other := [row for row in of_pad if row not in rows]:
        yield table("Of a pad, which holds all places of the film", other, columns, front=True)


def stated_beside_computed(results: Results) -> Iterator[tuple[str, str, str, str]]:
    """Inputs that the scene states and one of its stages computes, with what the choice does to the
    answer.
    """
    inputs = from_rows(results.csv("inputs.csv")).rows
    for item in inputs:
        computable = BY_NAME[item.name].stage != "literature"
        if item.origin != "literature" or not computable:
            continue
        for file in ("hardness/fit.json", "elastic/e_star.json", "topography/parameters.json"):
            if not results.has(file):
                continue
            entry = results.json(file).get("inputs", {}).get(item.name)
            if not entry:
                continue
            stated = item.distribution
            computed = distribution_of(entry, file)
            effect = _effect_V(results, item.name, stated, computed)
            yield in_words(item.name), _span(stated), _span(computed), effect


def _span(distribution: Distribution) -> str:
    low, median, high = distribution.quantile([0.05, 0.5, 0.95])
    return f"{show(float(median))} [{show(float(low))}, {show(float(high))}]"


def _effect_V(results: Results, name: str, stated: Distribution, computed: Distribution) -> str:
    """By how much the release moves, to first order, from the part of its variance that the stated
    spread makes.
    """
    switch = results.content("answer/pad_switch.json")
    answer: dict[str, Any] = switch.get("answer") or {"sensitivity": []}
    share = next(
        (row["share_of_variance"] for row in answer["sensitivity"] if row["name"] == name), None
    )
    low, median, high = stated.quantile([0.16, 0.5, 0.84])
    if share is None or low == high:
        return "not known: the scene has no spread of it"
    shift = abs(float(computed.quantile(0.5)) - median) / (0.5 * (high - low))
    return f"by about {show(shift * share**0.5 * answer['release_V']['std'])} V"


def _distribution(row: CsvRow) -> str:
    kind, _, values = row["distribution"].partition(" ")
    if kind == "samples":
        low, median, high = np.quantile(json.loads(values), [0.05, 0.5, 0.95])
        return f"samples, median {show(median)}, 5 to 95 %: {show(low)} to {show(high)}"
    if row["distribution"] == "fixed":
        return f"fixed at {number(row['a']):.4g}"
    a = f"{number(row['a']):.4g}"
    b = f"{number(row['b']):.4g}"
    if kind == "fixed":
        return f"fixed at {a}"
    if "uniform" in kind:
        return f"{kind.replace('log_uniform', 'uniform in the logarithm')} from {a} to {b}"
    text = f"normal, {a} ± {b}"
    if row["distribution"] == "truncated_normal":
        text += f" within {show(row.get('low'))} to {show(row.get('high'))}"
    return text
