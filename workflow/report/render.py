"""The page from the result files of a scene."""

import re
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TypeVar

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup, escape

from asperity.foreign_text import shown
from asperity.foreign_yaml import load_mapping
from workflow.report.available import Results
from workflow.report.drawing import SUBSCRIPT
from workflow.report.first import first_screen
from workflow.report.gates import GATES, trust
from workflow.report.glossary import TERMS, Explainer, anchor
from workflow.report.limits import limits
from workflow.report.live.device import switch_data
from workflow.report.live.explorer import explorer, script_json
from workflow.report.page import Gate, Page, Part, Section, kind
from workflow.report.stages import PARTS
from workflow.report.studies import studies

HERE = Path(__file__).parent
SCRIPTS = ("controls", "spots", "explorer", "pad", "beam", "device")
"""In the order in which they build on each other."""


Built = TypeVar("Built")


def render(results: Results) -> str:
    """HTML of the report; sections appear only for results that exist, and one that fails costs itself alone."""
    broken: list[Gate] = []
    parts = []
    for key, title, stages in PARTS:
        sections: list[Section] = []
        for stage in stages:
            name = stage.__name__.rpartition(".")[2].replace("_", " ")
            section = guarded(name, partial(stage.describe, results), None, broken)
            sections += [section] if section else []
        parts += [Part(key, title, sections)] if sections else []
    live = {
        "surrogate": guarded("explorer", partial(explorer, results), None, broken),
        "switch_data": guarded("live switch", partial(switch_data, results), None, broken),
    }
    gates = [
        gate for build in GATES for gate in guarded("gates", partial(lambda one: [*one(results)], build), [], broken)
    ]
    first = guarded("first screen", partial(first_screen, results, gates), None, broken)
    page = Page(
        scene=results.scene,
        beside_paper=results.beside_paper,
        first=first,
        parts=parts,
        studies=guarded("studies", partial(studies, results), [], broken),
        limits=guarded("limits", partial(limits, results), [], broken),
        provenance=guarded("provenance", partial(_provenance, results), [], broken),
        light=trust([*gates, *broken]),
        gates=[*gates, *broken],
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


def guarded(name: str, build: Callable[[], Built], instead: Built, broken: list[Gate]) -> Built:
    """A part of the page; where it fails, `instead` and a gate that says so."""
    try:
        return build()
    except Exception as error:
        broken.append(failed(name, error))
        return instead


def failed(name: str, error: Exception) -> Gate:
    """The gate of a part that failed; the console says it, too."""
    reason = " ".join(f"{type(error).__name__}: {error}".split())[:300]
    print(f"report: {name} could not be drawn ({shown(reason)})", file=sys.stderr)
    return Gate(name, False, (f"This part of the page could not be drawn ({reason}).",), answer=False)


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
    record = load_mapping(results.root / "scene.yaml", "record of a run")
    rows = [("git commit", str(record.get("git_commit", "")))]
    return rows + [(name, str(version)) for name, version in record.get("versions", {}).items()]
