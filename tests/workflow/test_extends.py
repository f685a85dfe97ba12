"""A scene may extend another: it states only what differs."""

import pytest

from workflow.scene import SceneError, load_scene, locate


def written(folder, name, text):
    path = folder / f"{name}.yaml"
    path.write_text(text)
    return str(path)


def test_keys_merge_and_rows_of_inputs_are_replaced_whole(tmp_path):
    mine = written(
        tmp_path,
        "mine",
        "extends: paper\ninputs: {e_star: {origin: elastic}}\ncontact: {pixels: 64}\npad: {cells:"
        " 9}\n",
    )
    scene, paper = load_scene(mine), load_scene("paper")
    assert scene.name == "mine"
    assert scene.inputs.e_star.origin == "elastic"
    assert scene.inputs.rms == paper.inputs.rms
    assert scene.contact == paper.contact.model_copy(update={"pixels": 64})
    assert scene.pad.cells == 9


def test_scenes_extend_along_a_line_and_files_lie_beside_any_of_them(tmp_path):
    (tmp_path / "there").mkdir()
    (tmp_path / "there" / "scan.txt").write_text("0")
    written(tmp_path / "there", "first", "extends: paper\ndevice: {gap_um: 2.5}\n")
    mine = written(tmp_path, "mine", "extends: there/first.yaml\n")
    assert load_scene(mine).device.gap_um == 2.5
    assert locate(mine, "topography.scans", ["scan.txt"]) == [str(tmp_path / "there" / "scan.txt")]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("extends: mine.yaml\n", "this scene extends itself"),
        ("extends: gone.yaml\n", "extends: scene=gone.yaml: no such file"),
        ("extends: papr\n", "extends: scene=papr: unknown scene; accepted: "),
        ("extends: 3\n", "extends = 3: accepted is the name or path of a scene"),
    ],
)
def test_a_line_that_leads_nowhere_is_one_line(tmp_path, text, words):
    path = written(tmp_path, "mine", text)
    with pytest.raises(SceneError) as error:
        load_scene(path)
    assert words in str(error.value)
    assert len(str(error.value).splitlines()) == 1


def test_scenes_that_extend_each_other_are_one_line(tmp_path):
    written(tmp_path, "first", "extends: second.yaml\n")
    second = written(tmp_path, "second", "extends: first.yaml\n")
    with pytest.raises(SceneError, match="extends itself"):
        load_scene(second)
