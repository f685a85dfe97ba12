"""Scenes and the files that they name, found, read and checked; each mistake is one line."""

import json
import os
import re
import time
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from asperity.guards.bundle import ROOT
from asperity.guards.errors import InputError
from asperity.guards.foreign_files import is_of_the_system
from asperity.guards.foreign_text import did_you_mean, shown
from asperity.guards.foreign_yaml import MistakenYaml, load_mapping
from mesoscale.topography.measurements import check_count, files_in
from workflow.files.checksums import CLOCK_S
from workflow.scene.accepted import accepted_values, field_at, model_at
from workflow.scene.definition import Scene
from workflow.scene.renamed import SCENES as RENAMED_SCENES
from workflow.scene.renamed import TAILS, name_now

SCENES = ROOT / "config" / "scenes"
SHOWN = 60  # characters of a value or key in a message
MOST_PARENTS = 10  # scenes that extend each other in a row


class SceneError(Exception):
    """A scene that cannot be used; the message has one line per mistake."""


def load_scene(name_or_path: str) -> Scene:
    """Read and validate a scene by name (config/scenes/<name>.yaml) or by the path of a YAML file.

    Raises
    ------
    SceneError : the scene is missing, unreadable or has a mistake; one line per mistake, each
        naming file, key, value and what is accepted.
    """
    path, *parents = lineage(str(name_or_path))
    content: dict[str, Any] = {}
    for file in reversed([path, *parents]):
        stated = _content_of(file)
        content = _merged(content, stated) | {"name": stated.get("name", file.stem)}
    if str(content["name"]) in _shipped() and path.resolve().parent != SCENES:
        raise SceneError(
            f"{path}: name = {content['name']}: the name of a shipped scene, whose results it would"
            " take; choose another (key `name`, or the name of the file)"
        )
    try:
        # JSON mode: strict types, yet a YAML list may fill a tuple
        return Scene.model_validate_json(json.dumps(content), strict=True)
    except ValidationError as error:
        lines = [_explain(path, item) for item in error.errors()]
        raise SceneError("\n".join(dict.fromkeys(lines))) from None


def _content_of(path: Path) -> dict[str, Any]:
    """The keys of a scene's own file."""
    if not str(path).isprintable():
        raise SceneError(
            f"{shown(str(path))}: characters that do not print; rename the file or its folder"
        )
    try:
        return load_mapping(path, "scene")
    except MistakenYaml as error:
        raise SceneError(f"{path}: {error}") from None


def lineage(name_or_path: str) -> list[Path]:
    """The file of a scene, that of the scene it extends, and so on.

    Raises
    ------
    SceneError : one of them is missing or unreadable, or extends itself.
    """
    files = [find_scene(name_or_path)]
    while parent := _content_of(files[-1]).get("extends"):
        child = files[-1]
        if not isinstance(parent, str):
            raise SceneError(
                f"{child}: extends = {_cut(json.dumps(parent))}: accepted is the name or path of a"
                " scene"
            )
        beside = child.parent / parent
        try:
            files.append(
                beside if Path(parent).suffix and os.path.isfile(beside) else find_scene(parent)
            )
        except SceneError as error:
            raise SceneError(f"{child}: extends: {error}") from None
        if files[-1].resolve() in [file.resolve() for file in files[:-1]]:
            raise SceneError(
                f"{child}: extends = {_cut(parent)}: this scene extends itself; name another or"
                " delete it"
            )
        if len(files) > MOST_PARENTS:
            raise SceneError(
                f"{child}: extends = {_cut(parent)}: more than {MOST_PARENTS} scenes extend each"
                " other"
            )
    return files


def _merged(parent: dict[str, Any], child: dict[str, Any]) -> dict[str, Any]:
    """The keys of a scene over those of the scene it extends; lists and the rows of `inputs` are
    replaced whole.
    """
    merged = dict(parent)
    for key, value in child.items():
        former = parent.get(key)
        if isinstance(former, dict) and isinstance(value, dict) and "origin" not in former:
            value = _merged(former, value)
        merged[key] = value
    return merged


def find_scene(name_or_path: str) -> Path:
    """The file of a scene that is given by name or by path.

    Raises
    ------
    SceneError : there is none.
    """
    path = Path(name_or_path)
    word = _cut(name_or_path)
    if path.suffix in {".yaml", ".yml"} or len(path.parts) > 1:
        if not os.path.isfile(path):  # unlike Path.is_file, False for a name that is too long
            raise SceneError(
                f"scene={word}: no such file; give the path of a YAML file or a scene's name"
            )
        return path
    known = _shipped()
    if name_or_path not in known:
        if renamed := name_now(name_or_path, RENAMED_SCENES):
            raise SceneError(f"scene={word}: {renamed}")
        raise SceneError(
            f"scene={word}: unknown scene; accepted: {', '.join(known)}, or the path of a YAML file"
        )
    return known[name_or_path]


