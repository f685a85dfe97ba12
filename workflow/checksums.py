"""Checksums of result files: each beside its file, in the format of `sha256sum`, hidden.

`law/parameters.csv` has its checksum in `law/.parameters.csv.sha256` (check by hand: `sha256sum -c` in that folder).
The writer of results (`workflow.results.atomic_path`) records it just before the result appears, so that a result
without a checksum is none of ours, and one that differs from it was damaged afterwards.
"""

import hashlib
import os
import re
import time
from pathlib import Path

UNFINISHED = re.compile(r"\.[^/]+\.[a-z0-9_]{8}(\.[a-z0-9]+)?|\..+\.sha256\.[0-9]+")  # of atomic_path, of record
CLOCK_S = 5.0  # by which clocks of machines that share a disk may differ


def file_checksum(path: str | Path) -> str:
    """SHA-256 of a file."""
    with Path(path).open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def record_of(path: str | Path) -> Path:
    """Where the checksum of a result file stands."""
    path = Path(path)
    return path.with_name(f".{path.name}.sha256")


def record(path: Path, content: Path) -> None:
    """Record the checksum of a result file that is about to get `content`."""
    target = record_of(path)
    temporary = target.with_name(f"{target.name}.{os.getpid()}")
    with temporary.open("w", encoding="utf-8") as stream:
        stream.write(f"{file_checksum(content)}  {path.name}\n")
        stream.flush()
        os.fsync(stream.fileno())
    temporary.replace(target)


def is_damaged(path: str | Path) -> bool:
    """Does a file differ from its recorded checksum?  False where there is no record: a file of the user."""
    target = record_of(path)
    if not target.is_file():
        return False
    return target.read_text(encoding="utf-8", errors="replace") != f"{file_checksum(path)}  {Path(path).name}\n"


def redate(folder: str | Path) -> list[Path]:
    """Date results below a folder that are dated in the future to now; returns their paths, sorted."""
    now = time.time()
    late = [path for path in sorted(Path(folder).rglob("*")) if path.is_file() and path.stat().st_mtime > now + CLOCK_S]
    for path in late:
        os.utime(path, (now, now))
    return late


def remove_unfinished(folder: str | Path) -> None:
    """Delete what killed writers left below a folder: results and records under their temporary names."""
    for path in Path(folder).rglob(".*"):
        if UNFINISHED.fullmatch(path.name) and path.is_file():
            path.unlink()


def remove_damaged(folder: str | Path) -> list[Path]:
    """Delete every damaged result below a folder, so that it is made again; returns their paths, sorted."""
    damaged = []
    for target in sorted(Path(folder).rglob(".*.sha256")):
        path = target.with_name(target.name.removeprefix(".").removesuffix(".sha256"))
        if not path.is_file():
            target.unlink()  # of a temporary file, or of one that somebody deleted
        elif is_damaged(path):
            path.unlink()
            target.unlink()
            damaged.append(path)
    return damaged
