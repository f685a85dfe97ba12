"""Checksums of result files: each beside its file, in the format of `sha256sum`, hidden.

`law/parameters.csv` has its checksum in `law/.parameters.csv.sha256` (check by hand: `sha256sum -c` in that folder).
The writer of results (`workflow.files.results.atomic_path`) records it just before the result appears, so that a result
without a checksum is none of ours, and one that differs from it was damaged afterwards.
"""

import hashlib
import os
import time
from collections.abc import Iterator
from pathlib import Path

UNFINISHED = ".asperity-unfinished-"  # so begin the temporary names of results and records, and no others
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
    temporary = target.with_name(f"{UNFINISHED}{os.getpid()}{target.name}")
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


def recorded(folder: str | Path) -> Iterator[Path]:
    """Results below a folder that have a checksum, sorted; all others are none of ours."""
    for target in sorted(Path(folder).rglob(".*.sha256")):
        path = target.with_name(target.name.removeprefix(".").removesuffix(".sha256"))
        if path.is_file():
            yield path


def is_late(path: Path) -> bool:
    """Is a file dated in the future, so that what is made of it would seem older?"""
    return path.stat().st_mtime > time.time() + CLOCK_S


def remove_unfinished(folder: str | Path) -> None:
    """Delete what killed writers left below a folder: results and records under their temporary names."""
    for path in Path(folder).rglob(f"{UNFINISHED}*"):
        if path.is_file():
            path.unlink()