def _shipped() -> dict[str, Path]:
    return {file.stem: file for file in sorted(SCENES.glob("*.yaml"))}


def locate(scene: str, key: str, names: Iterable[str]) -> list[str]:
    """Paths of files that a scene names: as seen from here, else beside the scene.

    Parameters
    ----------
    scene : name or path of the scene
    key : under which it names them

    Raises
    ------
    SceneError : a file is missing, dated in the future or of the system, or its path has brackets
        or characters that do not print; one line per file.
    """
    files = []
    mistakes = []
    beside = _folders_of(scene)
    for name in names:
        places = [name, *(os.path.normpath(folder / name) for folder in beside)]
        path = next((place for place in places if os.path.isfile(place)), None)
        if path is None:
            mistakes.append(
                f"{scene}: {key} = {_cut(name)}: no such file here or beside the scene; correct the"
                " path"
            )
        elif not path.isprintable():
            mistakes.append(
                f"{scene}: {key} = {shown(path)}: characters that do not print; rename the file"
            )
        elif set(path) & set("{}"):
            mistakes.append(
                f"{scene}: {key} = {_cut(path)}: braces mean wildcards to Snakemake; rename the"
                " file"
            )
        elif {"<", ">"} <= set(path):
            mistakes.append(
                f"{scene}: {key} = {_cut(path)}: angle brackets mean path variables to Snakemake;"
                " rename the file"
            )
        elif is_of_the_system(path):
            mistakes.append(
                f"{scene}: {key} = {_cut(path)}: of the system, not of data; copy what you need"
                " of it"
            )
        elif os.path.getmtime(path) > time.time() + CLOCK_S:
            mistakes.append(
                f"{scene}: {key} = {_cut(path)}: dated in the future, so that every result of it"
                " would seem older; set its date (touch) or the clock"
            )
        else:
            files.append(path)
    if mistakes:
        raise SceneError("\n".join(mistakes))
    return files


def files_of(scene: str, names: Iterable[str]) -> list[str]:
    """The names that a scene gives, a folder (as seen from here, else beside the scene) replaced by
    its files.

    Parameters
    ----------
    scene : name or path of the scene

    Raises
    ------
    SceneError : more files than are described together.
    """
    files: list[str] = []
    for name in names:
        places = [Path(name), *(folder / name for folder in _folders_of(scene))]
        folder = next((place for place in places if os.path.isdir(place)), None)
        files += [name] if folder is None else files_in(folder)
    try:
        check_count("topography.scans", files)
    except InputError as error:
        raise SceneError(f"{scene}: {error}") from None
    return files


def _folders_of(scene: str) -> list[Path]:
    """Folders of the files of a scene, which is given by name or by path, and of those that it
    extends.
    """
    return [file.parent for file in lineage(scene)]


def _cut(text: str) -> str:
    text = " ".join(text.split())
    return text if len(text) <= SHOWN else text[: SHOWN - 3] + "..."


BRANCH = re.compile(r"__root__|literal\[.*\]|constrained-float")
"""Steps of a location that say which branch of a type was tried, and are no key."""


def _explain(path: Path, error: Any) -> str:
    """One line for one pydantic error."""
    location = tuple(step for step in error["loc"] if not BRANCH.fullmatch(str(step)))
    key = ".".join(_cut(str(step)) for step in location)
    if error["type"] == "extra_forbidden":
        owner = model_at(location[:-1])
        known = list(owner.model_fields) if owner else []
        return (
            f"{path}: {key}: unknown key{did_you_mean(str(location[-1]), known)} (accepted:"
            f" {', '.join(known)})"
        )
    if location[:1] == ("tails",) and (renamed := name_now(str(error["input"]), TAILS)):
        return f"{path}: tails: {renamed}; write `{TAILS[error['input']]}`"
    field = field_at(location)
    accepted = accepted_values(field) if field else error["msg"]
    if error["type"] == "missing":
        return f"{path}: {key}: missing; accepted is {accepted}"
    value = _cut(json.dumps(error["input"], ensure_ascii=False, default=str))
    if error["type"] == "json_invalid":
        return (
            f"{path}: holds text that is no Unicode (half of a surrogate pair); write the character"
            " itself"
        )
    if error["type"] == "value_error":
        return f"{path}: {key + ': ' if key else ''}{error['msg'].removeprefix('Value error, ')}"
    return f"{path}: {key} = {value}: accepted is {accepted}"
