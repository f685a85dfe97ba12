"""Other devices on the pads of a run: the command, its table, and pads pressed anew."""

import csv
import shutil

import pytest

from evidence.answer.other_devices import OTHERS, central_of_table_1, compared
from mesoscale.answer.release import answer
from mesoscale.answer.switches import solve_points
from mesoscale.inputs.table import collect, film_table, from_rows, to_rows
from workflow.files.results import load_csv, write_csv
from workflow.run.contact_settings import contact_on
from workflow.run.pads import ScenePoints, write_solved
from workflow.run.what_if import AS_RUN, PressedScene, line_of, main, what_if
from workflow.scene import load_scene

SCENE = """extends: table1
name: tiny
contact: {mechanics: asperity, pixels: 64, length_nm: 500, attraction: clamped}
device: {spring_N_per_m: 800}
tails: [switch]
pad: {cells: 2, points: 36, point_cells: 2}
"""


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    """A folder with the pads of a scene, as its run leaves them."""
    folder = tmp_path_factory.mktemp("what_if")
    (folder / "tiny.yaml").write_text(SCENE)
    scene = load_scene(str(folder / "tiny.yaml"))
    inputs = to_rows(collect(scene.inputs, {}, {}, scene.contact.attraction))
    write_csv(folder / "results/tiny/inputs.csv", inputs)
    rows = load_csv(folder / "results/tiny/inputs.csv")
    table = film_table(from_rows(rows), {}, scene.pad.rms_scatter)
    write_csv(folder / "results/tiny/pad/inputs.csv", to_rows(table))
    contact = contact_on(scene.contact, {})
    points = ScenePoints(table, contact, scene.device, scene.pad.points)
    numbered = list(points.by_number.items())
    solved = dict(zip(points.by_number, solve_points(numbered, points.on_grid, 2), strict=True))
    write_solved(folder / "results/tiny/pad/model.h5", solved, {}, points.design)
    return folder


@pytest.fixture(scope="module")
def pressed():
    """The central point of Table 1, with its pad and the contact on the pads' grid."""
    return central_of_table_1()


@pytest.fixture
def here(ran, tmp_path, monkeypatch):
    """A copy of this folder, as the working folder."""
    shutil.copytree(ran, tmp_path / "copy")
    monkeypatch.chdir(tmp_path / "copy")
    return tmp_path / "copy"


def test_its_own_value_gives_the_answer_of_the_run(here):
    scene = PressedScene("tiny.yaml")
    as_run, same, other = what_if(scene, ["device.spring_N_per_m=800,700"])
    said = answer(scene.with_device(scene.device))
    assert as_run["release_V"] == said.release_V["quantiles"]["0.5"]
    assert {**same, "device": AS_RUN, "spring_N_per_m": 800.0} == as_run
    assert other["pull_in_V"] < as_run["pull_in_V"]


def test_the_command_writes_a_table_and_a_picture(here, capsys):
    assert main(["tiny.yaml", "gap_um=3,3.49,3.7"]) == 0
    lines = capsys.readouterr().out
    assert "gap_um=3.7: closes at" in lines.replace("\n ", "")
    assert "± is the standard error of the median" in lines.replace("\n ", "")
    with (here / "tiny_gap_um_3_3.49_3.7.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert rows[0]["device"] == AS_RUN
    assert [float(row["gap_um"]) for row in rows] == [3.49, 3.0, 3.49, 3.7]
    pull_in_V = [float(row["pull_in_V"]) for row in rows[1:]]
    assert pull_in_V == sorted(pull_in_V)
    assert (here / "tiny_gap_um_3_3.49_3.7.png").is_file()


def test_several_keys_change_together(here):
    scene = PressedScene("tiny.yaml")
    rows = list(what_if(scene, ["gap_um=3,3.2", "spring_N_per_m=900"]))
    stated = [(row["gap_um"], row["spring_N_per_m"]) for row in rows]
    assert stated == [(3.49, 800.0), ("3", "900"), ("3.2", "900")]
    both = scene.device.model_copy(update={"gap_um": 3.2, "spring_N_per_m": 900.0})
    said = answer(scene.with_device(both))
    assert rows[-1]["release_V"] == said.release_V["quantiles"]["0.5"]


def test_a_voltage_below_pull_in_closes_some_of_the_devices(here):
    """Those that never close are counted; where hardly one closes, it says what is known."""
    scene = PressedScene("tiny.yaml")
    pull_in_V = answer(scene.with_device(scene.device)).pull_in_V["quantiles"]
    words = f"hold_voltage_V={pull_in_V['0.5']:.4g},{pull_in_V['0.05']:.4g}"
    half, few = list(what_if(scene, [words]))[1:]
    assert 0.2 < half["never_close"] < 0.8
    closing = half["switches"] + half["no_answer"]
    assert closing == round(36 * (1.0 - half["never_close"]))
    assert f"of {half['switches']} switches that close" in line_of(half)
    assert "of all 36 never close and are left out" in line_of(half)
    assert few["switches"] < 8
    assert "release_V" not in few
    assert "no interval: " in line_of(few)
    assert "switches never close" in line_of(few)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("contact.pixels=128", "change it in a copy of the scene, or sweep it"),
        ("humidity=40%", "changes what pads are pressed from"),
        ("gap=3", "gap_um"),
        ("gap_um=wide", "is no number"),
        ("gap_um=-1", "gap_um"),
        ("material=aluminum,brass", "no material 'brass' is known"),
    ],
)
def test_what_no_pad_answers_is_one_line(here, capsys, change, message):
    assert main(["tiny.yaml", change]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert message in line


def test_a_scene_that_changed_or_never_ran_is_told(here, capsys):
    (here / "other.yaml").write_text(SCENE.replace("tiny", "other"))
    assert main(["other.yaml", "gap_um=3"]) == 1
    assert "asperity run other.yaml answer" in capsys.readouterr().err
    (here / "tiny.yaml").write_text(SCENE.replace("800", "810"))
    assert main(["tiny.yaml", "gap_um=3"]) == 1
    assert "changed since its pads were pressed" in capsys.readouterr().err


@pytest.mark.parametrize("changes", [OTHERS[1], OTHERS[2], OTHERS[-1]], ids=str)
def test_another_device_releases_as_on_a_pad_that_is_pressed_for_it(pressed, changes):
    """All twelve: `python -m evidence answer.other_devices`."""
    point, pad, contact = pressed
    row = compared(point, pad, contact, changes)
    assert abs(row["release_V"] - row["pressed_anew_V"]) <= row["error_V"]
