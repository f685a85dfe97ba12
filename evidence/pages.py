"""What the documentation takes from the tables: a page for each study, and the numbers that other
pages quote.
"""

import ast
import importlib
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from evidence.__main__ import studies
from evidence.record import PROVENANCE, ROOT, ended, load, table_of

MOST_ROWS = 40
"""Rows of a table that a page shows; the file has all."""


QUOTED = re.compile(r'\{\{ (\w+) \}\}|<abbr title="(\w+)">[^<]*</abbr>')
"""A number that a page quotes by its name: still to be written, or written."""


@dataclass(frozen=True)
class Quoted:
    """A number of a study, and by which command it was found."""

    value: str
    source: str


def quoted() -> dict[str, Quoted]:
    """Numbers that pages quote, by names `room_study_number`."""
    numbers = {}
    for name in (*studies(), *ended()):
        for key, value in _figures(name).items():
            last = load(name)[-1]
            source = f"{last['command']}, commit {last['commit']}, {last['date']}"
            numbers[f"{name.replace('.', '_')}_{key}"] = Quoted(value, source)
    return numbers


def with_numbers(text: str, numbers: Mapping[str, Quoted]) -> str:
    """The text of a page with its numbers as the studies have them now.

    Raises
    ------
    KeyError : it quotes a number that no study has.
    """

    def written(match: re.Match[str]) -> str:
        name = match[1] or match[2]
        return f'<abbr title="{name}">{numbers[name].value}</abbr>'

    return QUOTED.sub(written, text)


def with_sources(text: str, numbers: Mapping[str, Quoted]) -> str:
    """The text of a page whose numbers tell under the pointer where they are from."""
    return QUOTED.sub(
        lambda match: f'<abbr title="{numbers[match[2]].source}">{numbers[match[2]].value}</abbr>',
        text,
    )


def write_numbers() -> None:
    """Write into all pages the numbers that they quote."""
    numbers = quoted()
    for page in (ROOT / "docs").glob("*.md"):
        before = page.read_text(encoding="utf-8")
        after = with_numbers(before, numbers)
        if after != before:
            page.write_text(after, encoding="utf-8")
            print(page.relative_to(ROOT))


def write_pages(folder: Path) -> None:
    """Write a page for each study that was run, and their index."""
    folder.mkdir(exist_ok=True)
    for page in folder.glob("*.md"):
        page.unlink()
    listed = []
    questions = {name: study["question"] for name, study in ended().items()}
    for name, question in (studies() | questions).items():
        if rows := load(name):
            page = folder / f"{name.replace('.', '_')}.md"
            page.write_text(_page(name, rows), encoding="utf-8")
            listed.append((page.stem, question))
    lines = [
        "# Evidence",
        "",
        (
            "These studies were done once, to show that a method is right. Each page has its"
            " command, its commit and its"
        ),
        "table. `python -m evidence` lists the studies and runs them again.",
        "",
        "| study | question |",
        "| --- | --- |",
        *(f"| [{stem}]({stem}.md) | {_escaped(question)} |" for stem, question in listed),
        "",
        "```{toctree}",
        ":hidden:",
        *(stem for stem, _ in listed),
        "```",
    ]
    (folder / "index.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


def _page(name: str, rows: list[dict[str, str]]) -> str:
    """A page of one study: its question, its command, its numbers and its table."""
    question, more = _asked(name)
    table = table_of(name).relative_to(ROOT)
    columns = [column for column in rows[0] if column not in PROVENANCE]
    made = sorted(
        {(row["date"], row["commit"], row["processor"] or "not recorded") for row in rows}
    )
    numbers = [f"| {key} | {_cell(value)} |" for key, value in _figures(name).items()]
    return "\n".join(
        [
            f"# {_escaped(question.rstrip('.'))}",
            "",
            _escaped(more.strip()),
            "",
            f"Command: `{rows[-1]['command']}`",
            "",
            *(
                f"- {date}, commit {commit}, processor {processor}"
                for date, commit, processor in made
            ),
            "",
            *(["| number | value |", "| --- | --- |", *numbers, ""] if numbers else []),
            f"{len(rows)} row{'s' * (len(rows) != 1)} in `{table}`"
            + (f", of which the first {MOST_ROWS}:" if len(rows) > MOST_ROWS else ":"),
            "",
            "| " + " | ".join(columns) + " |",
            "| " + " | ".join("---" for _ in columns) + " |",
            *(
                "| " + " | ".join(_cell(row[column]) for column in columns) + " |"
                for row in rows[:MOST_ROWS]
            ),
            "",
        ]
    )


def _asked(name: str) -> tuple[str, str]:
    """What a study asks, and how it answers."""
    if study := ended().get(name):
        return (
            study["question"],
            f"{study['about']}\nThe study ended; its code is at commit {study['commit']}.",
        )
    path = ROOT / "evidence" / f"{name.replace('.', '/')}.py"
    question, _, more = (
        ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
    ).partition("\n")
    return question, more


def _cell(text: str | None) -> str:
    return " ".join(_escaped(text or "").replace("|", r"\|").split())


def _escaped(text: str) -> str:
    """Text whose signs mean nothing to Markdown, but for what stands between backticks."""
    return re.sub(r"(`[^`]*`)|([*$<])", lambda match: match[1] or "\\" + match[2], text)


def _figures(name: str) -> dict[str, str]:
    if study := ended().get(name):
        return study["figures"]
    study = importlib.import_module(f"evidence.{name}")
    rows = load(name)
    return study.figures(rows) if rows and hasattr(study, "figures") else {}
