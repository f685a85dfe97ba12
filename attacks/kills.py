"""SIGKILL at random moments: of the run with all its jobs, of its main process alone, of one of its jobs, of LAMMPS.

A folder is killed several times and then finished; its results must be those of a run that was left alone.
"""

import os
import random
import signal
import subprocess
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TextIO

import psutil

from attacks.runs import CONTACT, GLASS, command, contents, environment, last_words, run, undisturbed

WAYS = ("group", "main", "child")
LAMMPS = "lmp"  # the name of its process
KILLS_PER_FOLDER = 4
SCENES = {
    "contact": (CONTACT, "results/contact/law/parameters.csv"),
    "glass": (GLASS, "results/glass/hardness/glass/1.data"),
}


def campaign(folder: Path, scene: str, kills: int, seed: int) -> Iterator[dict[str, Any]]:
    """A row for each kill, in order; `equal` holds for the folder at its end."""
    text, target = SCENES[scene]
    path = folder / f"{scene}.yaml"
    path.write_text(text, encoding="utf-8")
    quiet = folder / f"{scene}_quiet"
    expected, longest = undisturbed(quiet, path, target)
    rng, number, count = random.Random(seed), 0, 0
    while count < kills:
        place = folder / f"{scene}_{seed}_{number}"
        killed: list[Killed] = []
        while len(killed) < min(KILLS_PER_FOLDER, kills - count):
            one = _kill(rng, place, path, target, longest, WAYS if scene == "contact" else (*WAYS, LAMMPS, LAMMPS))
            if one is None:
                break
            killed.append(one)
        last = run(place, path, target)
        results = place / "results" / scene
        found, times = contents(results), _times(results)
        for one, after in zip(killed, [*killed[1:], None], strict=False):
            said = last_words(last.stdout + last.stderr) if last.returncode else "finished"
            yield {
                "scene": scene,
                "seed": seed,
                "folder": number,
                "way": one.way,
                "after_s": round(one.after_s, 2),
                "finished": len(one.files),
                "made_again": sum(times.get(name, when) != when for name, when in one.files.items()),
                "lost": sum(name not in times for name in one.files),
                "said": one.said,
                "next": said if after is None else after.words,
                "equal": last.returncode == 0 and found == expected,
            }
        number, count = number + 1, count + len(killed)


@dataclass(frozen=True)
class Killed:
    """One kill.

    Attributes
    ----------
    way : what was killed.
    after_s : how long the run had worked.
    files : results that were there, with the time of their making.
    words : "started" where the run worked until it was killed, else what it said before it ended by itself.
    said : how the run ended whose job was killed; empty where the run itself was.
    """

    way: str
    after_s: float
    files: dict[str, int]
    words: str
    said: str


def _kill(
    rng: random.Random, place: Path, path: Path, target: str, longest: float, ways: Sequence[str]
) -> Killed | None:
    """Start a run and kill of it at a random moment; None where it ended before."""
    place.mkdir(parents=True, exist_ok=True)
    way, moment = rng.choice(ways), rng.uniform(0.05, 0.6) * longest
    with (place / "said.txt").open("w+") as output:
        process = subprocess.Popen(
            command(path, target),
            cwd=place,
            env=environment(place),
            stdout=output,
            stderr=output,
            start_new_session=True,
        )
        said = ""
        try:
            if process.wait(moment) == 0:
                return None
            words = _last_words(output)
        except subprocess.TimeoutExpired:
            words = "started"
            way = _end(rng, process, way)
            if way == "nothing":
                return None
            if way not in ("group", "main"):
                said = _last_words(output).replace(f"{place}/", "")
    return Killed(way, moment, _times(place / "results" / path.stem), words, said)


def _last_words(output: TextIO) -> str:
    output.seek(0)
    return last_words(output.read())


def _end(rng: random.Random, process: "subprocess.Popen[bytes]", way: str) -> str:
    """Kill, and wait for the end of what is left; says what was killed."""
    jobs = psutil.Process(process.pid).children(recursive=True)
    if way == LAMMPS:
        jobs = _wait_for_lammps(process)
    if way in ("child", LAMMPS) and jobs:
        rng.choice(jobs).send_signal(signal.SIGKILL)
    elif way == "main":
        process.kill()
    elif process.poll() is None:
        way = "group"
        os.killpg(process.pid, signal.SIGKILL)
    else:
        way = "nothing"  # the run ended before LAMMPS ran
    process.wait()
    return way


def _wait_for_lammps(process: "subprocess.Popen[bytes]") -> list[psutil.Process]:
    """The processes of LAMMPS, as soon as there is one; none where the run ends before."""
    while process.poll() is None:
        for job in psutil.Process(process.pid).children(recursive=True):
            if job.name() == LAMMPS:
                return [job]
        time.sleep(0.1)
    return []


def _times(results: Path) -> dict[str, int]:
    return {name: (results / name).stat().st_mtime_ns for name in contents(results)}
