"""The workflow as its catalogue reads it: linted where nothing but Snakemake is installed."""

import importlib.metadata
import os
import re
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


def needs_of(name: str) -> dict[str, importlib.metadata.Distribution]:
    """A distribution and all that it needs without extras, by name."""
    needs: dict[str, importlib.metadata.Distribution] = {}
    waiting = [name]
    while waiting:
        word = waiting.pop().lower().replace("_", "-")
        if word in needs:
            continue
        try:
            needs[word] = importlib.metadata.distribution(word)
        except importlib.metadata.PackageNotFoundError:
            continue  # for another system or Python
        lines = [line for line in needs[word].requires or [] if "extra ==" not in line]
        waiting += [re.split(r"[ ;<>=!\[(~]", line)[0] for line in lines]
    return needs


@pytest.fixture(scope="module")
def snakemake_alone(tmp_path_factory):
    """Python of an environment with Snakemake and what it needs."""
    folder = tmp_path_factory.mktemp("alone") / "venv"
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(folder)], check=True)
    (site,) = (folder / "lib").glob("python3*/site-packages")
    needs = needs_of("snakemake")
    assert not {"numpy", "scipy", "asperity-contact"} & needs.keys()
    files = (file for distribution in needs.values() for file in distribution.files or [])
    for top in {file.parts[0] for file in files} - {"..", "__pycache__"}:
        (site / top).symlink_to(Path(sysconfig.get_path("purelib")) / top)
    return folder / "bin/python"


def run(python: Path, *options: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Snakemake in this checkout, which is not installed; what it writes goes to a folder."""
    variables = {name: word for name, word in os.environ.items() if not name.startswith("PYTHON")}
    command = [str(python), "-m", "snakemake", "--directory", str(folder)]
    return subprocess.run(
        [*command, *options],
        cwd=ROOT,
        env=variables | {"XDG_CACHE_HOME": str(folder / "cache")},
        capture_output=True,
        text=True,
        check=False,
    )


def test_the_linter_has_no_complaint(snakemake_alone, tmp_path):
    done = run(snakemake_alone, "--lint", folder=tmp_path)
    said = done.stdout + done.stderr
    assert done.returncode == 0, said
    assert said.splitlines() == ["Congratulations, your workflow is in a good condition!"]


def test_a_run_without_its_packages_is_refused_in_a_line(snakemake_alone, tmp_path):
    options = ("--cores", "1", "--quiet", "host", "--config", "scene=paper")
    done = run(snakemake_alone, *options, folder=tmp_path)
    assert done.returncode != 0
    lines = [line for line in done.stderr.splitlines() if line.startswith("ERROR")]
    assert lines == [
        "ERROR h5py, numba, numpy, scipy: not installed; running a scene needs pip install"
        " 'asperity-contact[run]'"
    ]
    assert not (tmp_path / "results").exists()
