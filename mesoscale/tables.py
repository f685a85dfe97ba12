"""CSV tables of campaigns that are run by hand: read, written whole, or grown row by row."""

import csv
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any


def load_table(path: Path) -> list[dict[str, str]]:
    """The rows by now, all values text; none where there is no file."""
    if not path.is_file():
        return []
    with path.open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def write_table(
    path: Path, rows: Sequence[Mapping[str, Any]], digits: int | None = None, columns: Sequence[str] | None = None
) -> None:
    """Write a table whole; `columns` leaves out what a row has besides."""
    with path.open("w", newline="", encoding="utf-8") as stream:
        writer = csv.DictWriter(stream, columns or list(rows[0]), extrasaction="ignore", lineterminator="\n")
        writer.writeheader()
        writer.writerows(_rounded(row, digits) for row in rows)


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
