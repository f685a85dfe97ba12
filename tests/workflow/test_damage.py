"""A damaged result of a rule is deleted, so that a run makes it again; what no rule makes stays."""

import os
import time

import pytest

from workflow.files.results import write_text
from workflow.run.damage import renew_damaged

FILES = (
    "law/model.json",
    "circuit/models/central.sub",
    "circuit/models/low.sub",
    "law/old.csv",
)


@pytest.fixture
def results(tmp_path):
    for name in FILES:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        write_text(tmp_path / name, "x\n")
    return tmp_path


def renew(results, plan=False):
    made = {str(results / "law/model.json"), str(results / "circuit/models")}
    renew_damaged(results, made.__contains__, plan)


def left(results):
    return {name for name in FILES if (results / name).exists()}


def test_a_damaged_file_of_a_rule_is_deleted(results, capsys):
    (results / "law/model.json").write_text("y\n")
    renew(results)
    assert left(results) == set(FILES) - {"law/model.json"}
    assert "model.json: damaged" in capsys.readouterr().err


def test_a_damaged_file_in_a_folder_of_a_rule_takes_the_folder_with_it(results, capsys):
    """Its rule makes the folder: a file alone would not come again."""
    for name in ("central.sub", "low.sub"):
        (results / "circuit/models" / name).write_text("y\n")
    renew(results)
    assert left(results) == {"law/model.json", "law/old.csv"}
    assert not (results / "circuit/models").exists()
    (line,) = capsys.readouterr().err.splitlines()
    assert "circuit/models/central.sub: damaged" in line


def test_a_damaged_file_that_no_rule_makes_stays(results, capsys):
    (results / "law/old.csv").write_text("y\n")
    renew(results)
    assert left(results) == set(FILES)
    assert capsys.readouterr().err == ""


def test_a_file_of_the_future_gets_the_date_of_today_in_a_folder_too(results, capsys):
    path = results / "circuit/models/low.sub"
    os.utime(path, (time.time() + 1e6, time.time() + 1e6))
    renew(results)
    assert path.stat().st_mtime < time.time() + 1.0
    assert left(results) == set(FILES)
    assert "dated in the future" in capsys.readouterr().err


def test_tables_of_another_version_are_told_once_and_kept_under_another_name(tmp_path, capsys):
    """A table of inputs had no column `varies` in version 0.2.0."""
    row = {name: "x" for name in ("parameter", "unit", "distribution", "origin", "file")}
    names = ("inputs.csv", "pad/inputs.csv", "pad/curves.csv")
    for name in names:
        path = tmp_path / "results" / "film" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        write_text(path, ",".join(row) + "\n" + ",".join(row.values()) + "\n")
    results = tmp_path / "results" / "film"
    made = {str(results / name) for name in names}
    renew_damaged(results, made.__contains__, plan=True)
    assert all((results / name).exists() for name in names)
    renew_damaged(results, made.__contains__, plan=False)
    assert not any((results / name).exists() for name in names)
    assert all((results / f"{name}.former").exists() for name in names)
    first, second = capsys.readouterr().err.splitlines()
    assert first == second
    assert first.endswith(
        "film/inputs.csv and 2 more: tables of another version; a run makes them again, and keeps"
        " the old ones as *.former"
    )


def test_a_plan_says_so_and_changes_nothing(results, capsys):
    (results / "circuit/models/low.sub").write_text("y\n")
    renew(results, plan=True)
    assert left(results) == set(FILES)
    assert "low.sub: damaged" in capsys.readouterr().err
