"""The judge of a scene with mistakes, by what a run does before its first job.

A scene is refused in single lines that begin with its file, or accepted as it stands: every value
that an independent reader (text only, no types) finds in the file is the value that the run would
use, and the published JSON Schema agrees. Anything else is a fault: another exception, a refusal of
several lines, a value that was read as another.
"""

import json
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import jsonschema
import yaml

from asperity.guards.foreign_yaml import load_mapping
from workflow.scene import Scene, SceneError, files_of, load_scene, locate
from workflow.scene.checks import mistakes
from workflow.scene.documented import SCHEMA

LONGEST_LINE = 1500  # an unknown key lists the known ones
PLAIN = re.compile(r"[-+]?(0|[1-9][0-9]*)?(\.[0-9]*)?([eE][-+]?[0-9]+)?")
TRUTH = {True: {"true", "yes", "on"}, False: {"false", "no", "off"}, None: {"", "~", "null"}}


def judge(text: str, path: Path) -> tuple[str, str]:
    """Outcome (refused, used or fault) and its words, for a scene written to `path`."""
    path.write_bytes(text.encode("utf-8", "surrogatepass"))
    try:
        scene = load_scene(str(path))
        lines = [f"{path}: {line}" for line in _beyond_keys(scene, path)]
    except SceneError as error:
        lines = str(error).split("\n")
    except Exception as error:  # whatever comes
        return "fault", f"{type(error).__name__}: {error}"
    if lines:
        bad = next(
            (
                line
                for line in lines
                if not (line.startswith(str(path)) and len(line) < LONGEST_LINE)
            ),
            None,
        )
        broken = [line for line in lines if "".join(line.splitlines()) != line]
        if bad or broken:
            return "fault", f"refusal of another form: {bad or broken[0]}"
        return "refused", " | ".join(line.removeprefix(f"{path}: ") for line in lines)
    if different := _misread(scene, path):
        return "fault", different
    return "used", ""


def _beyond_keys(scene: Scene, path: Path) -> list[str]:
    """As the workflow's rules check a scene: the files it names, then contradictions and the
    machine.
    """
    samples = {}
    for name, row in scene.inputs.rows().items():
        if isinstance(row.values, str):
            samples[name] = locate(str(path), f"inputs.{name}.values", [row.values])[0]
    if "topography" in scene.stages():
        locate(str(path), "topography.scans", files_of(str(path), scene.topography.scans))
    for measured in scene.measurements.tables if "calibration" in scene.inputs.origins() else ():
        locate(str(path), "measurements.tables.file", [measured.file])
    return mistakes(scene, samples)


@cache
def _schema() -> Any:
    schema = json.loads(SCHEMA.read_text(encoding="utf-8"))
    return jsonschema.validators.validator_for(schema)(schema)


def _misread(scene: Scene, path: Path) -> str:
    """What the scene holds otherwise than its file; empty: nothing."""
    error = jsonschema.exceptions.best_match(_schema().iter_errors(load_mapping(path, "scene")))
    if error is not None:
        return f"the schema refuses {'.'.join(map(str, error.absolute_path))}: {error.message}"
    given = yaml.load(path.read_bytes(), yaml.BaseLoader)
    for way, word in _leaves(given or {}):
        used: Any = scene.model_dump(mode="json")
        for part in way:
            used = used[part]
        if not _same(used, word):
            return f"{'.'.join(map(str, way))}: {word!r} was read as {used!r}"
    return ""


def _leaves(content: Any, above: tuple[Any, ...] = ()) -> Iterator[tuple[tuple[Any, ...], str]]:
    if isinstance(content, str):
        yield above, content
        return
    for key, value in content.items() if isinstance(content, dict) else enumerate(content):
        yield from _leaves(value, (*above, key))


def _same(used: Any, word: str) -> bool:
    if used is None or isinstance(used, bool):
        return word.lower() in TRUTH[used]
    if isinstance(used, str):
        return used == word
    return isinstance(used, (int, float)) and bool(PLAIN.fullmatch(word)) and float(word) == used
