"""Nonsense is refused before anything runs; a mutated scene is refused in clear lines or used as it
stands.
"""

import pytest

from tests.workflow.judged_scenes import judge
from tests.workflow.mutated_scenes import mutated
from tests.workflow.nonsense_scenes import NONSENSE
from workflow.scene import load_scene


@pytest.fixture(autouse=True)
def machine(monkeypatch):
    """A machine of 16 GB, wherever the tests run."""
    monkeypatch.setattr("workflow.scene.checks.machine_MB", lambda: 16_000)


@pytest.mark.parametrize("name", NONSENSE)
def test_nonsense_is_refused_with_its_key(tmp_path, name):
    text, words = NONSENSE[name]
    outcome, said = judge(text, tmp_path / "nonsense.yaml")
    assert outcome == "refused"
    assert words in said


def test_mutated_scenes_are_refused_in_lines_or_used_as_they_stand(tmp_path):
    rows = [judge(mutated(seed), tmp_path / "mutated.yaml") for seed in range(100)]
    assert not [words for outcome, words in rows if outcome == "fault"]
    assert {outcome for outcome, _ in rows} == {"used", "refused"}


def test_a_seed_gives_its_scene_again():
    assert mutated(7) == mutated(7) != mutated(8)


@pytest.mark.parametrize(
    ("used", "words"),
    [
        ("device: {gap_um: 3.5}", ""),
        ("device: {gap_um: 3.49}", "device.gap_um: '3.5' was read as 3.49"),
        ("", "device.gap_um: '3.5' was read as 3.49"),  # the default
    ],
)
def test_the_judge_sees_a_value_that_is_read_as_another(tmp_path, monkeypatch, used, words):
    other = tmp_path / "other.yaml"
    other.write_text(used)
    scene = load_scene(str(other))
    monkeypatch.setattr("tests.workflow.judged_scenes.load_scene", lambda path: scene)
    outcome, said = judge("device: {gap_um: 3.5}", tmp_path / "given.yaml")
    assert outcome == ("fault" if words else "used")
    assert words in said
