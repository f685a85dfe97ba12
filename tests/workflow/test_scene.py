"""A scene is checked before any job starts; every mistake is one line that says what to do."""

import itertools
import os
import time

import pytest

from mesoscale.errors import InputError
from mesoscale.tables import foreign_table
from mesoscale.topography.measurements.loading import load_measurements
from workflow.scene import SCENES, Scene, SceneError, load_scene, locate
from workflow.scene.documented import DEFAULTS, documented_defaults


def load(tmp_path, text):
    path = tmp_path / "mine.yaml"
    path.write_text(text)
    return load_scene(str(path))


def lines(tmp_path, text):
    with pytest.raises(SceneError) as caught:
        load(tmp_path, text)
    return str(caught.value).splitlines()


def test_the_documented_defaults_are_the_settings():
    assert DEFAULTS.read_text() == documented_defaults(), "run: python -m workflow.scene"


def test_the_documented_defaults_are_a_valid_scene_that_changes_nothing(tmp_path):
    text = documented_defaults()
    assert 'name: "reduced"' in text
    assert load(tmp_path, text.replace('name: "reduced"', "name: mine")) == Scene(name="mine")


@pytest.mark.parametrize("path", sorted(SCENES.glob("*.yaml")), ids=lambda path: path.stem)
def test_the_shipped_scenes_are_valid(path):
    assert load_scene(path.stem).name == path.stem


def test_a_scene_takes_its_name_from_its_file(tmp_path):
    assert load(tmp_path, "").name == "mine"


def test_an_exponent_without_a_point_is_a_number(tmp_path):
    assert load(tmp_path, "contact: {max_force_nN: 7e3}").contact.max_force_nN == 7000


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("contact: {pixls: 256}", ["contact.pixls", "unknown key", "did you mean pixels?"]),
        ("contact: {pixels: 1}", ["contact.pixels = 1", "an integer", ">= "]),
        ("contact: {pixels: '256'}", ['contact.pixels = "256"', "an integer"]),
        ("contact: {pixels: true}", ["contact.pixels = true", "an integer"]),
        ("contact: 3", ["contact = 3", "a mapping"]),
        ("compute: [stiffness]", ["compute", "hardness, elastic, topography"]),
        ("name: ../../etc", ["name", "of the form"]),
        (
            "topography: {convention: profile}",
            ["topography.convention = profile", "make them equal"],
        ),
        ("contact: {q1_per_nm: 5}", ["contact.q1_per_nm reaches 5 1/nm", "3.217 1/nm"]),
        (
            "inputs: {q1: {values: [0.4, 5]}}",
            ["inputs.q1 reaches 5 1/nm", "3.217 1/nm", "raise contact.pixels"],
        ),
        (
            "inputs: {e_star: {values: [90, 90], varies: each}}",
            ["inputs.e_star", "each", "no spread"],
        ),
        ("- a", ["a scene is a mapping"]),
        ("a: [", ["not valid YAML"]),
        ("contact: {pixels: 256, pixels: 512}", ["'pixels' stands twice"]),
        ("x: !!python/object/apply:os.system ['true']", ["plain values only"]),
        ("x: !!binary aGVsbG8=", ["line 1", "plain values only"]),
        (
            "contact: {pixels: 16:40}",
            ['contact.pixels = "16:40"', "an integer"],
        ),  # 1000 in YAML 1.1
        ("contact: {pixels: 0200}", ['contact.pixels = "0200"', "an integer"]),  # 128
        ("contact: {pixels: 1_024}", ['contact.pixels = "1_024"', "an integer"]),
        ("contact: {pixels: 2026-11-22}", ['contact.pixels = "2026-11-22"', "an integer"]),
        ("contact:\n  <<: {pixels: 128}", ["line 2", "merge key"]),
        ("contact: &a {pixels: *a}", ["line 1", "alias *a: write the value out"]),
        ("contact: " + 5000 * "[" + 5000 * "]", ["line 1", "nested deeper than 20 levels"]),
        ("2026-11-22: 3", ["2026-11-22: unknown key"]),
        ("? [a, b]\n: 3", ["line 1", "a key is a word"]),
        ("name: " + 5000 * "x", ["name = ", "xxx...", "{0,99}"]),
        ("? " + 5000 * "x" + "\n: 3", ["xxx...: unknown key"]),
        ('name: "\\ud800"', ["no Unicode"]),
        ("contact: {pixels: " + 5000 * "9" + "}", ["not valid YAML"]),
        ("name: paper", ["name = paper", "shipped scene", "choose another"]),
        ("hardness: {closing: {launcher: rm -rf /}}", ["hardness.closing.launcher: unknown key"]),
        ("elastic: {dft: {engine: espresso}}", ["elastic.dft.engine", "unknown key"]),
    ],
)
def test_a_mistake_is_one_line_with_file_key_value_and_what_is_accepted(tmp_path, text, words):
    (line,) = lines(tmp_path, text)
    assert "mine.yaml" in line
    assert len(line) < 1000
    for word in words:
        assert word in line


