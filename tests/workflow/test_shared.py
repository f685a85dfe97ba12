"""Results that another scene has made from the same inputs: taken whole, or not at all."""

import pytest

from workflow.files.checksums import is_damaged, record_of
from workflow.files.results import write_text
from workflow.run.shared import key_of, leave_note, take

KEY = key_of({"rule": "run_closing", "inputs_hash": "1", "versions": {}}, "abc")
NAMES = ("hardness/closing/small.csv", "hardness/runs/small.json")


@pytest.fixture
def results(tmp_path):
    """Two scenes, of which the first has the results of a job."""
    for scene in ("first", "second"):
        (tmp_path / scene / "logs").mkdir(parents=True)
    for name in NAMES:
        write_text(tmp_path / "first" / name, f"content of {name}")
    leave_note(tmp_path / "first/logs/run_closing_small.log", KEY)
    return tmp_path


def taken(results, key=KEY):
    log = results / "second/logs/run_closing_small.log"
    return take(log, [str(results / "second" / name) for name in NAMES], key)


def test_the_results_of_another_scene_are_copied_with_their_checksums(results):
    assert taken(results) == str(results / "first")
    for name in NAMES:
        assert (results / "second" / name).read_text() == f"content of {name}"
        assert record_of(results / "second" / name).is_file()
        assert not is_damaged(results / "second" / name)


def test_another_job_takes_nothing(results):
    other = key_of({"rule": "run_closing", "inputs_hash": "2", "versions": {}}, "abc")
    newer = key_of({"rule": "run_closing", "inputs_hash": "1", "versions": {}}, "abd")
    assert len({KEY, other, newer}) == 3
    assert taken(results, other) == taken(results, newer) == ""
    assert not (results / "second" / NAMES[0]).exists()


def test_damaged_or_missing_results_are_not_taken(results):
    (results / "first" / NAMES[0]).write_text("cut")
    assert taken(results) == ""
    (results / "first" / NAMES[0]).unlink()
    assert taken(results) == ""


def test_a_changed_checkout_shares_nothing(results):
    key = key_of({"rule": "run_closing"}, "abc-dirty")
    assert key == ""
    assert taken(results, key) == ""
    leave_note(results / "second/logs/run_closing_small.log", key)
    assert list((results / "second/logs").iterdir()) == []
