"""The tables of settings.md, written from the settings classes while the site is built."""

import re
from collections.abc import Iterator
from pathlib import Path

from pydantic import BaseModel

from workflow.scene import Scene
from workflow.scene.accepted import accepted_values
from workflow.scene.documented import value_in_json


def write_tables(path: Path) -> None:
    """A section and a table for each section of a scene; keys outside of sections come first."""
    scene, known = Scene(), set()
    sections = {name: value for name, value in vars(scene).items() if isinstance(value, BaseModel)}
    parts = [_table(row for row in _rows(scene, set()) if "." not in row[0])]
    for name, value in sections.items():
        parts += [
            f"## {name}",
            type(scene).model_fields[name].description or (value.__doc__ or "").strip().splitlines()[0],
        ]
        parts.append(_table(_rows(value, known, f"{name}.")))
    path.parent.mkdir(exist_ok=True)
    path.write_text("\n\n".join(parts) + "\n", encoding="utf-8")


def _rows(model: BaseModel, known: set[type], prefix: str = "") -> Iterator[tuple[str, str, str, str]]:
    """Key, default, what is accepted and meaning of each key; those of a class are explained where it stands first."""
    explained = type(model) in known
    known.add(type(model))
    for name, field in type(model).model_fields.items():
        value = getattr(model, name)
        if isinstance(value, BaseModel):
            yield from _rows(value, known, f"{prefix}{name}.")
        else:
            words = ("", "") if explained else (accepted_values(field), field.description or "")
            yield f"{prefix}{name}", f"`{value_in_json(model, name)}`", *words


def _table(rows: Iterator[tuple[str, str, str, str]]) -> str:
    lines = ["| key | default | accepted | meaning |", "| --- | --- | --- | --- |"]
    for key, *cells in rows:
        default, *words = cells
        plain = [re.sub(r"([\\*_\[\]<>|^$])", r"\\\1", cell) for cell in words]
        lines.append("| " + " | ".join([f"`{key}`", default.replace("|", "\\|"), *plain]) + " |")
    return "\n".join(lines)
