"""A damaged result of a rule is deleted, so that a run makes it again; what no rule makes stays."""

import os
import time

import pytest

from workflow.files.results import write_text
from workflow.run.damage import renew_damaged

FILES = (
    "law/parameters.csv",
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
    made = {str(results / "law/parameters.csv"), str(results / "circuit/models")}
    renew_damaged(results, made.__contains__, plan)


def left(results):
    return {name for name in FILES if (results / name).exists()}


def test_a_damaged_file_of_a_rule_is_deleted(results, capsys):
    (results / "law/parameters.csv").write_text("y\n")
    renew(results)
    assert left(results) == set(FILES) - {"law/parameters.csv"}
    assert "parameters.csv: damaged" in capsys.readouterr().err


def test_a_damaged_file_in_a_folder_of_a_rule_takes_the_folder_with_it(results, capsys):
    """Its rule makes the folder: a file alone would not come again."""
    for name in ("central.sub", "low.sub"):
        (results / "circuit/models" / name).write_text("y\n")
    renew(results)
    assert left(results) == {"law/parameters.csv", "law/old.csv"}
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


def test_a_plan_says_so_and_changes_nothing(results, capsys):
    (results / "circuit/models/low.sub").write_text("y\n")
    renew(results, plan=True)
    assert left(results) == set(FILES)
    assert "low.sub: damaged" in capsys.readouterr().err
