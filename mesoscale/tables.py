"""CSV tables of a user."""

import csv
import io
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
