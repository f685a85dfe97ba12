"""The page from the result files of a scene."""

import json
from pathlib import Path
from typing import Any

import yaml
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup, escape

from workflow.report.answer import answer
from workflow.report.available import Results
from workflow.report.drawing import SUBSCRIPT
from workflow.report.figures_contact import SYMBOLS
from workflow.report.gates import LIMITS, gates
from workflow.report.page import Page, kind
from workflow.report.sections import all_sections

HERE = Path(__file__).parent
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


def render(results: Results, scene: str) -> str:
    """HTML of the report; sections appear only for results that exist."""
    explorer = _explorer(results)
    page = Page(
        scene=scene,
        answer=answer(results),
        sections=all_sections(results),
        gates=gates(results),
        limits=LIMITS,
        provenance=_provenance(results),
        explorer=explorer,
    )
    environment = Environment(
        loader=FileSystemLoader(HERE), autoescape=True, undefined=StrictUndefined, trim_blocks=True
    )
    environment.filters["low"] = _low
    return environment.get_template("template.html.j2").render(
        page=page,
        kind=kind,
        style=(HERE / "style.css").read_text(encoding="utf-8"),
        script=(HERE / "explorer.js").read_text(encoding="utf-8"),
        explorer_json=_script_json(explorer),
    )


def _low(text: str) -> Markup:
    """Escaped text in which names such as d_c have their index set low."""
    return Markup(SUBSCRIPT.sub(r"\1<sub>\2</sub>", str(escape(text))))


def _explorer(results: Results) -> dict[str, Any] | None:
    """What the page's own script needs of the exported response surfaces."""
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


def _script_json(data: Any) -> str:
    """JSON that cannot end the script element it stands in."""
    return json.dumps(data, ensure_ascii=False, separators=(",", ":")).replace("</", "<\\/")


def _provenance(results: Results) -> list[tuple[str, str]]:
    if not results.has("scene.yaml"):
        return []
    record = yaml.safe_load((results.root / "scene.yaml").read_text(encoding="utf-8"))
    rows = [("git commit", str(record.get("git_commit", "")))]
    return rows + [(name, str(version)) for name, version in record.get("versions", {}).items()]
