"""A folder of results from a stranger leads nowhere else, and a page loses no more than the part
that fails.
"""

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import h5py
import numpy as np
import pytest

from tests.workflow.conftest import ROOT, listing
from workflow.files.checksums import UNFINISHED, remove_unfinished
from workflow.files.results import Dataset, load_csv, load_h5, write_csv, write_h5
from workflow.report import render as rendering
from workflow.report.available import Results
from workflow.run import ownership
from workflow.run.job import failures, own_commit

FAILED = rendering.failed
ASPERITY = str(Path(sys.executable).with_name("asperity"))


@pytest.fixture
def results(tmp_path):
    folder = tmp_path / "results/mine"
    (folder / "logs").mkdir(parents=True)
    (folder / "work/glass").mkdir(parents=True)
    (folder / "inputs.csv").write_text("x\n")
    return folder


def test_an_ordinary_folder_passes(results):
    (results / "inside.csv").symlink_to(results / "inputs.csv")
    ownership.inspect(results, results.parent / "nowhere")


@pytest.mark.parametrize(
    ("plant", "words"),
    [
        (lambda folder: (folder / ".lock").mkdir(), "a folder where a file"),
        (lambda folder: (folder / ".scene").mkdir(), "a folder where a file"),
        (
            lambda folder: (folder / "law/parameters.csv").mkdir(parents=True),
            "a folder where a result",
        ),
        (lambda folder: (folder / ".scene").symlink_to("/etc/hostname"), "out of its folder"),
        (lambda folder: (folder / ".lock").symlink_to("../outside"), "out of its folder"),
        (lambda folder: (folder / "law").symlink_to("/tmp"), "out of its folder"),
        (
            lambda folder: (folder / "work/glass/log.lammps").symlink_to("/tmp/x"),
            "out of its folder",
        ),
        (
            lambda folder: (folder / "law").symlink_to("/proc/1/cwd"),
            "out of its folder",
        ),  # which only root may read
        (lambda folder: (folder / "law").symlink_to("law"), "out of its folder"),
        (lambda folder: os.mkfifo(folder / ".scene"), "a pipe or device"),
        (lambda folder: os.mkfifo(folder / "work/glass/table"), "a pipe or device"),
        (lambda folder: (folder / "work/glass/ucx.conf").write_text("x"), "network layer"),
    ],
)
def test_what_leads_elsewhere_or_waits_is_refused_in_one_line(results, plant, words):
    plant(results)
    with pytest.raises(ownership.Refused, match=words) as error:
        ownership.inspect(results)
    assert "\n" not in str(error.value)


def test_what_killed_writers_left_is_removed(results):
    names = (
        f"{UNFINISHED}a1b2c3_z.csv",
        f"{UNFINISHED}4711.inputs.csv.sha256",
        f"law/{UNFINISHED}abcdefgh.h5",
    )
    kept = (
        ".inputs.csv.sha256",
        ".lock",
        ".jobs",
        ".scene",
        "inputs.csv",
        ".bashrc.original",
        ".x.csv.sha256.1",
    )
    (results / "law").mkdir()
    for name in (*names, *kept):
        (results / name).write_text("x")
    remove_unfinished(results)
    assert not [name for name in names if (results / name).exists()]
    assert all((results / name).exists() for name in kept)


def test_a_folder_of_somebody_else_behind_a_link_stays_as_it_is(tmp_path):
    """Nothing is removed, dated or made there, by no command."""
    home = tmp_path / "home"
    (home / ".ssh").mkdir(parents=True)
    for name in (
        "notes.csv",
        ".notes.csv.sha256",
        ".bashrc.original",
        ".ssh/.config.abcdefgh",
        "inputs.csv",
    ):
        (home / name).write_text("mine")
    os.utime(home / "notes.csv", (2e9, 2e9))
    (tmp_path / "results").mkdir()
    (tmp_path / "results/paper").symlink_to(home)
    before = listing(home)
    for command in (
        ("plan", "paper", "inputs"),
        ("run", "paper", "inputs"),
        ("compare", "results/paper", "results/paper"),
    ):
        done = subprocess.run(
            [ASPERITY, *command], cwd=tmp_path, capture_output=True, text=True, check=False
        )
        assert done.returncode == (2 if "compare" in command else 1)
        assert [
            line for line in done.stderr.splitlines() if line.startswith("ERROR results/paper: ")
        ] or "compare" in command
        assert listing(home) == before
        assert sorted(os.listdir(home)) == sorted(
            {path.relative_to(home).parts[0] for path in before}
        )


@pytest.mark.skipif(os.path.exists("/proc/1/cwd"), reason="this user may read everything")
@pytest.mark.parametrize("link", ["results", "results/paper"])
def test_a_link_to_where_one_may_not_look_is_refused(tmp_path, link):
    (tmp_path / link).parent.mkdir(exist_ok=True)
    (tmp_path / link).symlink_to("/proc/1/cwd")
    done = subprocess.run(
        [ASPERITY, "plan", "paper", "inputs"], cwd=tmp_path, capture_output=True, text=True
    )
    assert (
        done.stderr
        == f"ERROR {link}: a link to /proc/1/cwd, which is not there; mount it, or remove the"
        " link\n"
    )


