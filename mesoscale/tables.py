"""CSV tables of a user."""

import csv
import io
import os
import stat
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

from asperity.guards.foreign_files import is_of_the_system
from mesoscale.errors import InputError

MAX_TABLE_BYTES = 64 * 2**20
csv.field_size_limit(MAX_TABLE_BYTES)  # samples of an input stand in one field of inputs.csv

Columns = dict[str, tuple[str | None, ...]]


def foreign_table(path: str | Path, named: str) -> tuple[list[str], list[dict[str, Any]]]:
    """Header and rows of a user's table; empty lines, and those that begin with #, are left out.

    Raises
    ------
    InputError : see `foreign_columns`.
    """
    columns = foreign_columns(path, named)
    return list(columns), [
        dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)
    ]


def foreign_columns(path: str | Path, named: str) -> Columns:
    """Columns of a user's table by name; None where a row is too short.

    A file that did not change is read once: a plan asks for each column of it.

    Raises
    ------
    InputError : too large, unreadable or no text; two columns of one name; a row that is longer
        than the header. Each begins with `named`.
    """
    try:
        if is_of_the_system(path):
            raise InputError("of the system, not of data; copy what you need of it")
        status = os.stat(path)
        if stat.S_ISREG(status.st_mode):
            return _kept_columns(str(path), (status.st_ino, status.st_mtime_ns, status.st_size))
        return _columns(str(path))
    except OSError as error:
        raise InputError(_unreadable(named, error.strerror)) from None
    except UnicodeDecodeError:
        raise InputError(_unreadable(named, "no text")) from None
    except csv.Error as error:
        raise InputError(_unreadable(named, str(error))) from None
    except InputError as error:
        raise InputError(f"{named}: {error}") from None


def _unreadable(named: str, why: str | None) -> str:
    return f"{named}: cannot be read ({why}); give a CSV file"


@lru_cache(maxsize=2)
def _kept_columns(path: str, _version: tuple[int, int, int]) -> Columns:
    return _columns(path)


def _columns(path: str) -> Columns:
    with Path(path).open("rb") as stream:
        content = stream.read(MAX_TABLE_BYTES + 1)  # counted while it is read: some files never end
    if len(content) > MAX_TABLE_BYTES:
        raise InputError(f"more than {MAX_TABLE_BYTES >> 20} MB; give fewer rows")
    text = io.StringIO(content.decode("utf-8-sig"), newline="")
    reader = csv.reader(line for line in text if line.strip() and not line.startswith("#"))
    header = next(reader, [])
    names = [name.strip() or f"column {place}" for place, name in enumerate(header, start=1)]
    for name in names:
        if names.count(name) > 1:
            raise InputError(
                f"{names.count(name)} columns are named {name}; rename or remove all but one"
            )
    rows = [_as_long_as(names, number, row) for number, row in enumerate(reader, start=1)]
    if not rows:
        return {name: () for name in names}
    return dict(zip(names, zip(*rows, strict=True), strict=True))


def _as_long_as(names: list[str], number: int, row: list[str]) -> Sequence[str | None]:
    """A row with a value for each column: None where it is too short, without empty ones beyond.

    Raises
    ------
    InputError : it has values beyond the last column.
    """
    count = len(names)
    if len(row) == count:
        return row
    if any(value.strip() for value in row[count:]):
        raise InputError(
            f"row {number} has {len(row)} values, the header {count} names; write decimal points,"
            " one value a column"
        )
    missing = [None] * (count - len(row))
    return [*row[:count], *missing]
