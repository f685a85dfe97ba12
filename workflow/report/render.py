"""The page from the result files of a scene."""

import re
from pathlib import Path

import yaml
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup, escape

from workflow.report.answer import answer
from workflow.report.available import Results
from workflow.report.drawing import SUBSCRIPT
from workflow.report.glossary import TERMS, Explainer, anchor
from workflow.report.limits import limits
from workflow.report.live.device import switch_data
from workflow.report.live.explorer import explorer, script_json
from workflow.report.page import Page, kind
from workflow.report.stages import STAGES
from workflow.report.studies import studies

HERE = Path(__file__).parent
SCRIPTS = ("controls", "spots", "explorer", "pad", "beam", "device")
"""In the order in which they build on each other."""


def render(results: Results) -> str:
    """HTML of the report; sections appear only for results that exist."""
    sections = [section for stage in STAGES if (section := stage.describe(results))] + studies(results)
    gates = [gate for section in sections for gate in section.gates]
    live = {"surrogate": explorer(results), "switch_data": switch_data(results)}
    page = Page(
        scene=results.scene,
        beside_paper=results.beside_paper,
        answer=answer(results, gates),
        sections=sections,
        gates=gates,
        limits=limits(results),
        provenance=_provenance(results),
        moves=results.has("curves/spots.h5"),
        terms=list(TERMS.items()),
        files=sorted(results.paths),
        live={name: data for name, data in live.items() if data is not None},
    )
    environment = Environment(
        loader=FileSystemLoader(HERE), autoescape=True, undefined=StrictUndefined, trim_blocks=True
    )
    explainer = Explainer()
    environment.filters["low"] = low
    environment.filters["explain"] = lambda text, place: _lowered(explainer(text, place))
    environment.filters["anchor"] = anchor
    environment.filters["script_json"] = script_json
    return environment.get_template("template.html.j2").render(
        page=page,
        kind=kind,
        style=(HERE / "style.css").read_text(encoding="utf-8"),
        script="".join((HERE / "live" / f"{name}.js").read_text(encoding="utf-8") for name in SCRIPTS),
    )


def low(text: str) -> Markup:
    """Escaped text in which names such as d_c have their index set low."""
    return _lowered(escape(text))


def _lowered(text: Markup) -> Markup:
    """The same between the tags of escaped text."""
    parts = re.split(r"(<[^>]*>)", str(text))
    return Markup("".join(part if part.startswith("<") else SUBSCRIPT.sub(r"\1<sub>\2</sub>", part) for part in parts))


def _provenance(results: Results) -> list[tuple[str, str]]:
    if not results.has("scene.yaml"):
        return []
    record = yaml.safe_load((results.root / "scene.yaml").read_text(encoding="utf-8"))
    rows = [("git commit", str(record.get("git_commit", "")))]
    return rows + [(name, str(version)) for name, version in record.get("versions", {}).items()]
