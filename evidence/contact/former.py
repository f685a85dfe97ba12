"""Are cycles as fast as those of former commits?

Each checkout has a process of its own, with its own compiled code. All of them close and open the
same surfaces in turn, one after the other, and the first turn is not counted. Seconds are those of
the processor: medians of the turns. Former commits are folders of `git worktree add FOLDER COMMIT`.
"""

import argparse
import json
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from evidence.contact.draws import MIDDLE
from evidence.contact.where_pads_press import FILM, FILM_CELL, SEED, SMOOTH, SMOOTH_CELL, Case
from evidence.record import ROOT
from mesoscale.contact.surface import random_surface
from mesoscale.settings import ContactSettings

WORKER = """
import json, sys, time
sys.path.insert(0, sys.argv[1])
import numpy as np
from mesoscale.contact.cycle import run_cycle
from mesoscale.inputs.contact import ContactInputs, FilmInputs
from mesoscale.settings import ContactSettings
for line in sys.stdin:
    case = json.loads(line)
    kind = FilmInputs if "rms_scatter" in case["inputs"] else ContactInputs
    inputs, settings = kind(**case["inputs"]), ContactSettings(**case["settings"])
    heights = np.load(case["heights"])
    start = time.process_time()
    cycle = run_cycle(inputs, settings, 1, case["force_nN"], heights, contact_at="lowest")
    seconds = time.process_time() - start
    print(json.dumps([seconds, float(cycle.closing.contact_area_nm2.max())]), flush=True)
"""
"""Cycles of a checkout, whose folder is its argument: a line of JSON in, one out."""
PADS_MPA = 40.0  # a film pressed by the default switch
GRIDS = (128, 512, 1024)


def arguments(parser: argparse.ArgumentParser) -> None:
    """Checkouts, and what is timed."""
    parser.add_argument("folders", nargs="+", type=Path, help="of former commits")
    parser.add_argument("--pixels", type=int, nargs="+", default=GRIDS)
    parser.add_argument("--repeats", type=int, default=5)


def cases(pixels: int) -> Iterator[Case]:
    """Cycles on a grid: Table 1 light and heavy, the film of a pad, and a smooth surface."""
    for model in ("elastic", "plastic"):
        of_grid = {"pixels": pixels, "mechanics": "coupled", "model": model}
        coarse = ContactSettings(**of_grid, length_nm=float(pixels))
        for stress_MPa in (7.0, 100.0):
            yield Case(f"Table 1 {model} {stress_MPa:g} MPa", MIDDLE, coarse, stress_MPa)
        film = ContactSettings(**of_grid, **FILM_CELL)
        yield Case(f"film {model} {PADS_MPA:g} MPa", FILM, film, PADS_MPA)
        smooth = ContactSettings(**of_grid, **SMOOTH_CELL)
        yield Case(f"smooth {model} 15 MPa", SMOOTH, smooth, 15.0)


def rows(given: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """A row for each cycle and checkout; printed as it comes."""
    workers = {_name(folder): _start(folder) for folder in (*given.folders, ROOT)}
    with tempfile.TemporaryDirectory() as folder:
        for pixels in given.pixels:
            for case in cases(pixels):
                line = _line(case, Path(folder) / "heights.npy")
                turns = [
                    {name: _ask(worker, line) for name, worker in workers.items()}
                    for _ in range(given.repeats + 1)
                ][1:]
                for name in workers:
                    row = {
                        "pixels": pixels,
                        "what": case.name,
                        "code": name,
                        "cpu_s": statistics.median(turn[name][0] for turn in turns),
                        "share": turns[0][name][1] / case.settings.length_nm**2,
                    }
                    print(*row.values(), flush=True)
                    yield row
    for worker in workers.values():
        worker.kill()


def _name(folder: Path) -> str:
    """Commit of a checkout; `now` of this one."""
    if folder == ROOT:
        return "now"
    asked = ["git", "-C", str(folder), "rev-parse", "--short=8", "HEAD"]
    return subprocess.run(asked, capture_output=True, text=True, check=True).stdout.strip()


def _start(folder: Path) -> "subprocess.Popen[str]":
    command = [sys.executable, "-c", WORKER, str(folder.resolve())]
    pipe = subprocess.PIPE
    return subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True, cwd=folder)


def _line(case: Case, heights: Path) -> str:
    """A cycle as a worker reads it."""
    np.save(heights, random_surface(case.inputs, case.settings, SEED))
    inputs = {field.name: getattr(case.inputs, field.name) for field in fields(case.inputs)}
    stated = {"pixels", "mechanics", "model", "length_nm", "q1_per_nm", "gap_cutoff_nm"}
    return json.dumps(
        {
            "inputs": inputs,
            "settings": case.settings.model_dump(mode="json", include=stated),
            "heights": str(heights),
            "force_nN": 1e-3 * case.stress_MPa * case.settings.length_nm**2,
        }
    )


def _ask(worker: "subprocess.Popen[str]", line: str) -> tuple[float, float]:
    """Seconds of a cycle, and the area (nm^2) that touches at its largest force.

    Raises
    ------
    RuntimeError : the checkout cannot run it.
    """
    assert worker.stdin is not None
    assert worker.stdout is not None
    worker.stdin.write(line + "\n")
    worker.stdin.flush()
    answer = worker.stdout.readline()
    if not answer:
        raise RuntimeError("a checkout has ended")
    seconds, area_nm2 = json.loads(answer)
    return seconds, area_nm2


def figures(table: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Time now over that of each former commit: median, smallest and largest over the cycles."""
    seconds = {(row["pixels"], row["what"], row["code"]): float(row["cpu_s"]) for row in table}
    found = {}
    for code in dict.fromkeys(row["code"] for row in table if row["code"] != "now"):
        over = [
            seconds[pixels, what, "now"] / value
            for (pixels, what, of), value in seconds.items()
            if of == code
        ]
        found[f"over_{code}"] = f"{np.median(over):.2f} [{min(over):.2f}, {max(over):.2f}]"
    return found
