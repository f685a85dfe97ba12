"""Checksums of result files: each beside its file, in the format of `sha256sum`, hidden.

`law/parameters.csv` has its checksum in `law/.parameters.csv.sha256` (check by hand: `sha256sum -c`
in that folder). The writer of results (`workflow.files.results.atomic_path`) records it just before
the result appears, so that a result without a checksum is none of ours, and one that differs from
it was damaged afterwards.

Files of the user have no record beside them. `content_checksums` tells their content, by which
results follow it.
"""

import hashlib
import json
import os
import time
from collections.abc import Iterable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

# so begin the temporary names of results and records, and no others
UNFINISHED = ".asperity-unfinished-"
CLOCK_S = 5.0  # by which clocks of machines that share a disk may differ
CONTENTS = Path(".snakemake/asperity_contents.json")
"""Checksums of the files that scenes name, with size, dates and inode that they had; may be
deleted.
"""
# a file changed within the tick of a clock has the same dates: file systems have ticks up to 2 s
SETTLED_S = 2.0
UNREADABLE = "unreadable"  # the job that reads such a file says why


def file_checksum(path: str | Path) -> str:
    """SHA-256 of a file."""
    with Path(path).open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def content_checksums(paths: Iterable[str | Path], remembered: Path = CONTENTS) -> dict[str, str]:
    """SHA-256 of files by path; a file whose size, dates and inode are as remembered is not read
    again.

    The date of the inode (ctime) counts, too: no program can set it, as `cp -p` and `rsync -a` set
    the other one.
    """
    known = _remembered(remembered)
    checksums: dict[str, str] = {}
    news: dict[str, list[Any]] = {}
    for path in map(str, paths):
        try:
            status = os.stat(path)
            now = [status.st_size, status.st_mtime_ns, status.st_ctime_ns, status.st_ino]
            former = known.get(os.path.abspath(path))
            if isinstance(former, list) and former[:-1] == now:
                checksums[path] = str(former[-1])
                continue
            checksums[path] = file_checksum(path)
        except OSError:
            checksums[path] = UNREADABLE
            continue
        if time.time() - max(status.st_mtime, status.st_ctime) > SETTLED_S:
            news[os.path.abspath(path)] = [*now, checksums[path]]
    if news:
        _remember(remembered, known | news)
    return checksums


def _remembered(file: Path) -> dict[str, Any]:
    """Former checksums by absolute path; none from a file that is missing or of another shape."""
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return {}
    return content if isinstance(content, dict) else {}


def _remember(file: Path, content: dict[str, Any]) -> None:
    temporary = file.with_name(f"{file.name}.{os.getpid()}")
    # a full disk, or a folder that may not be written: read again next time
    with suppress(OSError):
        file.parent.mkdir(exist_ok=True)
        temporary.write_text(json.dumps(content), encoding="utf-8")
        temporary.replace(file)


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
    """Does a file differ from its recorded checksum?  False where there is no record: a file of the
    user.
    """
    target = record_of(path)
    if not target.is_file():
        return False
    return (
        target.read_text(encoding="utf-8", errors="replace")
        != f"{file_checksum(path)}  {Path(path).name}\n"
    )


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
    """Delete what killed writers left below a folder: results and records under their temporary
    names.
    """
    for path in Path(folder).rglob(f"{UNFINISHED}*"):
        if path.is_file():
            path.unlink()
