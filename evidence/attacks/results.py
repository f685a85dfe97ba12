"""Is a damaged result named and made again?

Files of a finished scene are emptied, cut or changed, then the scene is run again.
The run must name each damaged file, make it again, and end with the results of a scene that nothing happened to.
"""

import random
import shutil
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from evidence.attacks.runs import Attack, campaign_table, contents, figures, finished_contact, last_words, run

__all__ = ["campaign", "figures", "rows"]
# a run leaves damaged files alone that it is not asked for: the spots come with the nominal curves, for the report
TARGETS = ("law", "results/contact/curves/spots.h5")
DAMAGES: dict[str, Callable[[random.Random, bytes], bytes]] = {
    "empty": lambda rng, content: b"",
    "half": lambda rng, content: content[: len(content) // 2],
    "one bit": lambda rng, content: _one_bit(rng, content),
    "one byte more": lambda rng, content: content + b"\n",
    "zeros": lambda rng, content: bytes(len(content)),
    "a line less": lambda rng, content: content[: content.rstrip(b"\n").rfind(b"\n") + 1],
}


def _one_bit(rng: random.Random, content: bytes) -> bytes:
    changed = bytearray(content)
    changed[rng.randrange(len(changed))] ^= 1 << rng.randrange(8)
    return bytes(changed)


def arguments(parser: Any) -> None:
    """Options of the study."""
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--count", type=int, default=3, help="rounds")


def rows(given: Any) -> Iterator[dict[str, Any]]:
    """A row for each kind of damage."""
    yield from campaign_table(campaign, given.seed, given.count)


def campaign(folder: Path, seed: int, count: int) -> Iterator[Attack]:
    """The attacks of `count` rounds; a round damages half of the files of a copy in one way each."""
    scene, whole, expected = finished_contact(folder, TARGETS[0])
    for number in range(seed, seed + count):
        rng = random.Random(number)
        copy = folder / f"damaged_{number}"
        shutil.copytree(whole, copy)
        results = copy / "results/contact"
        damaged = {}
        for name in expected:
            if rng.random() < 0.5:
                damaged[name] = rng.choice(list(DAMAGES))
                path = results / name
                path.write_bytes(DAMAGES[damaged[name]](rng, path.read_bytes()))
        started = time.monotonic()
        done = run(copy, scene, *TARGETS)
        said = done.stdout + done.stderr
        equal = done.returncode == 0 and contents(results) == expected
        for name, kind in damaged.items():
            named = f"results/contact/{name}: damaged" in said
            outcome = "refused" if named and equal else "fault"
            words = name if equal else last_words(said)
            yield Attack(kind, outcome, time.monotonic() - started, words)
        shutil.rmtree(copy)
