"""The command lists what there is, and answers a mistyped name in one line."""

import re
from pathlib import Path

import pytest

from asperity.__main__ import main
from workflow.scene import SCENES, load_scene

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def test_the_version_is_the_packages(capsys):
    with pytest.raises(SystemExit) as ended:
        main(["--version"])
    assert ended.value.code == 0
    assert capsys.readouterr().out == "asperity 0.2.0\n"


def test_every_scene_is_listed_with_a_line_on_it(capsys):
    assert main(["scenes"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == [
        path.stem for path in sorted(SCENES.glob("*.yaml"))
    ]
    assert all(20 < len(line) <= 80 and line.split()[1] != "name:" for line in lines)


def test_the_stages_are_listed_in_their_order(capsys):
    assert main(["targets"]) == 0
    lines = capsys.readouterr().out.splitlines()
    names = [line.split()[0] for line in lines]
    assert names == sorted(set(names), key=names.index)
    assert {"hardness", "elastic", "topography", "law", "answer", "accuracy", "report"} <= set(
        names
    )
    assert names[-1] == "report"
    assert all(len(line) <= 80 for line in lines)


def test_a_new_scene_has_the_mechanics_that_are_recommended(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    main(["new", "film.yaml"])
    assert load_scene("film.yaml").contact.mechanics == "coupled"
    assert "Film(" in README  # which presses coupled asperities
    assert "ContactSettings(pixels" not in README


def test_the_readme_names_every_scene():
    assert set(re.findall(r"^\| `(\w+)`", README, re.MULTILINE)) == {
        path.stem for path in SCENES.glob("*.yaml")
    } - {"table1"}
