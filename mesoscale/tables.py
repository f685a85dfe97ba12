"""CSV tables: those of a user, and those of campaigns, which are read, or grown row by row."""

import csv
import io
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from mesoscale.errors import InputError

MAX_TABLE_BYTES = 64 * 2**20
csv.field_size_limit(MAX_TABLE_BYTES)  # samples of an input stand in one field of inputs.csv


def foreign_table(path: str | Path, named: str) -> tuple[list[str], list[dict[str, Any]]]:
    """Header and rows of a user's table; empty lines, and those that begin with #, are left out.

    Raises
    ------
    InputError : too large, unreadable or no text; begins with `named`.
    """
    try:
        with Path(path).open("rb") as stream:
            content = stream.read(MAX_TABLE_BYTES + 1)  # counted while it is read: some files never end
        if len(content) > MAX_TABLE_BYTES:
            raise InputError(f"{named}: more than {MAX_TABLE_BYTES >> 20} MB; give fewer rows")
        text = io.StringIO(content.decode("utf-8-sig"), newline="")
        reader = csv.DictReader(line for line in text if line.strip() and not line.startswith("#"))
        return [name.strip() for name in reader.fieldnames or ()], list(reader)
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        why = error.strerror if isinstance(error, OSError) else "no text" if isinstance(error, ValueError) else error
        raise InputError(f"{named}: cannot be read ({why}); give a CSV file") from None


def load_table(path: Path) -> list[dict[str, str]]:
    """The rows by now, all values text; none where there is no file."""
    if not path.is_file():
        return []
    with path.open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def grow_table(
    path: Path, rows: Iterable[Mapping[str, Any]], digits: int | None = None, columns: Sequence[str] | None = None
) -> None:
    """Add rows as they come, so that a campaign that is cut short has its part.

    The columns are those of the table, of a new one `columns` or the first row's; what a row lacks stays empty.

    Raises
    ------
    ValueError : a row has a column that the table has not.
    """
    with path.open("a+", newline="", encoding="utf-8") as stream:
        stream.seek(0)
        header = next(csv.reader(stream), None)
        stream.seek(0, 2)
        for row in rows:
            writer = csv.DictWriter(stream, header or columns or list(row), lineterminator="\n")
            if header is None:
                header = list(writer.fieldnames)
                writer.writeheader()
            writer.writerow(_rounded(row, digits))
            stream.flush()


def _rounded(row: Mapping[str, Any], digits: int | None) -> dict[str, Any]:
    if digits is None:
        return dict(row)
    return {key: f"{value:.{digits}g}" if isinstance(value, float) else value for key, value in row.items()}
