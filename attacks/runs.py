"""Small scenes that many runs can afford, the command that runs them, and what their results say."""

import os
import subprocess
import sys
import time
from pathlib import Path

from asperity.bundle import ROOT
from attacks.nonsense import scene
from workflow.job import result_checksum

CONTACT = scene(
    "contact: {pixels: 64}",
    "uncertainty: {seeds: 1, direct_runs: 200, response: polynomial}",
)
GLASS = scene(
    "compute: [hardness]",
    "hardness: {seeds: [1], glass: {atoms: 600, melt_ps: 2, quench_rate_K_ps: 1000, rest_ps: 6}}",
)


def command(scene_file: Path, *targets: str) -> list[str]:
    """Run targets of a scene on two cores, as `asperity run` does, without the time that its packages take to load."""
    places = ["--snakefile", str(ROOT / "Snakefile"), "--workflow-profile", str(ROOT / "workflow/profiles/local")]
    return [
        sys.executable, "-m", "snakemake", *places, *targets, "--cores", "2", "--config", f"scene={scene_file}"
    ]  # fmt: skip


def environment(folder: Path) -> dict[str, str]:
    """Packages of this checkout; Snakemake's cache beside the results' folder."""
    return {**os.environ, "PYTHONPATH": str(ROOT), "XDG_CACHE_HOME": str(folder.with_name(f"{folder.name}_cache"))}


def run(folder: Path, scene_file: Path, *targets: str) -> subprocess.CompletedProcess[str]:
    """Run to the end, with results below `folder`."""
    folder.mkdir(parents=True, exist_ok=True)
    return subprocess.run(
        command(scene_file, *targets), cwd=folder, env=environment(folder), capture_output=True, text=True, check=False
    )


def undisturbed(folder: Path, scene_file: Path, target: str) -> tuple[dict[str, str], float]:
    """What the results of a run say that is left alone, and its seconds; kept in `folder` for the next campaign."""
    results, clock = folder / "results" / scene_file.stem, folder / "seconds"
    if not clock.exists():
        started = time.monotonic()
        done = run(folder, scene_file, target)
        if done.returncode:
            raise RuntimeError(done.stdout + done.stderr)
        clock.write_text(str(time.monotonic() - started))
    return contents(results), float(clock.read_text())


def contents(results: Path) -> dict[str, str]:
    """Checksum of what each result says, machine times apart, by its path; logs and working files left out."""
    return {
        str(path.relative_to(results)): result_checksum(path)
        for path in sorted(results.rglob("*"))
        if path.is_file() and path.name[0] != "." and path.relative_to(results).parts[0] not in ("logs", "work")
    }


def last_words(said: str) -> str:
    """How a run ends by what it said: its first ERROR line, else its last line; 'Traceback' where it shows one."""
    lines = said.strip().splitlines()
    if any("Traceback" in line for line in lines):
        return "Traceback"
    return next((line for line in lines if line.startswith("ERROR ")), lines[-1] if lines else "")
