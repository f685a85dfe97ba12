"""Full disks: runs on a small file system of memory, which is then enlarged. Needs the right to mount one (root).

A run on a full disk ends in one ERROR line; with more room the next one ends with the results of a large disk.
"""

import random
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from attacks.runs import CONTACT, contents, last_words, run, undisturbed

TARGET = "law"
ROOM = "64m"


def _mount(place: Path, size: str, *options: str) -> None:
    subprocess.run(["mount", "-t", "tmpfs", "-o", ",".join([*options, f"size={size}"]), "tmpfs", place], check=True)


def campaign(folder: Path, seed: int, count: int) -> Iterator[dict[str, Any]]:
    """A row for each size of the disk, from nothing but a few blocks to all that the scene needs."""
    scene = folder / "contact.yaml"
    scene.write_text(CONTACT, encoding="utf-8")
    whole = folder / "whole"
    expected, _ = undisturbed(whole, scene, TARGET)
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
            kept = set(contents(place / "results/contact"))
            _mount(place, ROOM, "remount")
            again = run(place, scene, TARGET)
            yield {
                "seed": seed,
                "size_kB": size,
                "seconds": seconds,
                "said": last_words(full.stdout + full.stderr).replace(str(folder), "")[:160],
                "kept": len(kept),
                "next": last_words(again.stdout + again.stderr)[:120] if again.returncode else "finished",
                "equal": full.returncode != 0
                and again.returncode == 0
                and contents(place / "results/contact") == expected,
            }
        finally:
            subprocess.run(["umount", place], check=True)
