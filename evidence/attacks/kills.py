"""Does a run that is ended, in any way, leave nothing behind, and does the next one end as if it
had not been?

The command is ended at random moments in every way that a supervisor, a terminal or the system has.
Nothing of it may live on, and a folder that was ended several times and is then finished must hold
the results of a run left alone.
"""

import os
import pty
import random
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import psutil

from evidence.attacks.runs import (
    CONTACT,
    GLASS,
    TRACE,
    Attack,
    campaign_table,
    contents,
    figures,
    last_words,
    run,
    undisturbed,
)

__all__ = ["campaign", "figures", "rows"]
SIGNALS = ("SIGTERM", "SIGINT", "SIGHUP", "SIGQUIT", "SIGKILL", "SIGPIPE", "SIGABRT", "SIGXCPU")
WAYS = (
    *(f"{name} to the command" for name in SIGNALS),
    *(f"{name} to its group" for name in ("SIGTERM", "SIGINT", "SIGHUP", "SIGKILL")),
    "SIGTERM, then SIGKILL",
    "SIGINT twice",
    "stopped, then SIGKILL",
    "terminal closed",
    "reader gone",
    "a job killed",
    "LAMMPS killed",
)
LAMMPS = "lmp"  # the name of its process
ENDS_PER_FOLDER = 10  # each run goes on where the last one was ended, so that ends meet all jobs
GONE_S = 20.0  # by which all processes must have ended
SCENES = {
    "contact": (CONTACT, "results/contact/law/parameters.csv"),
    "glass": (GLASS, "results/glass/hardness/glass/1.data"),
}


def arguments(parser: Any) -> None:
    """Options of the study."""
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--count", type=int, default=38, help="ends; each way comes in turn")
    parser.add_argument("--scene", choices=SCENES, default="contact")
    parser.add_argument("--only", choices=WAYS, help="this way alone; default: each in turn")


def rows(given: Any) -> Iterator[dict[str, Any]]:
    """A row for each way."""
    yield from campaign_table(campaign, given.scene, given.count, given.seed, given.only)


def campaign(
    folder: Path, scene: str, ends: int, seed: int, only: str | None = None
) -> Iterator[Attack]:
    """The attacks of one scene; a folder that ends with other results makes a fault of the last of
    them.
    """
    text, target = SCENES[scene]
    path = folder / f"{scene}.yaml"
    path.write_text(text, encoding="utf-8")
    expected, longest = undisturbed(folder / f"{scene}_quiet", path, target)
    ways = [
        way
        for way in WAYS
        if scene == "glass" or (LAMMPS.upper() not in way and "LAMMPS" not in way)
    ]
    if only is not None:
        ways = [only]
    rng = random.Random(seed)
    for start in range(0, ends, ENDS_PER_FOLDER):
        place = folder / f"{scene}_{seed}_{start}"
        place.mkdir()
        for number in range(start, min(start + ENDS_PER_FOLDER, ends)):
            yield _ended(rng, place, path, target, longest, ways[number % len(ways)])
        started = time.monotonic()
        last = run(place, path, target)
        if last.returncode or contents(place / "results" / scene) != expected:
            said = last_words(last.stdout + last.stderr)
            yield Attack(
                "the run after these", "fault", time.monotonic() - started, said or "other results"
            )
        else:
            yield Attack(
                "the run after these",
                "used",
                time.monotonic() - started,
                "the results of a run left alone",
            )


def _ended(
    rng: random.Random, place: Path, path: Path, target: str, longest: float, way: str
) -> Attack:
    """Start the command, end it at a random moment, and look what is left."""
    moment = rng.uniform(0.02, 0.4) * longest
    if (place / target).exists():
        shutil.rmtree(place / "results")  # so that there is work to interrupt
    asperity = [
        str(Path(sys.executable).with_name("asperity")),
        "run",
        "--cores",
        "2",
        str(path),
        target,
    ]
    environment = {
        **os.environ,
        "XDG_CACHE_HOME": str(place.with_name("cache")),
        "ASPERITY_ATTACK": str(place),
    }
    controller, terminal = pty.openpty() if way == "terminal closed" else os.pipe()
    with (place / "said.txt").open("wb") as file:
        said = terminal if way in ("terminal closed", "reader gone") else file
        process = subprocess.Popen(
            asperity, cwd=place, env=environment,
            stdin=terminal if way == "terminal closed" else subprocess.DEVNULL,
            stdout=said, stderr=said, start_new_session=True,
            preexec_fn=_take_terminal if way == "terminal closed" else None,
        )  # fmt: skip
    os.close(terminal)
    time.sleep(moment)
    if process.poll() is not None:  # too late: no end
        os.close(controller)
        return _ended(rng, place, path, target, longest / 2, way)
    ended = time.monotonic()
    _end(process, way, controller, rng)
    left = _wait_for_end(process, place, way)
    for pid in left:
        os.kill(pid, signal.SIGKILL)
    process.wait()
    words = (place / "said.txt").read_text(errors="replace")
    fault = (
        f"lives on: {len(left)} processes" if left else "Traceback" if TRACE.search(words) else ""
    )
    return Attack(
        way,
        "fault" if fault else "used",
        time.monotonic() - ended,
        fault or f"after {moment:.0f} s",
    )


def _take_terminal() -> None:
    import fcntl
    import termios

    fcntl.ioctl(0, termios.TIOCSCTTY, 0)


def _end(process: "subprocess.Popen[bytes]", way: str, controller: int, rng: random.Random) -> None:
    if way in ("terminal closed", "reader gone"):
        os.close(controller)
        return
    os.close(controller)
    if way.endswith("to the command"):
        process.send_signal(getattr(signal, way.split()[0]))
    elif way.endswith("to its group"):
        os.killpg(process.pid, getattr(signal, way.split()[0]))
    elif way == "SIGTERM, then SIGKILL":
        process.terminate()
        time.sleep(0.5)
        process.kill()
    elif way == "SIGINT twice":
        process.send_signal(signal.SIGINT)
        time.sleep(0.1)
        process.send_signal(signal.SIGINT)
    elif way == "stopped, then SIGKILL":
        process.send_signal(signal.SIGSTOP)
        time.sleep(0.5)
        process.kill()
    else:
        jobs = psutil.Process(process.pid).children(recursive=True)
        jobs = [job for job in jobs if way != "LAMMPS killed" or job.name() == LAMMPS]
        if jobs:
            rng.choice(jobs).kill()


def _wait_for_end(process: "subprocess.Popen[bytes]", place: Path, way: str) -> list[int]:
    """Processes of this attack that live on; the run itself may go on where only a job was killed
    or nobody reads.
    """
    patience = 20 * GONE_S if way in ("a job killed", "LAMMPS killed", "reader gone") else GONE_S
    started = time.monotonic()
    while time.monotonic() - started < patience:
        process.poll()
        left = [pid for pid in psutil.pids() if _is_ours(pid, place)]
        if not left:
            return []
        time.sleep(0.2)
    return left


def _is_ours(pid: int, place: Path) -> bool:
    try:
        variables = Path(f"/proc/{pid}/environ").read_bytes().split(b"\0")
    except OSError:
        return False
    return f"ASPERITY_ATTACK={place}".encode() in variables
