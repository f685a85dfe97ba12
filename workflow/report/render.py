"""The page from the result files of a scene."""

import re
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import TypeVar

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup, escape

from asperity.guards.foreign_text import shown
from workflow.report.available import Results
from workflow.report.drawing import SUBSCRIPT
from workflow.report.first import first_screen
from workflow.report.gates import GATES, accepted_failures, trust
from workflow.report.limits import limits
from workflow.report.page import Gate
from workflow.report.stages import PARTS
from workflow.report.studies import studies

HERE = Path(__file__).parent

Built = TypeVar("Built")


def render(results: Results) -> str:
    """HTML of the report; sections appear only for results that exist, and one that fails costs
    itself alone.
    """
    broken: list[Gate] = []
    filled = []
    for anchor, title, stages in PARTS:
        built = [
            guarded(_name(stage), partial(stage.describe, results), None, broken)
            for stage in stages
        ]
        if sections := [section for section in built if section]:
            filled.append({"anchor": anchor, "title": title, "sections": sections})
    gates = [
        gate
        for build in GATES
        for gate in guarded("gates", lambda builder=build: [*builder(results)], [], broken)
    ]
    first = guarded("first screen", partial(first_screen, results, gates), None, broken)
    failures = guarded("accepted gates", partial(accepted_failures, results), {}, broken)
    page = {
        "rests_on": ", ".join(failures),
        "why_failed": "; ".join(
            f"{stage}: {', '.join(gate.reasons)}" for stage, gate in failures.items()
        ),
        "scene": results.scene,
        "beside_paper": results.beside_paper,
        "first": first,
        "parts": filled,
        "studies": guarded("studies", partial(studies, results), [], broken),
        "limits": guarded("limits", partial(limits, results), [], broken),
        "provenance": guarded("provenance", partial(_provenance, results), [], broken),
        "light": trust([*gates, *broken]),
        "gates": [*gates, *broken],
        "files": sorted(results.paths),
    }
    environment = Environment(
        loader=FileSystemLoader(HERE), autoescape=True, undefined=StrictUndefined, trim_blocks=True
    )
    environment.filters["low"] = low
    style = (HERE / "style.css").read_text(encoding="utf-8")
    return environment.get_template("template.html.j2").render(page=page, style=style)


def _name(stage: object) -> str:
    return str(getattr(stage, "__name__", "")).rpartition(".")[2].replace("_", " ")


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
    return Gate(
        name, False, (f"This part of the page could not be drawn ({reason}).",), answer=False
    )


def low(text: str) -> Markup:
    """Escaped text with low indices in names such as d_c, and one kind of space before per cent."""
    written = re.sub(r"(?<=\d)[ \u00a0]?%", "\u202f%", str(escape(text)))
    return Markup(SUBSCRIPT.sub(r"\1<sub>\2</sub>", written))


def _provenance(results: Results) -> list[tuple[str, str]]:
    if not results.has("scene.yaml"):
        return []
    rows = [("git commit", str(results.record.get("git_commit", "")))]
    return rows + [
        (name, str(version)) for name, version in results.record.get("versions", {}).items()
    ]
