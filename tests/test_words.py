"""Every word has one meaning (docs/architecture.md, Words); this search finds no other use."""

import ast
import io
import re
import tokenize
from itertools import pairwise
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FOLDERS = ("atomistic", "asperity", "config", "docs", "evidence", "mesoscale", "workflow")
SUFFIXES = {".j2", ".js", ".md", ".py", ".smk", ".yaml"}
BUILT = (ROOT / "docs" / "_build", ROOT / "docs" / "api")
PAGES = [
    path
    for folder in FOLDERS
    for path in sorted((ROOT / folder).rglob("*"))
    if path.suffix in SUFFIXES and not any(path.is_relative_to(built) for built in BUILT)
]
CODE = [
    path for path in PAGES if path.suffix == ".py" and not path.is_relative_to(ROOT / "evidence")
]

OTHER_MEANINGS = {
    "surface is roughness; a fitted function is a response": (
        r"(response|linear|regression|polynomial) surface"
    ),
    "files are loaded; a reading is an interpretation of the paper": r"def read_\w+\(",
    "a study is done once, in evidence; a switch is driven": (
        r"study_(switch|surfaces)|studied|case study"
    ),
    "a design is where the engine is run": r"design (matrix|choice|decision)|^\s*design = ",
}
VAGUE_NAMES = {"alone", "along", "each", "facts", "found", "own", "told"}


@pytest.mark.parametrize("rule", OTHER_MEANINGS)
def test_no_word_has_another_meaning(rule):
    other = re.compile(OTHER_MEANINGS[rule], re.IGNORECASE)
    uses = [
        f"{path.relative_to(ROOT)}:{number}: {line.strip()}"
        for path in PAGES
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
        if path.name != "CHANGELOG.md" and other.search(line)
    ]
    assert uses == []


def test_collocation_belongs_to_uncertainty():
    """Elsewhere it would mean another thing; the workflow and the settings name the design as
    such.
    """
    names = [
        f"{path.relative_to(ROOT)}: {name}"
        for path in CODE
        if "uncertainty" not in path.parts
        for name in re.findall(
            r"^(?:def|class) (\w*collocation\w*)", path.read_text(encoding="utf-8"), re.MULTILINE
        )
    ]
    assert names == []


def test_names_say_what_they_hold():
    uses = []
    for path in CODE:
        for token in tokenize.generate_tokens(
            io.StringIO(path.read_text(encoding="utf-8")).readline
        ):
            if token.type == tokenize.NAME and token.string in VAGUE_NAMES:
                uses.append(f"{path.relative_to(ROOT)}:{token.start[0]}: {token.string}")
    assert uses == []


def _is_record(node):
    kinds = [*node.bases, *node.decorator_list] if isinstance(node, ast.ClassDef) else []
    return any(
        word in ast.unparse(kind)
        for kind in kinds
        for word in ("dataclass", "NamedTuple", "Settings")
    )


def test_fields_are_described_in_one_form():
    """Fields stand in the docstring of their class, which `help()` shows.

    A class of numerical choices, whose values carry their reason, has a string below each field
    instead, and none of them in its docstring. Comments behind fields are in neither.
    """
    uses = []
    for path in CODE:
        lines = path.read_text(encoding="utf-8").splitlines()
        for record in filter(_is_record, ast.walk(ast.parse("\n".join(lines)))):
            pairs = list(pairwise([*record.body, record]))
            fields = [field for field, _ in pairs if isinstance(field, ast.AnnAssign)]
            explained = [
                field
                for field, below in pairs
                if isinstance(field, ast.AnnAssign) and isinstance(below, ast.Expr)
            ]
            choices = bool(fields) and all(field.value is not None for field in fields)
            listed = "Attributes" in (ast.get_docstring(record) or "")
            wrong = explained
            if choices and not listed and len(explained) == len(fields):
                wrong = []
            wrong += [field for field in fields if "#" in lines[field.lineno - 1]]
            place = path.relative_to(ROOT)
            uses += [f"{place}:{field.lineno}: {record.name}" for field in wrong]
    assert uses == []
