"""Length units in the heads of a text file's columns."""

import re
from collections.abc import Mapping
from pathlib import Path

HEAD_BYTES = 8192
MAX_HEAD_LINES = 50
# a unit stands in brackets, after a slash, or behind "in": x (nm), x [nm], x/nm, x in nm
UNIT = re.compile(r"(?:[(\[/]|\bin)\s*([a-zA-Zµμ\u00c5]{1,2})\s*(?:[)\]]|$)")


def column_units(path: Path, known: Mapping[str, float]) -> tuple[float, float] | None:
    """Factors to nm of the last two columns (position, height) of a text file; None where a head states no unit.

    Parameters
    ----------
    known : nm in each unit that is accepted.
    """
    with path.open("rb") as stream:
        data = stream.read(HEAD_BYTES)
    encoding = "utf-16" if data[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8"
    text = data[: len(data) // 2 * 2].decode(encoding, errors="replace")
    for line in text.splitlines()[:MAX_HEAD_LINES]:
        columns = [column.strip() for column in re.split(r"[,;\t]", line.strip().lstrip("#"))]
        units = [match.group(1) if (match := UNIT.search(column)) else "" for column in columns]
        if len(units) >= 2 and units[-1] in known and units[-2] in known:
            return known[units[-2]], known[units[-1]]
    return None
