"""Scenes with mistakes: by key and value, by structure, and in their text; the same seed gives the
same scene.
"""

import copy
import json
import random
from collections.abc import Callable, Iterator
from typing import Any

from pydantic import BaseModel

from asperity.guards.foreign_yaml import load_mapping
from workflow.scene import SCENES, Scene

VALUES: tuple[Any, ...] = (
    None, True, False, 0, -1, 1, 2, 10**9, 10**30, -0.0, 1e-300, 1e300, 0.5, -0.5, 1.0000001, "",
    " ", "0", "1e3",
    "nan", ".inf", "16:40", "0200", "1_000", "0x10", "yes", "2026-11-22", "$(id)", "${x}",
    "{scene}", "../..",
    "/etc/passwd", "a\tb", "a\nb", "é", "\u202e", "x" * 5000, [], {}, [0], [1, 2, 3], [[]],
    {"a": 1}, ["x"], [None],
    [1e300], [-1, "x"], list(range(500)), {"origin": "literature"}, {"file": "nowhere.csv"},
)  # fmt: skip
WORDS = (
    "*a", "&a", "<<:", "!!int", "!!python/none", "%YAML 1.1\n---", "\t", "{", "}", "[", "]", ": ",
    "#", "|", ">",
    "---", "...", "\x00", "\ufeff", "'", '"', "\\", "\r", ",", "? ", "- ", "@", "`", "0o7", "~",
)  # fmt: skip


def base_scenes() -> dict[str, dict[str, Any]]:
    """The shipped scenes, by name, each as if it were a user's."""
    found = {path.stem: load_mapping(path, "scene") for path in sorted(SCENES.glob("*.yaml"))}
    return {name: {**content, "name": f"my_{name}"} for name, content in found.items()}


def keys_of(model: BaseModel, above: tuple[str, ...] = ()) -> Iterator[tuple[str, ...]]:
    """Every key of a scene, as the way to it."""
    for name in type(model).model_fields:
        yield (*above, name)
        if isinstance(value := getattr(model, name), BaseModel):
            yield from keys_of(value, (*above, name))


KEYS = tuple(keys_of(Scene()))


def _set(content: dict[str, Any], way: tuple[str, ...], value: Any) -> None:
    for part in way[:-1]:
        content = content.setdefault(part, {})
        if not isinstance(content, dict):
            return
    content[way[-1]] = value


def _places(content: Any, above: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    items = (
        content.items()
        if isinstance(content, dict)
        else enumerate(content)
        if isinstance(content, list)
        else ()
    )
    for key, value in items:
        yield (*above, key)
        yield from _places(value, (*above, key))


def _owner(content: Any, way: tuple[Any, ...]) -> Any:
    for part in way[:-1]:
        content = content[part]
    return content


def _any_key(rng: random.Random, content: dict[str, Any]) -> None:
    _set(content, rng.choice(KEYS), copy.deepcopy(rng.choice(VALUES)))


def _given_key(rng: random.Random, content: dict[str, Any]) -> None:
    way = rng.choice(list(_places(content)))
    _owner(content, way)[way[-1]] = copy.deepcopy(rng.choice(VALUES))


def _scaled_number(rng: random.Random, content: dict[str, Any]) -> None:
    numbers = _numbers(content)
    if numbers:
        way = rng.choice(numbers)
        _owner(content, way)[way[-1]] *= rng.choice((-1, 0, 0.5, 2, 1e-9, 1e9))


def _other_number(rng: random.Random, content: dict[str, Any]) -> None:
    """A number of the same kind, up to twice as large or half as large."""
    numbers = _numbers(content)
    if numbers:
        way = rng.choice(numbers)
        owner, name = _owner(content, way), way[-1]
        other = owner[name] * 2.0 ** rng.uniform(-1.0, 1.0)
        owner[name] = round(other) if isinstance(owner[name], int) else other


def _numbers(content: dict[str, Any]) -> list[tuple[Any, ...]]:
    """The way to each number of a scene."""
    return [way for way in _places(content) if type(_owner(content, way)[way[-1]]) in (int, float)]


def _misspelt(rng: random.Random, content: dict[str, Any]) -> None:
    way = rng.choice([way for way in _places(content) if isinstance(way[-1], str)])
    owner, name = _owner(content, way), way[-1]
    place = rng.randrange(len(name))
    owner[name[:place] + rng.choice(("", "x", name[place] * 2)) + name[place + 1 :]] = owner.pop(
        name
    )


def _moved(rng: random.Random, content: dict[str, Any]) -> None:
    ways = [way for way in _places(content) if isinstance(way[-1], str)]
    way = rng.choice(ways)
    _set(content, rng.choice(KEYS), _owner(content, way).pop(way[-1]))


def _deleted(rng: random.Random, content: dict[str, Any]) -> None:
    way = rng.choice(list(_places(content)))
    del _owner(content, way)[way[-1]]


_STRUCTURE: tuple[Callable[[random.Random, dict[str, Any]], None], ...] = (
    _any_key, _any_key, _given_key, _given_key, _scaled_number, _scaled_number, _misspelt, _moved,
    _deleted,
)  # fmt: skip


def _broken_text(rng: random.Random, text: str) -> str:
    place = rng.randrange(len(text))
    kind = rng.randrange(4)
    if kind == 0:
        return text[:place] + rng.choice(WORDS) + text[place:]
    if kind == 1:
        return text[:place] + text[place + rng.randrange(1, 20) :]
    if kind == 2:
        return text[:place]
    return text[:place] + chr(rng.randrange(1, 256)) + text[place + 1 :]


def varied(seed: int) -> str:
    """Text of a shipped scene, one to four of whose numbers are halved, doubled or between."""
    rng = random.Random(seed)
    content = copy.deepcopy(rng.choice(list(base_scenes().values())))
    for _ in range(rng.randint(1, 4)):
        _other_number(rng, content)
    return json.dumps(content, ensure_ascii=False, indent=1)


def mutated(seed: int) -> str:
    """Text of a scene with one to three mistakes: two thirds of the scenes by content, one third in
    the text.
    """
    rng = random.Random(seed)
    if rng.random() < 1 / 3:
        text = (
            rng.choice(sorted(SCENES.glob("*.yaml")))
            .read_text(encoding="utf-8")
            .replace("name: ", "name: my_")
        )
        for _ in range(rng.choice((1, 1, 2))):
            text = _broken_text(rng, text) or " "
        return text
    content = copy.deepcopy(rng.choice(list(base_scenes().values())))
    for _ in range(rng.choice((1, 1, 2, 3))):
        if content:
            rng.choice(_STRUCTURE)(rng, content)
    return json.dumps(content, ensure_ascii=False, indent=1)  # JSON is YAML
