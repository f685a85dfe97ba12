"""A scene is checked before any job starts; every mistake is one line that says what to do."""

import pytest

from workflow.scene import DEFAULTS, SCENES, Scene, SceneError, documented_defaults, load_scene


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
    assert load(tmp_path, documented_defaults()) == Scene()


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
        ("topography: {convention: profile}", ["topography.convention = profile", "make them equal"]),
        ("- a", ["a scene is a mapping"]),
        ("a: [", ["not valid YAML"]),
        ("contact: {pixels: 256, pixels: 512}", ["'pixels' stands twice"]),
        ("x: !!python/object/apply:os.system ['true']", ["not valid YAML"]),
    ],
)
def test_a_mistake_is_one_line_with_file_key_value_and_what_is_accepted(tmp_path, text, words):
    (line,) = lines(tmp_path, text)
    assert "mine.yaml" in line
    for word in words:
        assert word in line


def test_every_mistake_is_told_at_once(tmp_path):
    assert len(lines(tmp_path, "contact: {pixels: 1}\nnaem: x")) == 2


def test_an_unknown_scene_lists_the_known_ones():
    with pytest.raises(SceneError, match=r"unknown scene; accepted: ci, .*paper"):
        load_scene("papre")


def test_a_missing_scene_file_is_named():
    with pytest.raises(SceneError, match=r"nowhere\.yaml: no such file"):
        load_scene("nowhere.yaml")
