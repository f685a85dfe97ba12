"""What a result table holds: its columns, and whether rows fit them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from pathlib import PurePath
from typing import Any

BOOLEANS = {"True": True, "False": False}
PARSERS: dict[str, Callable[[str], Any]] = {
    "number": float,
    "integer": int,
    "boolean": BOOLEANS.__getitem__,
    "text": str,
}
"""Types of columns, and what reads a cell of each. A number may be nan or inf."""


class UnfitTable(ValueError):
    """A CSV result file whose columns or values are not those of its kind."""


@dataclass(frozen=True)
class Column:
    """One column, or a family of columns.

    Attributes
    ----------
    name : as in the header; a star stands for what tells the members of a family apart.
    type : A key of PARSERS.
    unit : 1 where there is none; empty for text.
    meaning : one line.
    empty : whether a cell may be empty.
    optional : whether the column may be absent.
    """

    name: str
    type: str
    unit: str
    meaning: str
    empty: bool = False
    optional: bool = False

    def covers(self, name: str) -> bool:
        """Whether a column of this name in a header is this one."""
        return fnmatchcase(name, self.name)


def number(
    name: str, unit: str, meaning: str, empty: bool = False, optional: bool = False
) -> Column:
    """A column of floating-point numbers."""
    return Column(name, "number", unit, meaning, empty, optional)


def integer(name: str, meaning: str, empty: bool = False, optional: bool = False) -> Column:
    """A column of counts or labels that are whole numbers."""
    return Column(name, "integer", "1", meaning, empty, optional)


def boolean(name: str, meaning: str, empty: bool = False, optional: bool = False) -> Column:
    """A column of True and False."""
    return Column(name, "boolean", "1", meaning, empty, optional)


def text(name: str, meaning: str, empty: bool = False, optional: bool = False) -> Column:
    """A column of words."""
    return Column(name, "text", "", meaning, empty, optional)


@dataclass(frozen=True)
class Table:
    """The schema of one kind of CSV file.

    Attributes
    ----------
    paths : where such files lie inside results/<scene>/; a star stands for a name.
    row : what one row is.
    """

    paths: tuple[str, ...]
    row: str
    columns: tuple[Column, ...]

    def is_at(self, path: PurePath) -> bool:
        """Whether a file at this path is of this kind."""
        return any(path.match(pattern) for pattern in self.paths)

    def header(self, rows: Sequence[Mapping[str, Any]]) -> list[str]:
        """The columns of rows in the order of the schema, members of a family as they first appear.

        A column that may be empty is there even if no row has it; in a table without rows all are
        that must be. A name that is not known comes last, for `misfit` to find.
        """
        names = dict.fromkeys(name for row in rows for name in row)
        names |= {
            column.name: None
            for column in self.columns
            if not column.optional and (column.empty or not rows) and "*" not in column.name
        }
        return sorted(names, key=self._place)  # stable

    def _place(self, name: str) -> int:
        return next(
            (k for k, column in enumerate(self.columns) if column.covers(name)), len(self.columns)
        )

    def misfit(self, header: Sequence[str], rows: Sequence[Mapping[Any, str | None]]) -> str:
        """What does not fit the schema, in words; empty if everything does.

        Parameters
        ----------
        rows : text by column, as `csv.DictReader` gives it: None where a row is too short, a key
            None where too long.
        """
        for column in self.columns:
            if not column.optional and not any(map(column.covers, header)):
                return f"column {column.name} is missing"
        for number, row in enumerate(rows, 1):
            if None in row:
                return f"row {number} goes beyond the last column, {header[-1]}"
        for name in header:
            column = next((column for column in self.columns if column.covers(name)), None)
            if column is None:
                return f"column {name} is unknown"
            parse = PARSERS[column.type]
            for number, row in enumerate(rows, 1):
                value = row[name]
                if value is None:
                    return f"row {number} ends before column {name}"
                if value == "":
                    if not column.empty:
                        return f"row {number} has no value in column {name}"
                    continue
                try:
                    parse(value)
                except (ValueError, KeyError):
                    return f"row {number}, column {name}: {value[:40]!r} is no {column.type}"
        return ""
