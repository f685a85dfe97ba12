"""YAML of a stranger: plain data only, and what looks like a number is one only if everybody reads
it so.

YAML 1.1 reads `16:40` as 1000 (base 60), `0200` as 128 (octal), `1_000` as 1000 and 2026-11-22 as a
date; here they stay text, which a number's key then refuses.  Aliases are refused: a file of 342
bytes can unfold to gigabytes. Tags are refused: `!!int ""` is an error deep inside PyYAML.
"""

import re
from pathlib import Path
from typing import Any

import yaml

# a comment ends there, though no editor shows it
ODD_BREAK = re.compile(r"\r(?!\n)|[\x85\u2028\u2029]")
MAX_BYTES = 1_000_000
MAX_NODES = 50_000  # a second of reading; the largest scene has 400
MAX_DEPTH = 20  # the settings need 6
NUMBERS = {
    "int": r"^[-+]?(?:0|[1-9][0-9]*)$",
    "float": r"^[-+]?(?:(?:0|[1-9][0-9]*)(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][-+]?[0-9]+)?$",  # 7e3 too
}
TUPLE = "tag:yaml.org,2002:python/tuple"  # as published containers write sizes


class MistakenYaml(Exception):
    """A file that is refused; the message is one line."""


class _Loader(yaml.SafeLoader):
    """Safe YAML without aliases, tags, merge keys, duplicate keys, deep nesting, and numbers in
    disguise.
    """

    yaml_implicit_resolvers: dict[str, list[tuple[str, re.Pattern[str]]]] = {}  # noqa: RUF012 (PyYAML's own interface)
    tags: tuple[str, ...] = ()
    most_nodes = MAX_NODES
    nodes = 0
    depth = 0

    def compose_node(self, parent: yaml.Node | None, index: Any) -> yaml.Node | None:
        event = self.peek_event()
        if isinstance(event, yaml.AliasEvent):
            self._refuse(f"alias *{event.anchor:.60}: write the value out", event.start_mark)
        tag = getattr(event, "tag", None)
        if tag is not None and not (
            tag in self.tags and isinstance(event, yaml.SequenceStartEvent)
        ):
            self._refuse(f"tag {tag:.60}: plain values only, delete it", event.start_mark)
        self.nodes += 1
        if self.nodes > self.most_nodes:
            self._refuse(f"more than {self.most_nodes} values", event.start_mark)
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


class _ContainerLoader(_Loader):
    """The same with tuples, for the many measurements of a container."""

    tags = (TUPLE,)
    most_nodes = 4 * MAX_NODES


def _tuple(loader: _ContainerLoader, node: Any) -> tuple[Any, ...]:
    return tuple(loader.construct_sequence(node))


def _prepare() -> None:
    for first, pairs in yaml.SafeLoader.yaml_implicit_resolvers.items():
        plain_tags = [(tag, pattern) for tag, pattern in pairs if tag.endswith((":bool", ":null"))]
        _Loader.yaml_implicit_resolvers[first] = plain_tags
    for kind, pattern in NUMBERS.items():
        _Loader.add_implicit_resolver(
            f"tag:yaml.org,2002:{kind}", re.compile(pattern), list("-+0123456789.")
        )
    _ContainerLoader.yaml_implicit_resolvers = _Loader.yaml_implicit_resolvers
    _ContainerLoader.add_constructor(TUPLE, _tuple)


_prepare()


def parse(text: str | bytes, tuples: bool = False) -> Any:
    """The plain values of a text; `tuples` accepts the one tag that containers need.

    Raises
    ------
    MistakenYaml : no valid YAML, or more than plain data.
    """
    if odd := ODD_BREAK.search(text if isinstance(text, str) else text.decode(errors="replace")):
        raise MistakenYaml(
            f"{odd[0]!r} begins a line only for YAML 1.1, what follows it may be hidden; delete it"
        )
    try:
        return yaml.load(text, _ContainerLoader if tuples else _Loader)
    except (yaml.YAMLError, ValueError) as error:
        # also: text that is no Unicode, numbers of 5000 digits
        raise MistakenYaml(f"not valid YAML ({' '.join(str(error).split()):.300})") from None


def load_mapping(path: Path, kind: str) -> dict[str, Any]:
    """Read a YAML file of one mapping.

    Parameters
    ----------
    kind : what the file is, for messages: scene, material, potential.

    Raises
    ------
    MistakenYaml : unreadable, too large, no valid YAML, or more than plain data.
    """
    try:
        with path.open("rb") as stream:
            content = stream.read(MAX_BYTES + 1)  # counted while it is read: some files never end
        if len(content) > MAX_BYTES:
            raise MistakenYaml(f"more than the {MAX_BYTES} bytes that a {kind} may have")
        text = content.decode()
    except (OSError, UnicodeDecodeError) as error:
        raise MistakenYaml(f"cannot be read ({error}); give a readable YAML file") from None
    mapping = parse(text)
    if mapping is None:
        return {}
    if not isinstance(mapping, dict):
        raise MistakenYaml(f"a {kind} is a mapping of keys to values, not {type(mapping).__name__}")
    return mapping
