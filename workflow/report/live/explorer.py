"""What the page's own script needs: the exported responses behind sliders."""

import json
from typing import Any

import numpy as np

from mesoscale.law.parameters import PARAMETERS
from mesoscale.settings.definitions import definition
from workflow.report.available import Results
from workflow.report.gates import faint_outputs
from workflow.report.numbers import shown_unit

SURROGATE_KEYS = ("name", "transform", "terms", "below")


def explorer(results: Results) -> dict[str, Any] | None:
    """What the page's own script needs of the exported responses."""
    if not results.has("uq/surrogate.json"):
        return None
    surrogate = results.json("uq/surrogate.json")
    if len(surrogate["outputs"]) < 2 * len(PARAMETERS):
        return None  # an output that too few runs determine has no response
    inputs = [
        {
            "name": row["name"],
            "label": _label(row["name"]),
            "unit": shown_unit(row["unit"]),
            "low": row["low"],
            "high": row["high"],
        }
        for row in surrogate["inputs"]
    ]
    outputs = [{key: output[key] for key in SURROGATE_KEYS if key in output} for output in surrogate["outputs"]]
    return {
        "inputs": inputs,
        "outputs": outputs,
        "law": surrogate["law"],
        "scatter": _scatter(surrogate["scatter"]),
        "faint": [name for name in PARAMETERS if {name, f"delta_{name}"} & faint_outputs(results).keys()],
    }


def _label(name: str) -> str:
    """An input in words with its symbol, which some have among the words."""
    label, symbol = definition(name).label, definition(name).symbol
    return label if symbol in label.split() else f"{label} {symbol}"


def _scatter(joint: dict[str, Any] | None) -> dict[str, Any] | None:
    """Scatter of single surfaces with a factor F of its covariance F Fᵀ, so that the page need not factorise."""
    if joint is None:
        return None
    values, vectors = np.linalg.eigh(np.array(joint["covariance"], float))
    factor = vectors * np.sqrt(np.maximum(values, 0))  # rounding may leave a value just below zero
    kept = {key: joint[key] for key in ("outputs", "transforms", "mean")}
    return {**kept, "factor": factor.tolist()}


def script_json(data: Any) -> str:
    """JSON that cannot end the script element it stands in."""
    return json.dumps(data, ensure_ascii=False, separators=(",", ":")).replace("</", "<\\/")
