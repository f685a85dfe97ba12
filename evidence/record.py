"""The tables of the studies: grown row by row, each row with commit, date, processor and command."""

import datetime
import platform
import subprocess
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import yaml

from mesoscale.tables import grow_table, load_table

ROOT = Path(__file__).resolve().parent.parent
DATA = ROOT / "evidence" / "data"
PROVENANCE = ("commit", "date", "processor", "command")
"""Columns that every table ends with."""
DIGITS = 4
"""Significant digits of a number in a table."""


def ended() -> dict[str, dict[str, Any]]:
    """Studies that ended, by name: commit of their code, question, what was done, and the numbers that pages quote."""
    return yaml.safe_load((ROOT / "evidence" / "ended.yaml").read_text(encoding="utf-8"))


def table_of(study: str) -> Path:
    """The table of a study, which is named `room.name`."""
    return DATA / f"{study.replace('.', '_')}.csv"


def load(study: str) -> list[dict[str, str]]:
    """The rows of a study by now, all values text; none where it was never run."""
    return load_table(table_of(study))


def record(study: str, rows: Iterable[Mapping[str, Any]], command: str) -> int:
    """Add rows to the table of a study as they come, and count them."""
    DATA.mkdir(exist_ok=True)
    made_by = provenance(command)
    counted = 0

    def complete() -> Iterator[Mapping[str, Any]]:
        nonlocal counted
        for row in rows:
            counted += 1
            yield {**row, **made_by}

    grow_table(table_of(study), complete(), digits=DIGITS)
    return counted


def provenance(command: str) -> dict[str, str]:
    """Commit (marked + where files differ from it), date, processor and command, as each row carries them."""
    commit = _git("rev-parse", "--short=10", "HEAD")
    changed = _git("status", "--porcelain", "--untracked-files=no", "--", ".", ":!evidence/data")
    return {
        "commit": commit + ("+" if changed else ""),
        "date": datetime.date.today().isoformat(),
        "processor": _processor(),
        "command": command,
    }


def _git(*arguments: str) -> str:
    return subprocess.run(["git", *arguments], cwd=ROOT, capture_output=True, text=True, check=True).stdout.strip()


def _processor() -> str:
    """Name of the processor, as the system gives it."""
    for line in Path("/proc/cpuinfo").read_text().splitlines() if Path("/proc/cpuinfo").is_file() else ():
        if line.startswith("model name"):
            return line.split(":", 1)[1].strip()
    return platform.processor() or platform.machine()
