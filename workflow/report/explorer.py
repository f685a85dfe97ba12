"""What the page's own script needs: the exported responses behind sliders."""

import json
from typing import Any

from workflow.report.available import Results
from workflow.report.numbers import SYMBOLS

NAMES = {
    "hamaker": "Hamaker constant",
    "e_star": "effective modulus",
    "h_macro": "macroscopic hardness",
    "h_prime": "size effect of hardness",
    "q0": "roll-off wave vector",
    "hurst": "Hurst exponent",
    "rms": "RMS roughness",
    "gap_cutoff": "gap cutoff",
}
SURROGATE_KEYS = ("name", "transform", "terms", "residual_std")


def explorer(results: Results) -> dict[str, Any] | None:
    """What the page's own script needs of the exported responses."""
    if not results.has("uq/surrogate.json"):
        return None
    surrogate = results.json("uq/surrogate.json")
    inputs = [
        {
            "name": row["name"],
            "label": f"{NAMES.get(row['name'], row['name'])} {SYMBOLS.get(row['name'], '')}".strip(),
            "unit": row["unit"],
            "low": row["low"],
            "high": row["high"],
        }
        for row in surrogate["inputs"]
    ]
    outputs = [{key: output[key] for key in SURROGATE_KEYS} for output in surrogate["outputs"]]
    for output in outputs:
        output["residual_std"] = output["residual_std"] or 0.0
    return {"inputs": inputs, "outputs": outputs, "law": surrogate["law"]}


def script_json(data: Any) -> str:
    """JSON that cannot end the script element it stands in."""
    return json.dumps(data, ensure_ascii=False, separators=(",", ":")).replace("</", "<\\/")
