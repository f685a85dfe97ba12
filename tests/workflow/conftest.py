"""Running the real workflow in a folder of its own."""

import itertools
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest

from tests.workflow.made_up_results import write_all
from workflow.report.available import Results
from workflow.report.render import render

ROOT = Path(__file__).resolve().parents[2]
SNAKEMAKE = [
    str(Path(sys.executable).with_name("snakemake")),
    "--snakefile",
    str(ROOT / "Snakefile"),
]


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Start the longest tests first, so that the others run beside them."""
    items.sort(key=lambda item: "test_end_to_end" not in item.nodeid)


class Workflow:
    """Snakemake on this checkout's Snakefile, with its results in `folder`; `profile` is local or
    slurm.
    """

    def __init__(self, folder: Path, profile: str = "local") -> None:
        self.folder = folder
        self.profile = str(ROOT / "workflow/profiles" / profile)
        self.environment = {**os.environ, "XDG_CACHE_HOME": str(folder / "cache")}

    def _command(self, scene: str, targets: tuple[str, ...], options: tuple[str, ...]) -> list[str]:
        places = ["--workflow-profile", self.profile, "--directory", str(self.folder)]
        return [*SNAKEMAKE, *places, *targets, *options, "--config", f"scene={scene}"]

    def run(
        self, scene: str, *targets: str, options: tuple[str, ...] = ()
    ) -> subprocess.CompletedProcess[str]:
        """Run to the end."""
        return subprocess.run(
            self._command(scene, targets, options),
            env=self.environment,
            capture_output=True,
            text=True,
            check=False,
        )

    def start(self, scene: str, *targets: str) -> subprocess.Popen[str]:
        """Start a run in a session of its own, as a terminal does, and let it work."""
        return subprocess.Popen(
            self._command(scene, targets, ()),
            env=self.environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )

    def plan(self, scene: str, *targets: str) -> str:
        """What a plan says."""
        done = self.run(scene, *targets, options=("--dry-run", "--quiet", "rules"))
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout + done.stderr

    def planned(self, scene: str, *targets: str) -> dict[str, int]:
        """Number of jobs by rule that would run."""
        return self.jobs(self.plan(scene, *targets))

    @staticmethod
    def jobs(plan: str) -> dict[str, int]:
        """Number of jobs by rule, from what a plan says."""
        lines = plan.splitlines()
        start = next(
            (number for number, line in enumerate(lines) if line.startswith("job ")), len(lines)
        )
        rows = [line.split() for line in itertools.takewhile(str.strip, lines[start + 1 :])]
        return {rule: int(count) for rule, count, *_ in rows}

    def kill_when(self, scene: str, condition: Callable[[], bool], timeout_s: float = 600) -> bool:
        """Start a run and SIGKILL it with all its children once `condition()` holds; False if it
        ended first.
        """
        process = subprocess.Popen(
            self._command(scene, (), ()),
            env=self.environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
        deadline = time.monotonic() + timeout_s
        try:
            while process.poll() is None and time.monotonic() < deadline:
                if condition():
                    os.killpg(process.pid, signal.SIGKILL)
                    process.wait()
                    return True
                time.sleep(0.05)
            return False
        finally:
            if process.poll() is None:
                os.killpg(process.pid, signal.SIGKILL)
                process.wait()


def listing(folder: Path) -> dict[Path, tuple[float, bytes | str | None]]:
    """Date and content of all that lies below a folder, but the locks of runs."""
    paths = [path for path in folder.rglob("*") if path.name not in (".lock", ".jobs")]
    return {
        path: (
            0.0 if path.is_dir() else path.lstat().st_mtime,
            os.readlink(path)
            if path.is_symlink()
            else path.read_bytes()
            if path.is_file()
            else None,
        )
        for path in paths
    }


@pytest.fixture(scope="session")
def make_workflow():
    """The class itself, for fixtures and tests that run several workflows."""
    return Workflow


@pytest.fixture
def workflow_in(tmp_path):
    """A workflow with an empty folder for its results."""
    return Workflow(tmp_path)


@pytest.fixture(scope="session")
def made_up(tmp_path_factory):
    """Folder of made-up results of every stage, and its files; a test that changes some takes a
    copy.
    """
    root = tmp_path_factory.mktemp("results") / "made_up"
    return root, write_all(root)


@pytest.fixture(scope="session")
def page_of(made_up):
    """The page of the made-up results as those of a scene of some name."""

    @cache
    def page(scene: str) -> str:
        drawn = render(Results(*made_up, scene))
        assert "could not be drawn" not in drawn
        return drawn

    return page


@pytest.fixture(autouse=True)
def _no_part_of_a_page_fails(monkeypatch):
    """On a page a failed part is a sentence; in tests it is a failure."""

    def raised(name, error):
        raise error

    monkeypatch.setattr("workflow.report.render.failed", raised)
