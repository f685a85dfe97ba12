"""What attacks share: small scenes, the command that runs them, what results say, and a table of
outcomes.
"""

import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from asperity.guards.bundle import ROOT
from workflow.run.job import result_checksum

HANG_S = 60.0
TRACE = re.compile(
    r'^\s*(Traceback|File "|\w*(Error|Exception)\b)|^Fatal Python|Segmentation fault|internal'
    r" error",
    re.MULTILINE,
)
"""What no user should read: Python's traces, those that Snakemake prints without the word, and
faults of our own.
"""
LITERATURE = {
    "e_star": "{distribution: normal, values: [91, 3.8]}",
    "h_prime": "{values: [1.95, 14.8]}",
    "q0": "{values: [0.015, 0.035]}",
    "hurst": "{values: [0.5, 1.0]}",
    "rms": "{values: [2, 15]}",
}


def scene(*lines: str, **rows: str) -> str:
    """A scene whose inputs are all from the literature, some rows exchanged, with further lines."""
    table = "".join(f"  {name}: {row}\n" for name, row in {**LITERATURE, **rows}.items())
    return "\n".join([f"inputs:\n{table}", *lines])


@dataclass(frozen=True)
class Attack:
    """One attack: its kind, what came of it (refused, used or fault), how long that took, and in
    what words.
    """

    kind: str
    outcome: str
    seconds: float
    words: str = ""


def table(attacks: Iterable[Attack]) -> Iterator[dict[str, Any]]:
    """A row for each kind of attack."""
    kinds: dict[str, list[Attack]] = {}
    for attack in attacks:
        kinds.setdefault(attack.kind, []).append(attack)
        if attack.outcome == "fault":
            print(f"fault: {attack.kind}: {attack.words}", flush=True)
    for kind, made in kinds.items():
        faults = [attack.words for attack in made if attack.outcome == "fault"]
        yield {
            "kind": kind,
            "attacks": len(made),
            "refused": sum(attack.outcome == "refused" for attack in made),
            "used": sum(attack.outcome == "used" for attack in made),
            "faults": len(faults),
            "slowest_s": max(attack.seconds for attack in made),
            "words": (faults or [made[-1].words])[0][:160],
        }


def campaign_table(
    campaign: Callable[..., Iterator[Attack]], *given: Any
) -> Iterator[dict[str, Any]]:
    """The table of a campaign in a temporary folder, which is its first argument."""
    with tempfile.TemporaryDirectory() as folder:
        yield from table(campaign(Path(folder), *given))


def figures(rows: Sequence[Mapping[str, str]]) -> dict[str, str]:
    """Numbers of the last campaign: attacks, faults, and the slowest."""
    last = [
        row
        for row in rows
        if (row["command"], row["commit"]) == (rows[-1]["command"], rows[-1]["commit"])
    ]
    return {
        "attacks": str(sum(int(row["attacks"]) for row in last)),
        "faults": str(sum(int(row["faults"]) for row in last)),
        "slowest": f"{max(float(row['slowest_s']) for row in last):.0f} s",
    }


def commanded(folder: Path, *arguments: str) -> tuple[int, str, float]:
    """Exit status, words and seconds of the command `asperity` in a folder; ended where it
    hangs.
    """
    started = time.monotonic()
    process = subprocess.Popen(
        [str(Path(sys.executable).with_name("asperity")), *arguments],
        cwd=folder,
        env={**os.environ, "XDG_CACHE_HOME": str(folder.with_name("cache"))},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        start_new_session=True,
    )
    try:
        said = process.communicate(timeout=4 * HANG_S)[0]
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        said = "hangs"
    return process.wait(), said, time.monotonic() - started


CONTACT = scene(
    "contact: {pixels: 64}",
    "uncertainty: {seeds: 1, direct_runs: 200}",
)
GLASS = scene(
    "compute: [hardness]",
    "hardness: {seeds: [1], glass: {atoms: 600, melt_ps: 2, quench_rate_K_ps: 1000, rest_ps: 6}}",
)


def command(scene_file: Path, *targets: str) -> list[str]:
    """Run targets of a scene on two cores, as `asperity run` does, without the time that its
    packages take to load.
    """
    places = [
        "--snakefile",
        str(ROOT / "Snakefile"),
        "--workflow-profile",
        str(ROOT / "workflow/profiles/local"),
    ]
    return [
        sys.executable, "-m", "snakemake", *places, *targets, "--cores", "2", "--config",
        f"scene={scene_file}"
    ]  # fmt: skip


def environment(folder: Path) -> dict[str, str]:
    """Packages of this checkout; Snakemake's cache beside the results' folder."""
    return {
        **os.environ,
        "PYTHONPATH": str(ROOT),
        "XDG_CACHE_HOME": str(folder.with_name(f"{folder.name}_cache")),
    }


def run(folder: Path, scene_file: Path, *targets: str) -> subprocess.CompletedProcess[str]:
    """Run to the end, with results below `folder`."""
    folder.mkdir(parents=True, exist_ok=True)
    return subprocess.run(
        command(scene_file, *targets),
        cwd=folder,
        env=environment(folder),
        capture_output=True,
        text=True,
        check=False,
    )


def undisturbed(folder: Path, scene_file: Path, target: str) -> tuple[dict[str, str], float]:
    """What the results of a run say that is left alone, and its seconds; kept in `folder` for the
    next campaign.
    """
    results, clock = folder / "results" / scene_file.stem, folder / "seconds"
    if not clock.exists():
        started = time.monotonic()
        done = run(folder, scene_file, target)
        if done.returncode:
            raise RuntimeError(done.stdout + done.stderr)
        clock.write_text(str(time.monotonic() - started))
    return contents(results), float(clock.read_text())


def contents(results: Path) -> dict[str, str]:
    """Checksum of what each result says, machine times apart, by its path; logs and working files
    left out.
    """
    return {
        str(path.relative_to(results)): result_checksum(path)
        for path in sorted(results.rglob("*"))
        if path.is_file()
        and path.name[0] != "."
        and path.relative_to(results).parts[0] not in ("logs", "work")
    }


def last_words(said: str) -> str:
    """How a run ends by what it said: its first ERROR line, else its last line; 'Traceback' where
    it shows one.
    """
    lines = said.strip().splitlines()
    if TRACE.search(said):
        return "Traceback"
    return next((line for line in lines if line.startswith("ERROR ")), lines[-1] if lines else "")
