"""Are random scenes planned, or refused in lines that name the file?

Seeds are stated before a run. Half of the scenes are shipped ones with up to three mistakes, by
key, by value or in their text; half have up to four other numbers
(`tests/workflow/mutated_scenes.py`). All are planned in one process, for a random target each, and
nothing runs. Any other exception than a refusal is a fault.
"""

import contextlib
import io
import random
import tempfile
import time
from argparse import ArgumentParser, Namespace
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from snakemake.api import SnakemakeApi

from asperity.__main__ import targets
from evidence.attacks.runs import TRACE, Attack, figures, table
from tests.workflow.mutated_scenes import mutated, varied
from tests.workflow.planning import plan, read, silent_api

__all__ = ["figures", "rows", "scenes"]
LONGEST_REFUSAL = 20
"""Lines; a scene has up to four mistakes, and one of them may stand at many keys."""

KINDS = (("scene with mistakes", mutated), ("scene with other numbers", varied))


def arguments(parser: ArgumentParser) -> None:
    """Seed and number."""
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--scenes", type=int, default=400)


def rows(given: Namespace) -> Iterator[dict[str, Any]]:
    """A row for each kind."""
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        yield from table(scenes(Path(folder), given.seed, given.scenes))


def scenes(folder: Path, seed: int, count: int) -> Iterator[Attack]:
    """Plan scenes in a folder, which is the working folder."""
    known = list(targets())
    with silent_api() as api:
        for number in range(count):
            rng = random.Random(f"{seed} {number}")
            path = folder / f"random_{number}.yaml"
            kind, made = KINDS[number % len(KINDS)]
            text = made(rng.randrange(2**32))
            path.write_bytes(text.encode("utf-8", "surrogatepass"))
            yield _planned(api, kind, path, rng.choice(["all", *known]))


def _planned(api: SnakemakeApi, kind: str, path: Path, target: str) -> Attack:
    """What came of the plan of one target."""
    started = time.process_time()
    said = io.StringIO()
    outcome = "used"
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
        try:
            plan(read(api, str(path)), set() if target == "all" else {target})
        except SystemExit:
            outcome = "refused"
        except Exception as error:  # of any kind: that is what is looked for
            outcome = "fault"
            print(f"{type(error).__name__}: {error}")
    lines = said.getvalue().strip().splitlines()
    if outcome == "refused" and not _is_clear(lines, path):
        outcome = "fault"
    words = " | ".join(lines) if outcome != "used" else ""
    return Attack(kind, outcome, time.process_time() - started, words)


def _is_clear(lines: list[str], path: Path) -> bool:
    """Does a refusal name the file, in few lines, and without a trace?"""
    named = lines and all(line.startswith("ERROR ") and path.name in line for line in lines)
    return bool(named) and len(lines) <= LONGEST_REFUSAL and not TRACE.search("\n".join(lines))