def test_a_checkout_in_a_path_with_a_space_and_a_site_with_a_profile_run(tmp_path):
    """The interpreter's path reaches a shell as one word; settings of a site for its own workflows
    do not count.
    """
    place = tmp_path / "it's a (place)"
    (place / "bin").mkdir(parents=True)
    (place / "bin/python").symlink_to(sys.executable)
    shutil.copy(Path(sys.prefix) / "pyvenv.cfg", place)
    (place / "lib").symlink_to(Path(sys.prefix) / "lib")
    (tmp_path / "config.yaml").write_text("executor: slurm\njobs: 10\n")
    command = [place / "bin/python", "-m", "asperity", "run", "paper", "inputs"]
    environment = {**os.environ, "SNAKEMAKE_PROFILE": str(tmp_path), "PYTHONPATH": str(ROOT)}
    if str(ROOT).isascii():  # else Python 3.11 does not start (docs/troubleshooting.md)
        environment["LC_ALL"] = "xx_XX.UTF-8"
    done = subprocess.run(
        command, cwd=place, capture_output=True, text=True, check=False, env=environment
    )
    assert done.returncode == 0, done.stderr
    assert (place / "results/paper/inputs.csv").is_file()
    assert "setlocale" not in done.stderr


@pytest.mark.parametrize("planted", ["large", "virtual", "external"])
def test_a_small_file_that_costs_gigabytes_or_leads_elsewhere_is_not_read(tmp_path, planted):
    write_h5(tmp_path / "a.h5", {"x": {"y": Dataset(np.zeros(3), "1", "y", ("n",))}}, {}, {})
    load_h5(tmp_path / "a.h5")
    (tmp_path / "secret").write_bytes(bytes(80))
    with h5py.File(tmp_path / "a.h5", "a") as file:
        if planted == "large":
            file.create_dataset("z", (10**9,), "f8", chunks=(10**6,))
        elif planted == "external":
            file.create_dataset("z", (10,), "f8", external=[(str(tmp_path / "secret"), 0, 80)])
        else:
            layout = h5py.VirtualLayout((3,), "f8")
            layout[:] = h5py.VirtualSource(str(tmp_path / "b.h5"), "z", (3,))
            file.create_virtual_dataset("z", layout)
    with pytest.raises(
        ValueError, match="more than a result has" if planted == "large" else "lie in other files"
    ):
        load_h5(tmp_path / "a.h5")


def test_groups_in_groups_are_not_visited(tmp_path):
    """Where 3,000 lie in each other, their visit takes half a minute."""
    write_h5(tmp_path / "a.h5", {"x": {"y": Dataset(np.zeros(3), "1", "y", ("n",))}}, {}, {})
    with h5py.File(tmp_path / "a.h5", "a") as file:
        group = file
        for _ in range(3000):
            group = group.create_group("a")
    started = time.process_time()
    with pytest.raises(ValueError, match="groups in groups, which no result has"):
        load_h5(tmp_path / "a.h5")
    assert time.process_time() - started < 5.0


def test_a_planted_log_forges_no_error(tmp_path):
    (tmp_path / "logs").mkdir()
    (tmp_path / "logs/x.log").write_text("ERROR forged\n")
    os.utime(tmp_path / "logs/x.log", (time.time() + 1e6,) * 2)
    assert failures(tmp_path / "logs", time.time() - 1) == []


def test_logs_that_are_a_file_are_refused(results):
    (results / "logs").rmdir()
    (results / "logs").write_text("x")
    with pytest.raises(ownership.Refused, match="folder of logs"):
        ownership.inspect(results)


def test_a_section_or_the_first_screen_that_fails_costs_itself(made_up, monkeypatch, capsys):
    monkeypatch.setattr(rendering, "failed", FAILED)

    def broken(results):
        raise ZeroDivisionError("no\x1b[31m <b>pull-in</b>")

    monkeypatch.setattr("workflow.report.stages.inputs.describe", broken)
    monkeypatch.setattr(rendering, "first_screen", lambda results, gates: 1 / 0)
    root, paths = made_up
    page = rendering.render(
        Results(root, [path for path in paths if path.name == "inputs.csv"], "made_up")
    )
    assert "This part of the page could not be drawn (ZeroDivisionError" in page
    assert "<b>pull" not in page
    assert "first screen</b>" in page
    said = capsys.readouterr().err
    assert "report: inputs could not be drawn" in said
    assert "\x1b" not in said


def test_a_spreadsheet_computes_nothing_of_a_table(tmp_path):
    write_csv(
        tmp_path / "x.csv", [{"source": '=HYPERLINK("http://x")', "value": -1.5, "text": "-2.5"}]
    )
    assert load_csv(tmp_path / "x.csv") == [
        {"source": '\'=HYPERLINK("http://x")', "value": "-1.5", "text": "-2.5"}
    ]


def test_a_field_of_any_length_is_read_back(tmp_path):
    write_csv(tmp_path / "x.csv", [{"samples": "1" * 400_000}])
    assert len(load_csv(tmp_path / "x.csv")[0]["samples"]) == 400_000


def test_the_commit_and_the_helpers_of_somebody_else_stay_his(tmp_path):
    """A wheel may lie in a repository that is not ours; in ours, no program of its settings is
    started.
    """
    git = ["git", "-C", str(tmp_path), "-c", "user.name=a", "-c", "user.email=a"]
    subprocess.run([*git, "init", "-q"], check=True)
    subprocess.run([*git, "commit", "-q", "--allow-empty", "-m", "theirs"], check=True)
    subprocess.run(
        [*git, "config", "core.fsmonitor", f"touch {tmp_path / 'ran'}; false"], check=True
    )
    inside = tmp_path / "venv/site-packages"
    inside.mkdir(parents=True)
    assert own_commit(inside) == ""
    assert len(own_commit(tmp_path)) == 40
    assert not (tmp_path / "ran").exists()