def test_aliases_that_would_unfold_to_gigabytes_are_refused_at_the_first(tmp_path):
    bomb = "a: &a [x,x,x,x,x,x,x,x,x]\n"
    bomb += "".join(
        f"{b}: &{b} [{','.join([f'*{a}'] * 9)}]\n" for a, b in itertools.pairwise("abcdefghi")
    )
    (line,) = lines(tmp_path, bomb)
    assert "line 2: alias *a" in line


def test_every_mistake_is_told_at_once(tmp_path):
    assert len(lines(tmp_path, "contact: {pixels: 1}\nnaem: x")) == 2


def test_an_unknown_scene_lists_the_known_ones():
    with pytest.raises(SceneError, match=r"unknown scene; accepted: ci, .*paper"):
        load_scene("papre")


def test_a_missing_scene_file_is_named():
    with pytest.raises(SceneError, match=r"nowhere\.yaml: no such file"):
        load_scene("nowhere.yaml")


@pytest.mark.parametrize("name", [5000 * "x" + ".yaml", 5000 * "x", "a\0.yaml"])
def test_a_scene_that_cannot_exist_is_one_short_line(name):
    with pytest.raises(SceneError) as caught:
        load_scene(name)
    assert len(str(caught.value)) < 300


def test_files_that_a_scene_names_are_sought_here_and_beside_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    scene = tmp_path / "scenes" / "mine.yaml"
    scene.parent.mkdir()
    for path in (
        scene,
        tmp_path / "here.csv",
        scene.parent / "beside.csv",
        scene.parent / "{a}.csv",
    ):
        path.write_text("")
    found = locate("scenes/mine.yaml", "inputs.rms.file", ["here.csv", "beside.csv"])
    assert found == ["here.csv", "scenes/beside.csv"]
    with pytest.raises(
        SceneError, match=r"inputs\.rms\.file = scenes/{a}\.csv: braces mean wildcards"
    ):
        locate("scenes/mine.yaml", "inputs.rms.file", ["{a}.csv"])
    with pytest.raises(
        SceneError, match=r"inputs\.rms\.file = nowhere\.csv: no such file here or beside"
    ):
        locate("scenes/mine.yaml", "inputs.rms.file", ["nowhere.csv"])


def test_a_file_dated_in_the_future_is_refused(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.yaml").write_text("")
    (tmp_path / "rms.csv").write_text("rms\n5\n6\n")
    os.utime(tmp_path / "rms.csv", (time.time() + 1e6,) * 2)
    with pytest.raises(SceneError, match=r"inputs\.rms\.file = rms\.csv: dated in the future"):
        locate("mine.yaml", "inputs.rms.file", ["rms.csv"])


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("<a>.csv", "angle brackets mean path variables to Snakemake; rename the file"),
        ("/proc/kmsg", "of the system, not of data"),
    ],
)
def test_files_that_snakemake_or_nobody_can_read_are_refused(tmp_path, name, words):
    (tmp_path / "<a>.csv").write_text("")
    (tmp_path / "mine.yaml").write_text("name: mine\n")
    with pytest.raises(SceneError, match=words):
        locate(str(tmp_path / "mine.yaml"), "inputs.rms.values", [name])


def test_files_of_the_system_are_neither_tables_nor_scans():
    """/proc/kmsg waits for ever for what the kernel says next."""
    for read in (
        lambda: foreign_table("/proc/kmsg", "inputs.rms.values"),
        lambda: load_measurements("/proc/kmsg"),
    ):
        with pytest.raises(InputError, match="of the system, not of data"):
            read()


@pytest.mark.parametrize("stated", ["72 +- 2", "72 ± 2", "72+-2", "[72, 2]"])
def test_a_measured_value_has_its_error(tmp_path, stated):
    scene = load(tmp_path, f"device: {{measured: {{pull_in_V: {stated}}}}}")
    assert scene.device.measured is not None
    assert scene.device.measured.pull_in_V == (72.0, 2.0)


@pytest.mark.parametrize("stated", ["72", "72 +- two", "[72, 2, 1]", "high"])
def test_a_measured_value_without_an_error_is_one_line(tmp_path, stated):
    (line,) = lines(tmp_path, f"device: {{measured: {{pull_in_V: {stated}}}}}")
    assert "device.measured.pull_in_V" in line
    assert "72 +- 2" in line
