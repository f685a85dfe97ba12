"""One run at a time in a folder of results, of one scene, and no jobs that outlive their run.

Three files in `results/<scene>/`:

`.lock` is held by the run (Snakemake's main process) while it lives. `.jobs` is shared by each job
and its LAMMPS: as long as the last of them lives, nothing else starts. `.scene` names the file of
the scene whose results these are.

The system frees such locks (flock) with the last process that holds them, even after SIGKILL. A
job also ends when its run is killed, so that the next run need not wait for it.
"""

import fcntl
import os
import select
import signal
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NoReturn

from asperity.guards.environment import READ

RUN = "ASPERITY_RUN"  # environment variable with the process id of the run that a job belongs to
# results
FILES = {".cir", ".csv", ".data", ".h5", ".html", ".json", ".log", ".sub", ".va", ".xyz", ".yaml"}
PATIENCE_S = 60.0  # for jobs of a killed run to end


class Refused(Exception):
    """The folder cannot be used now; the message is one line."""


def inspect(*folders: Path) -> None:
    """See that a folder of results, which may come from a stranger, holds nothing through which a
    run would write elsewhere, wait for ever or fail without a word.

    Raises
    ------
    Refused : a link that leads out of its folder, a pipe or device, a file or folder that cannot be
        read, or a lock, log or result of another kind.
    """
    for folder in folders:
        if not folder.is_dir():
            if os.path.lexists(folder):
                raise Refused(f"{folder}: is no folder; move it away")
            continue
        inside = folder.resolve()
        for name in (".lock", ".jobs", ".scene"):
            if (folder / name).is_dir():
                raise Refused(
                    f"{folder / name}: a folder where a file of the run belongs; move it away"
                )
        if os.path.lexists(folder / "logs") and not (folder / "logs").is_dir():
            raise Refused(
                f"{folder / 'logs'}: a file where the folder of logs belongs; move it away"
            )
        for entry in _entries(folder):
            path = Path(entry.path)
            if entry.is_symlink():
                if not (os.path.exists(path) and path.resolve().is_relative_to(inside)):
                    raise Refused(
                        f"{path}: a link to {os.readlink(path)}, to nowhere or out of its folder;"
                        " remove it"
                    )
            elif entry.name in READ:
                raise Refused(f"{path}: {READ[entry.name]}; move it away")
            elif entry.is_dir() and path.suffix in FILES:
                raise Refused(f"{path}: a folder where a result belongs; move it away")
            elif not entry.is_dir() and not entry.is_file():
                raise Refused(f"{path}: a pipe or device; move it away")
            elif not os.access(path, os.R_OK | (os.X_OK if entry.is_dir() else 0)):
                raise Refused(f"{path}: may not be read; change its permissions or move it away")


def _entries(folder: Path) -> Iterator[os.DirEntry[str]]:
    """All that lies below a folder; links are not followed."""
    with os.scandir(folder) as entries:
        for entry in entries:
            yield entry
            if entry.is_dir(follow_symlinks=False):
                yield from _entries(Path(entry.path))


def take(results: Path) -> int:
    """Take a folder of results for this run; the lock goes with the process.

    Returns
    -------
    The open lock, to be kept.

    Raises
    ------
    Refused : another run holds the folder, or jobs of an earlier one do not end.
    """
    run = os.open(results / ".lock", os.O_RDWR | os.O_CREAT, 0o666)
    try:
        fcntl.flock(run, fcntl.LOCK_EX | fcntl.LOCK_NB)
        _wait_for_jobs(results)
    except (BlockingIOError, Refused) as error:
        os.close(run)
        if isinstance(error, Refused):
            raise
        raise Refused(
            f"{results}: another run of this scene is working here; wait for it or stop it"
        ) from None
    return run


def _wait_for_jobs(results: Path) -> None:
    jobs = os.open(results / ".jobs", os.O_RDWR | os.O_CREAT, 0o666)
    started = time.monotonic()
    announced = False
    try:
        while True:
            try:
                fcntl.flock(jobs, fcntl.LOCK_EX | fcntl.LOCK_NB)
                return
            except BlockingIOError:
                waited = time.monotonic() - started
            if waited > PATIENCE_S:
                raise Refused(
                    f"{results}: jobs of an earlier run still work here; wait for them or stop them"
                )
            if waited > 1 and not announced:
                print(
                    f"{results}: waiting for jobs of a killed run to end",
                    file=sys.stderr,
                    flush=True,
                )
                announced = True
            time.sleep(0.05)
    finally:
        os.close(jobs)


def claim(results: Path, scene: Path, shipped: Path, write: bool, hosted: bool = False) -> None:
    """See that the folder's results are those of this scene, and say so in the folder if `write`.

    Parameters
    ----------
    scene : the scene's file.
    shipped : folder of the scenes that come with the project; they are known by name, wherever the
        project lies.
    hosted : a workflow that has Asperity as a module makes them. Its runs leave no file `.scene`.

    Raises
    ------
    Refused : the folder holds the results of another scene, or files that no run made.
    """
    place = scene.resolve()
    owner = str(place)
    if place.parent == shipped:
        owner = f"shipped scene {place.stem}"
    note = results / ".scene"
    known = ""
    if note.is_file():
        known = note.read_text(encoding="utf-8").rstrip("\n")
    if known and known != owner:
        raise Refused(
            f"{results}: these are results of {known}, not of {owner}; give one of them another"
            f" name (key `name`), or empty the file {note} if the scene has moved"
        )
    strangers = sorted(set(os.listdir(results)) - {".lock", ".jobs"})
    if strangers and not note.is_file() and not hosted:
        raise Refused(
            f"{results}: holds {strangers[0]}, but no file .scene, so that no run made it; give the"
            " scene another name (key `name`), or move the folder or its link away"
        )
    if write:
        note.write_text(owner + "\n", encoding="utf-8")


def join(results: Path) -> int:
    """Make this process a job of the run that started it: it dies with the run, and holds its
    folder until then.

    Returns
    -------
    The open lock, to be kept; programs that this process starts inherit it.
    """
    run = _watch()
    jobs = os.open(results / ".jobs", os.O_RDWR | os.O_CREAT, 0o666)
    fcntl.flock(jobs, fcntl.LOCK_SH)
    os.set_inheritable(jobs, True)
    if run is not None:
        _end_with(run, 0.0)  # killed before the lock was ours: another run may work here by now
        threading.Thread(target=_end_with, args=(run, None), daemon=True).start()
    return jobs


def _watch() -> int | None:
    """A file that becomes readable when the run ends; None: started by hand, or no Linux (the lock
    still holds).
    """
    if RUN not in os.environ or not hasattr(os, "pidfd_open"):
        return None
    try:
        return os.pidfd_open(int(os.environ[RUN]))
    except ProcessLookupError:
        _end()


def _end_with(run: int, timeout_s: float | None) -> None:
    if select.select([run], [], [], timeout_s)[0]:
        _end()


def _end() -> NoReturn:
    os.kill(os.getpid(), signal.SIGKILL)  # not sys.exit: nothing more may be written, by no thread
    raise AssertionError
