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
    assert capsys.readouterr().out == "asperity 0.3.0\n"


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


def test_a_scene_is_written_from_words_without_its_run(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    device = ["--device", "material=aluminium", "gap_um=1.5um"]
    assert main(["new", "bridge.yaml", "--material", "humidity=40%", *device]) == 0
    said = capsys.readouterr().out
    assert "not stated, taken (--material): e_star" in said.replace("\n ", "")
    assert said.splitlines()[-1] == "bridge.yaml is written; asperity run bridge.yaml"
    scene = load_scene("bridge.yaml")
    assert (scene.device.gap_um, scene.device.youngs_modulus_GPa) == (1.5, 70.3)
    assert scene.inputs.rows()["humidity"].values == (0.4,)
    assert [path.name for path in tmp_path.iterdir()] == ["bridge.yaml"]


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (["new", "a.yaml", "--tip-nm", "8"], "ERROR --tip-nm: tells of measured files; name some"),
        (["new", "a.yaml", "a.gwy"], "ERROR a.gwy: neither a file nor a command"),
        (["new", "a.txt"], "ERROR a.txt: a scene is a YAML file"),
        (["film", str(ROOT / "README.md"), "--tip-nm", "8um"], "ERROR --tip-nm=8um: --tip-nm is"),
    ],
)
def test_words_that_no_scene_comes_of_are_one_line(tmp_path, monkeypatch, capsys, words, line):
    monkeypatch.chdir(tmp_path)
    assert main(words) == 1
    assert capsys.readouterr().err.startswith(line)
    assert list(tmp_path.iterdir()) == []


def test_an_option_that_is_not_understood_is_one_line(capsys):
    with pytest.raises(SystemExit):
        main(["film", "a.gwy", "--detrend", "cubic"])
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("ERROR argument --detrend: invalid choice: 'cubic'")


def test_the_readme_names_every_scene():
    assert set(re.findall(r"^\| `(\w+)`", README, re.MULTILINE)) == {
        path.stem for path in SCENES.glob("*.yaml")
    } - {"table1"}
