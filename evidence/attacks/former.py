"""What do results of version 0.2.0 meet in the present code: is anything lost, or called new?

The results are real ones: the former code runs a small scene to its page, in an environment of its
own (`uv sync --locked` in a clone at commit c953205b; then `asperity run tiny.yaml report circuit`
there, with `pad: {cells: 8, grid: {pilot_cells: 4, depths: 4}, draws: 8, draw_cells: 2}` behind
the scene below). The present code then plans, runs one target, opens the page, and runs the whole
scene. Each old file must stay, be renamed or be made again under its name, each old folder is named
once a run, and a page from before is not called the report.
"""

import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
import time
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from evidence.attacks.runs import TRACE, Attack, figures, scene, table
from workflow.run.damage import FORMER

__all__ = ["figures", "rows"]
SCENE = scene(
    "contact: {pixels: 64}",
    "uncertainty: {seeds: 1, direct_runs: 60}",
    "pad: {cells: 8, points: 0}",
)
FOLDERS = {"curves": "contact", "device": "answer", "uq": "uncertainty"}
"""Former names, and what they are now."""


def arguments(parser: ArgumentParser) -> None:
    """Where the former results are."""
    parser.add_argument("--results", type=Path, required=True, help="folder results/tiny of 0.2.0")


def rows(given: Namespace) -> Iterator[dict[str, Any]]:
    """A row for each command."""
    with tempfile.TemporaryDirectory() as folder:
        yield from table(_attacks(Path(folder), given.results))


def _attacks(folder: Path, former: Path) -> Iterator[Attack]:
    results = folder / "results" / "tiny"
    shutil.copytree(former, results)
    (results / ".scene").write_text("")  # the scene has moved here
    (folder / "tiny.yaml").write_text(SCENE, encoding="utf-8")
    before = _checksums(results)
    yield _tried(folder, "plan", before, {"changed": 0, "named": 0, "report": False})
    yield _tried(folder, "run", before, {"named": 1, "report": False}, "inputs")
    yield _tried(folder, "open", before, {"older": True, "named": 0})
    yield _tried(folder, "run", before, {"named": 1, "report": True})


def _tried(
    folder: Path, command: str, before: dict[str, str], wanted: dict[str, Any], target: str = ""
) -> Attack:
    """What a command left and said, beside what is wanted of it."""
    started = time.monotonic()
    asperity = str(Path(sys.executable).with_name("asperity"))
    cores = ["--cores", "1"] if command == "run" else []
    done = subprocess.run(
        [asperity, command, *cores, "tiny.yaml", *([target] if target else [])],
        cwd=folder,
        env=os.environ | {"BROWSER": "true", "XDG_CACHE_HOME": str(folder / "cache")},
        capture_output=True,
        text=True,
        check=False,
    )
    said = " ".join((done.stdout + done.stderr).split())
    after = _checksums(folder / "results" / "tiny")
    found = {
        "changed": sum(after.get(name) != checksum for name, checksum in before.items()),
        "named": max(said.count(f"/{old} is `{new}`") for old, new in FOLDERS.items()),
        "report": "the report is" in said,
        "older": "older than the results" in said,
    }
    faults = [
        f"{name}: {found[name]}, not {value}"
        for name, value in wanted.items()
        if found[name] != value
    ]
    faults += [f"lost: {name}" for name in before if not {name, f"{name}{FORMER}"} & set(after)]
    if done.returncode or TRACE.search(done.stdout + done.stderr):
        faults.append(said[-160:])
    kind = f"{command} {target}".strip()
    outcome = "fault" if faults else "used"
    words = "; ".join(faults) or f"{len(before)} files before, {found['changed']} made again"
    return Attack(kind, outcome, time.monotonic() - started, words)


def _checksums(results: Path) -> dict[str, str]:
    """Of all results by their path; records, logs and what a run notes apart."""
    return {
        str(path.relative_to(results)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in sorted(results.rglob("*"))
        if path.is_file() and path.name[0] != "." and "logs" not in path.parts
    }
