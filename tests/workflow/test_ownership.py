"""A folder of results has one scene and one run, and no job outlives its run."""

import fcntl
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from atomistic.hardness.glass import make_glass
from atomistic.lammps import load_data
from atomistic.materials import load_material
from atomistic.potentials import load_potential
from evidence.attacks.runs import TRACE
from workflow.files.results import write_text
from workflow.run import ownership
from workflow.scene import load_scene

CONFIG = Path(__file__).parents[2] / "config"

JOB = """
import subprocess, sys, time
from pathlib import Path
from workflow.run.ownership import join
lock = join(Path(sys.argv[1]))
child = subprocess.Popen(["sleep", "60"], close_fds=False)
print("ready", child.pid, flush=True)
time.sleep(60)
"""


@pytest.fixture
def started():
    """Start processes that are ended with the test."""
    processes = []

    def start(command, **options):
        processes.append(subprocess.Popen(command, stdout=subprocess.PIPE, text=True, **options))
        return processes[-1]

    yield start
    for process in processes:
        process.kill()
        process.wait()
        process.stdout.close()


def is_free(folder):
    with (folder / ".jobs").open("w") as jobs:
        try:
            fcntl.flock(jobs, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
    return True


def eventually(condition, seconds=20.0):
    end = time.monotonic() + seconds
    while not condition() and time.monotonic() < end:
        time.sleep(0.02)
    return condition()


def test_a_second_run_is_refused(tmp_path):
    lock = ownership.take(tmp_path)
    with pytest.raises(ownership.Refused, match="another run of this scene"):
        ownership.take(tmp_path)
    os.close(lock)
    os.close(ownership.take(tmp_path))


@pytest.mark.skipif(not hasattr(os, "pidfd_open"), reason="needs Linux")
def test_a_job_dies_with_its_run_and_what_it_started_keeps_the_next_run_out(
    tmp_path, started, monkeypatch
):
    run = started(["sleep", "60"])
    environment = {**os.environ, ownership.RUN: str(run.pid)}
    job = started([sys.executable, "-c", JOB, str(tmp_path)], env=environment)
    child = int(job.stdout.readline().split()[1])
    assert not is_free(tmp_path)
    run.kill()
    assert job.wait(20) == -signal.SIGKILL
    monkeypatch.setattr(ownership, "PATIENCE_S", 0.1)
    with pytest.raises(ownership.Refused, match="jobs of an earlier run still work here"):
        ownership.take(tmp_path)
    os.kill(child, signal.SIGKILL)
    assert eventually(lambda: is_free(tmp_path))
    os.close(ownership.take(tmp_path))


@pytest.mark.skipif(not hasattr(os, "pidfd_open"), reason="needs Linux")
def test_a_job_whose_run_is_gone_does_nothing(tmp_path, started):
    run = started(["true"])
    run.wait()
    job = started(
        [sys.executable, "-c", JOB, str(tmp_path)], env={**os.environ, ownership.RUN: str(run.pid)}
    )
    assert job.wait(20) == -signal.SIGKILL
    assert job.stdout.read() == ""
    assert not (tmp_path / ".jobs").exists()


def test_results_belong_to_the_file_of_one_scene(tmp_path):
    shipped = tmp_path / "shipped"
    first, second = Path("a/mine.yaml"), Path("b/mine.yaml")
    ownership.claim(tmp_path, first, shipped, write=False)
    ownership.claim(tmp_path, second, shipped, write=True)
    ownership.claim(tmp_path, second.resolve(), shipped, write=True)
    with pytest.raises(
        ownership.Refused, match=r"results of .*/b/mine\.yaml, not of .*/a/mine\.yaml"
    ):
        ownership.claim(tmp_path, first, shipped, write=False)


def test_a_shipped_scene_is_known_by_name_wherever_the_project_lies(tmp_path):
    for place in ("here", "there"):
        ownership.claim(tmp_path, tmp_path / place / "paper.yaml", tmp_path / place, write=True)
    with pytest.raises(ownership.Refused, match="results of shipped scene paper, not of"):
        ownership.claim(tmp_path, tmp_path / "mine" / "paper.yaml", tmp_path / "there", write=False)


# A glass that is quenched in some seconds, in four segments
SCENE = """
compute: [hardness]
inputs:
  e_star: {origin: literature, distribution: normal, values: [91, 3.8]}
  h_prime: {origin: literature, values: [1.95, 14.8]}
  q0: {origin: literature, values: [0.015, 0.035]}
  hurst: {origin: literature, values: [0.5, 1.0]}
  rms: {origin: literature, values: [2, 15]}
hardness:
  seeds: [1]
  glass: {atoms: 150, melt_ps: 2, quench_rate_K_ps: 1000, rest_ps: 6}
"""
GLASS = "results/glass/hardness/glass/1.data"


def test_runs_after_interrupted_ones_work_at_once_and_end_as_an_uninterrupted_one(
    workflow_in, tmp_path
):
    (tmp_path / "glass.yaml").write_text(SCENE)
    scene = str(tmp_path / "glass.yaml")
    work = tmp_path / "results/glass/work/glass_1"

    def start_until(segment):
        run = workflow_in.start(scene, GLASS)
        assert eventually(
            lambda: (work / f"restart.{segment}").exists() or run.poll() is not None, 300
        )
        assert run.poll() is None
        return run

    run = start_until(1)
    os.kill(run.pid, signal.SIGKILL)  # the main process alone; its job and LAMMPS end by themselves
    run.communicate()

    run = start_until(3)
    os.killpg(run.pid, signal.SIGINT)  # Ctrl-C: a terminal sends it to all processes
    said = run.communicate()[1]
    assert run.returncode == 130
    assert said.count("interrupted; what is finished is kept: run again") == 1
    assert not TRACE.search(said)
    assert "ERROR" not in said

    done = workflow_in.run(scene, GLASS)
    assert done.returncode == 0, done.stderr
    resumed = load_data(tmp_path / GLASS, ("Si", "O"))
    potential = load_potential(CONFIG / "potentials/pmmcs.yaml")
    silica = load_material(CONFIG / "materials/silicon_dioxide.yaml")
    quiet = make_glass(silica, potential, load_scene(scene).hardness.glass, 1, tmp_path / "quiet")
    np.testing.assert_array_equal(resumed.positions_A, quiet.positions_A)
    np.testing.assert_array_equal(resumed.cell_A, quiet.cell_A)


def old_results(folder):
    """Results of a former version of scene `paper`: a table that no rule makes any more, and a
    page.
    """
    results = folder / "results" / "paper"
    for name in ("law/wells.csv", "report.html"):
        (results / name).parent.mkdir(parents=True, exist_ok=True)
        write_text(results / name, "old\n")
        os.utime(results / name, (1e9, 1e9))
    (results / ".scene").write_text("shipped scene paper\n")
    return results


def test_results_of_another_version_are_named_once_and_kept(workflow_in):
    """Beside new results, the old page is not their report."""
    results = old_results(workflow_in.folder)
    done = workflow_in.run("paper", "inputs")
    assert done.returncode == 0, done.stderr
    said = " ".join((done.stdout + done.stderr).split())
    assert (
        said.count("wells.csv is a result of another version: nothing here reads or changes them")
        == 1
    )
    assert "report.html is older than they are: a run without a target renews it" in said
    assert "the report is" not in said
    assert (
        (results / "law/wells.csv").read_text() == (results / "report.html").read_text() == "old\n"
    )
    assert (results / "inputs.csv").is_file()


def test_a_plan_writes_nothing_and_looks_on_while_a_run_works(workflow_in):
    results = old_results(workflow_in.folder)
    before = {path: path.lstat().st_mtime_ns for path in [results, *results.rglob("*")]}
    assert workflow_in.planned("paper", "inputs")["inputs"] == 1
    assert {path: path.lstat().st_mtime_ns for path in [results, *results.rglob("*")]} == before
    held = ownership.take(results)
    try:
        assert workflow_in.planned("paper", "inputs")["inputs"] == 1
        refused = workflow_in.run("paper", "inputs")
        assert refused.returncode != 0
        assert "another run of this scene is working here" in refused.stdout + refused.stderr
    finally:
        os.close(held)
