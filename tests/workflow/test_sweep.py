"""A scene for each value of a key, and what their runs say."""

import pytest

from workflow.files.results import write_json
from workflow.run.sweep import main, row_of, scenes_of
from workflow.scene import load_scene

SCENE = "extends: table1\nname: mine\ndevice: {gap_um: 3}\ntails: [switch]\n"


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.yaml").write_text(SCENE)
    return tmp_path


def test_a_key_of_any_section_is_swept(here):
    files = scenes_of("mine.yaml", "contact.pixels=128,256")
    assert list(files) == ["128", "256"]
    for value, file in files.items():
        scene = load_scene(str(file))
        assert scene.name == f"mine_pixels_{value}"
        assert scene.contact.pixels == int(value)
        assert scene.device.gap_um == 3.0


def test_a_key_of_the_device_is_written_as_on_the_command_line(here):
    files = scenes_of("mine.yaml", "gap_um=1.5um,2")
    assert [load_scene(str(file)).device.gap_um for file in files.values()] == [1.5, 2.0]
    (gold,) = scenes_of("mine.yaml", "device.material=gold").values()
    assert load_scene(str(gold)).device.density_g_cm3 == 19.3


@pytest.mark.parametrize(
    ("word", "message"),
    [
        ("gap_um=1,wide", "'wide' is no number"),
        ("contact.pixels", "a key and its values"),
        ("contact.pixels=128,,256", "a key and its values"),
        ("contact.pixel=128", "pixels"),
        ("contact.pixels=few", "contact.pixels"),
    ],
)
def test_what_is_no_key_or_value_is_one_line_before_anything_runs(here, capsys, word, message):
    assert main(["mine.yaml", word]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert message in line
    assert [path.name for path in here.iterdir()] == ["mine.yaml"]


def test_a_scene_without_an_interval_is_not_swept(here, capsys):
    (here / "mine.yaml").write_text(SCENE + "pad: {points: 0}\n")
    assert main(["mine.yaml", "contact.pixels=128,256"]) == 1
    assert "give pad.points" in capsys.readouterr().err


def test_a_row_has_the_numbers_of_a_run_or_the_reason(here):
    described = {"std": 1.0, "quantiles": {"0.05": 1.0, "0.5": 2.0, "0.95": 3.0}}
    answer = {
        "release_V": described,
        "pull_in_V": described,
        "quantile_error_V": {"0.5": 0.1},
        "stuck": {"value": 0.25, "low": 0.1, "high": 0.4},
        "points": 36,
        "refused": [],
        "deepened": 2,
        "never_close": {"value": 0.0, "low": 0.0, "high": 0.1},
    }
    place = here / "results/mine/answer/pad_switch.json"
    write_json(place, {"answer": answer, "answer_status": "ok"}, {})
    row = row_of("contact.pixels", "128", "mine")
    assert row["contact.pixels"] == "128"
    assert (row["release_5_V"], row["release_V"], row["stuck"]) == (1.0, 2.0, 0.25)
    write_json(place, {"answer": None, "answer_status": "too few"}, {})
    assert row_of("contact.pixels", "128", "mine")["reason"] == "too few"
