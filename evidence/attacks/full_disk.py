"""Does a run on a full disk end in one line, and the next one with the right results?

The disk is a small file system of memory, which is then enlarged. Needs the right to mount one (root).
A run on a full disk ends in one ERROR line; with more room the next one ends with the results of a large disk.
"""

import random
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from evidence.attacks.runs import Attack, campaign_table, contents, figures, finished_contact, last_words, run

__all__ = ["campaign", "figures", "rows"]
TARGET = "law"
ROOM = "64m"


def _mount(place: Path, size: str, *options: str) -> None:
    subprocess.run(["mount", "-t", "tmpfs", "-o", ",".join([*options, f"size={size}"]), "tmpfs", place], check=True)


def arguments(parser: Any) -> None:
    """Options of the study."""
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--count", type=int, default=4, help="disks")


def rows(given: Any) -> Iterator[dict[str, Any]]:
    """A row for all disks."""
    yield from campaign_table(campaign, given.seed, given.count)


def campaign(folder: Path, seed: int, count: int) -> Iterator[Attack]:
    """Disks of each size, from nothing but a few blocks to all that the scene needs."""
    scene, whole, expected = finished_contact(folder, TARGET)
    used = int(subprocess.run(["du", "-s", "-k", whole], capture_output=True, text=True, check=True).stdout.split()[0])
    rng = random.Random(seed)
    for number in range(count):
        place = folder / f"disk_{seed}_{number}"
        place.mkdir()
        size = 4 * rng.randrange(1, used // 4) if number else 4
        _mount(place, f"{size}k")
        try:
            started = time.monotonic()
            full = run(place, scene, TARGET)
            seconds = time.monotonic() - started
            _mount(place, ROOM, "remount")
            again = run(place, scene, TARGET)
            equal = again.returncode == 0 and contents(place / "results/contact") == expected
            said = last_words(full.stdout + full.stderr).replace(str(folder), "")
            good = full.returncode != 0 and said.startswith("ERROR ") and equal
            yield Attack("full disk", "refused" if good else "fault", seconds, f"{size} kB: {said}")
        finally:
            subprocess.run(["umount", place], check=True)
