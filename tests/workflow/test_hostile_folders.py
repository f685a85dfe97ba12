"""A folder of results from a stranger leads nowhere else, and a page loses no more than the part that fails."""

import os
import subprocess

import pytest

from workflow import ownership
from workflow.checksums import remove_unfinished
from workflow.job import own_commit
from workflow.report import render as rendering
from workflow.report.available import Results
from workflow.results import load_csv, write_csv

FAILED = rendering.failed


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
        (lambda folder: (folder / "law/parameters.csv").mkdir(parents=True), "a folder where a result"),
        (lambda folder: (folder / ".scene").symlink_to("/etc/hostname"), "out of its folder"),
        (lambda folder: (folder / ".lock").symlink_to("../outside"), "out of its folder"),
        (lambda folder: (folder / "law").symlink_to("/tmp"), "out of its folder"),
        (lambda folder: (folder / "work/glass/log.lammps").symlink_to("/tmp/x"), "out of its folder"),
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
    names = (".inputs.a1b2c3_z.csv", ".inputs.csv.sha256.4711", "law/.table.abcdefgh.h5")
    kept = (".inputs.csv.sha256", ".lock", ".jobs", ".scene", "inputs.csv")
    (results / "law").mkdir()
    for name in (*names, *kept):
        (results / name).write_text("x")
    remove_unfinished(results)
    assert not [name for name in names if (results / name).exists()]
    assert all((results / name).exists() for name in kept)


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
    page = rendering.render(Results(root, [path for path in paths if path.name == "inputs.csv"], "made_up"))
    assert "This part of the page could not be drawn (ZeroDivisionError" in page
    assert "<b>pull" not in page
    assert "first screen</b>" in page
    said = capsys.readouterr().err
    assert "report: inputs could not be drawn" in said
    assert "\x1b" not in said


def test_a_spreadsheet_computes_nothing_of_a_table(tmp_path):
    write_csv(tmp_path / "x.csv", [{"source": '=HYPERLINK("http://x")', "value": -1.5, "text": "-2.5"}])
    assert load_csv(tmp_path / "x.csv") == [{"source": '\'=HYPERLINK("http://x")', "value": "-1.5", "text": "-2.5"}]


def test_a_field_of_any_length_is_read_back(tmp_path):
    write_csv(tmp_path / "x.csv", [{"samples": "1" * 400_000}])
    assert len(load_csv(tmp_path / "x.csv")[0]["samples"]) == 400_000


def test_the_commit_and_the_helpers_of_somebody_else_stay_his(tmp_path):
    """A wheel may lie in a repository that is not ours; in ours, no program of its settings is started."""
    git = ["git", "-C", str(tmp_path), "-c", "user.name=a", "-c", "user.email=a"]
    subprocess.run([*git, "init", "-q"], check=True)
    subprocess.run([*git, "commit", "-q", "--allow-empty", "-m", "theirs"], check=True)
    subprocess.run([*git, "config", "core.fsmonitor", f"touch {tmp_path / 'ran'}; false"], check=True)
    inside = tmp_path / "venv/site-packages"
    inside.mkdir(parents=True)
    assert own_commit(inside) == ""
    assert len(own_commit(tmp_path)) == 40
    assert not (tmp_path / "ran").exists()
