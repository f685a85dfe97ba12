"""The tables of the studies: grown row by row, each row with commit, date, processor and
command.
"""

import csv
import datetime
import platform
import subprocess
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import yaml

ROOT = Path(__file__).resolve().parent.parent
DATA = ROOT / "evidence" / "data"
PROVENANCE = ("commit", "date", "processor", "command")
"""Columns that every table ends with."""
DIGITS = 4
"""Significant digits of a number in a table."""


def ended() -> dict[str, dict[str, Any]]:
    """Studies that ended, by name: commit of their code, question, what was done, and the numbers
    that pages quote.
    """
    return yaml.safe_load((ROOT / "evidence" / "ended.yaml").read_text(encoding="utf-8"))


def table_of(study: str) -> Path:
    """The table of a study, which is named `room.name`."""
    return DATA / f"{study.replace('.', '_')}.csv"


def load(study: str) -> list[dict[str, str]]:
    """The rows of a study by now, all values text; none where it was never run."""
    return load_table(table_of(study))


def load_table(path: Path) -> list[dict[str, str]]:
    """The rows of a CSV file, all values text; none where there is no file."""
    if not path.is_file():
        return []
    with path.open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def record(study: str, rows: Iterable[Mapping[str, Any]], command: str) -> int:
    """Add rows to the table of a study as they come, so that one cut short has its part, and count
    them.

    Raises
    ------
    ValueError : a row has a column that the table has not.
    """
    DATA.mkdir(exist_ok=True)
    counted, made_by, columns = 0, provenance(command), list(next(iter(load(study)), {}))
    with table_of(study).open("a", newline="", encoding="utf-8") as stream:
        for row in rows:
            counted += 1
            whole = {**row, **made_by}
            writer = csv.DictWriter(stream, columns or list(whole), lineterminator="\n")
            if not columns:
                columns = list(whole)
                writer.writeheader()
            rounded = {
                key: f"{x:.{DIGITS}g}" if isinstance(x, float) else x for key, x in whole.items()
            }
            writer.writerow(rounded)
            stream.flush()
    return counted


def provenance(command: str) -> dict[str, str]:
    """Commit (marked + where files differ from it), date, processor and command, as each row
    carries them.
    """
    commit = _git("rev-parse", "--short=10", "HEAD")
    changed = _git("status", "--porcelain", "--untracked-files=no", "--", ".", ":!evidence/data")
    return {
        "commit": commit + ("+" if changed else ""),
        "date": datetime.date.today().isoformat(),
        "processor": _processor(),
        "command": command,
    }


def _git(*arguments: str) -> str:
    return subprocess.run(
        ["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.strip()


def _processor() -> str:
    """Name of the processor, as the system gives it."""
    for line in (
        Path("/proc/cpuinfo").read_text().splitlines() if Path("/proc/cpuinfo").is_file() else ()
    ):
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return platform.processor() or platform.machine()
