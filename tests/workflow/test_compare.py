"""Two folders of results compared: what must count, and what must not."""

import json
import shutil
import subprocess
import sys

import h5py
import numpy as np
import pytest

from workflow.compare import differences
from workflow.files.results import Dataset, write_csv, write_h5, write_json, write_text

PROVENANCE = {"rule": "fit_law", "inputs_hash": "0", "versions": {"numpy": "2"}}


@pytest.fixture
def folders(tmp_path):
    """The same made-up results twice."""
    first, second = tmp_path / "first", tmp_path / "second"
    rows = [
        {"run": "a", "d_c_nm": 31.5, "wall_s": 2.0},
        {"run": "b", "d_c_nm": 32.5, "wall_s": 2.0},
    ]
    write_csv(first / "law/table.csv", rows)
    write_json(
        first / "fit.json", {"H_GPa": 5.0, "gate": {"passed": True, "reasons": []}}, PROVENANCE
    )
    force = Dataset(np.array([1.0, np.nan, 3.0]), "nN", "repulsive force", ("point",))
    write_h5(first / "curves.h5", {"closing": {"force": force}}, {"area_nm2": 4.0}, PROVENANCE)
    write_text(first / "scene.yaml", "scene: {name: ci}\nversions: {numpy: '2'}\ngit_commit: abc\n")
    write_text(first / "logs/fit_law.log", "took 2 s")
    shutil.copytree(first, second)
    return first, second


def test_what_says_who_made_it_and_how_fast_does_not_count(folders):
    first, second = folders
    other = {"rule": "fit_law", "inputs_hash": "1", "versions": {"numpy": "3"}}
    table = (second / "law/table.csv").read_text()
    (second / "law/table.csv").write_text(table.replace(",2.0", ",7.0"))
    write_json(second / "fit.json", {"H_GPa": 5.0, "gate": {"passed": True, "reasons": []}}, other)
    with h5py.File(second / "curves.h5", "a") as file:
        file.attrs["inputs_hash"] = "1"
    write_text(
        second / "scene.yaml", "scene: {name: ci}\nversions: {numpy: '3'}\ngit_commit: def\n"
    )
    write_text(second / "logs/fit_law.log", "took 7 s")
    write_text(second / "figures/law.svg", "<svg></svg>")  # drawn by a newer version, say
    (second / ".lock").touch()
    assert list(differences(first, second)) == []


def change_last_digit(folder):
    text = (folder / "law/table.csv").read_text()
    (folder / "law/table.csv").write_text(text.replace("32.5", "32.500000000000004"))


def rename_column(folder):
    text = (folder / "law/table.csv").read_text()
    (folder / "law/table.csv").write_text(text.replace("d_c_nm", "contact_nm"))


def change_nested_value(folder):
    fit = json.loads((folder / "fit.json").read_text())
    (folder / "fit.json").write_text(json.dumps({**fit, "gate": {"passed": False, "reasons": []}}))


def change_curve(folder):
    with h5py.File(folder / "curves.h5", "a") as file:
        file["closing/force"][0] = 1.5


def change_unit(folder):
    with h5py.File(folder / "curves.h5", "a") as file:
        file["closing/force"].attrs["units"] = "uN"


def change_setting(folder):
    write_text(folder / "scene.yaml", "scene: {name: paper}\n")


@pytest.mark.parametrize(
    ("change", "line"),
    [
        (change_last_digit, "law/table.csv: [1]/d_c_nm '32.5' | '32.500000000000004'"),
        (rename_column, "law/table.csv: [0] keys gone: d_c_nm; new: contact_nm"),
        (change_nested_value, "fit.json: /gate/passed True | False"),
        (change_curve, "curves.h5: /values/closing/force differs by up to 0.5"),
        (change_unit, "curves.h5: /attributes/closing/force/units 'nN' | 'uN'"),
        (change_setting, "scene.yaml: /scene/name 'ci' | 'paper'"),
        (lambda folder: (folder / "fit.json").unlink(), "fit.json: only in "),
    ],
)
def test_a_change_is_named(folders, change, line):
    first, second = folders
    change(second)
    (found,) = differences(first, second)
    assert found.startswith(line)


@pytest.mark.parametrize(
    ("change", "code", "says"),
    [
        (None, 0, "no difference"),
        (change_curve, 1, "curves.h5"),
        (shutil.rmtree, 2, "no such folder; give two folders"),
    ],
)
def test_the_command_says_it_by_its_exit_code(folders, change, code, says):
    first, second = folders
    if change:
        change(second)
    command = [sys.executable, "-m", "workflow.compare", str(first), str(second)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == code
    assert says in done.stdout + done.stderr


def test_results_of_one_target_are_compared_too(folders):
    """A run held to a target has no record of the scene."""
    for folder in folders:
        (folder / "scene.yaml").unlink()
    command = [sys.executable, "-m", "workflow.compare", *map(str, folders)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, "no difference" in done.stdout) == (0, True)


def test_a_damaged_file_is_named(folders):
    first, second = folders
    change_last_digit(second)
    (found,) = differences(first, second)
    assert found.endswith(f"; damaged in {second}")


@pytest.mark.parametrize("planted", ["", "large"])
def test_a_file_that_cannot_be_read_is_named_and_the_rest_compared(folders, planted):
    first, second = folders
    change_curve(second)
    (second / "fit.json").write_text("{")
    if planted:
        with h5py.File(second / "curves.h5", "a") as file:
            file.create_dataset("z", (10**9,), "f8", chunks=(10**6,))
    curves, fit = differences(first, second)
    assert curves.startswith(
        "curves.h5: " + ("cannot be read (ValueError" if planted else "/values")
    )
    assert fit.startswith("fit.json: cannot be read (JSONDecodeError")


def test_the_command_says_what_each_scene_says_of_its_switch(made_up, tmp_path):
    (tmp_path / "other/answer").mkdir(parents=True)
    (tmp_path / "other/answer/pad_switch.json").write_text("[]")
    (tmp_path / "other/scene.yaml").write_text("")
    command = [
        sys.executable,
        "-m",
        "asperity",
        "compare",
        str(made_up[0]),
        str(tmp_path / "other"),
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    first, second, *_ = done.stdout.splitlines()
    assert first.startswith("made_up: At central inputs the switch ")
    assert (
        second
        == "other: its switch cannot be read (AttributeError): damaged, or of another version"
    )
    assert done.returncode == 1
