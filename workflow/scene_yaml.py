"""Scenes as YAML: plain data only, and what looks like a number is one only if everybody reads it so.

YAML 1.1 reads `16:40` as 1000 (base 60), `0200` as 128 (octal), `1_000` as 1000 and 2026-11-22 as a date; here they
stay text, which a number's key then refuses.  Aliases are refused: a scene of 342 bytes can unfold to gigabytes.
"""

import re
from pathlib import Path
from typing import Any

import yaml

MAX_BYTES = 1_000_000
MAX_DEPTH = 20  # the settings need 6
NUMBERS = {
    "int": r"^[-+]?(?:0|[1-9][0-9]*)$",
    "float": r"^[-+]?(?:(?:0|[1-9][0-9]*)(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][-+]?[0-9]+)?$",  # 7e3 too
}
KEPT = ("bool", "null")  # as YAML 1.1 has them


class MistakenYaml(Exception):
    """A file that is no scene; the message is one line."""


class _Loader(yaml.SafeLoader):
    """Safe YAML without aliases, merge keys, duplicate keys, deep nesting, and numbers in disguise."""

    yaml_implicit_resolvers: dict[str, list[tuple[str, re.Pattern[str]]]] = {}  # noqa: RUF012 (PyYAML's own interface)
    depth = 0

    def compose_node(self, parent: yaml.Node | None, index: Any) -> yaml.Node | None:
        event = self.peek_event()
        if isinstance(event, yaml.AliasEvent):
            self._refuse(f"alias *{event.anchor:.60}: write the value out", event.start_mark)
        self.depth += 1
        if self.depth > MAX_DEPTH:
            self._refuse(f"nested deeper than {MAX_DEPTH} levels", event.start_mark)
        node = super().compose_node(parent, index)
        self.depth -= 1
        return node

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        seen: set[str] = set()
        for key, _ in node.value:
            if not isinstance(key, yaml.ScalarNode):
                self._refuse("a key is a word, not a list or a mapping", key.start_mark)
            if key.value == "<<":
                self._refuse("merge key <<: write the keys out", key.start_mark)
            if key.value in seen:
                self._refuse(f"key {key.value[:60]!r} stands twice", key.start_mark)
            seen.add(key.value)
        return {key.value: self.construct_object(value, deep=deep) for key, value in node.value}

    def _refuse(self, mistake: str, mark: yaml.Mark) -> None:
        raise MistakenYaml(f"line {mark.line + 1}: {mistake}")


def _resolvers() -> None:
    for first, pairs in yaml.SafeLoader.yaml_implicit_resolvers.items():
        kept = [(tag, pattern) for tag, pattern in pairs if tag.rpartition(":")[2] in KEPT]
        _Loader.yaml_implicit_resolvers[first] = kept
    for kind, pattern in NUMBERS.items():
        _Loader.add_implicit_resolver(f"tag:yaml.org,2002:{kind}", re.compile(pattern), list("-+0123456789."))


def _plain(loader: _Loader, node: yaml.Node) -> Any:
    loader._refuse(f"tag {node.tag[:60]}: plain values only", node.start_mark)


_resolvers()
for tag in ("binary", "timestamp", "omap", "pairs", "set"):
    _Loader.add_constructor(f"tag:yaml.org,2002:{tag}", _plain)


def load_mapping(path: Path) -> dict[str, Any]:
    """Read a YAML file of one mapping.

    Raises
    ------
    MistakenYaml : unreadable, too large, no valid YAML, or more than plain data.
    """
    try:
        if path.stat().st_size > MAX_BYTES:
            raise MistakenYaml(f"{path.stat().st_size} bytes; a scene has at most {MAX_BYTES}")
        content = yaml.load(path.read_text(encoding="utf-8"), _Loader)
    except (OSError, UnicodeDecodeError) as error:
        raise MistakenYaml(f"cannot be read ({error}); give a readable YAML file") from None
    except (yaml.YAMLError, ValueError) as error:
        raise MistakenYaml(f"not valid YAML ({' '.join(str(error).split()):.300})") from None
    if content is None:
        return {}
    if not isinstance(content, dict):
        raise MistakenYaml(f"a scene is a mapping of keys to values, not {type(content).__name__}")
    return content
