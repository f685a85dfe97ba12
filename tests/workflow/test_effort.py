"""Counts for a time or an error: the best there are, against all that could be chosen."""

import itertools
import json

import numpy as np
import pytest

from asperity.__main__ import main
from workflow.effort import LEAST, Effort, Knob, effort_of, known_contributions, settings_of
from workflow.report.available import Results
from workflow.report.contributions import contributions
from workflow.scene import Scene, load_scene

EFFORT = Effort(
    {"a": Knob(1, 2, 3.0, 4.0), "b": Knob(1, 1, 1.0, 0.5), "c": Knob(1, 2, 5.0, 0.0)},
    {"inputs": 0.3, "points": 0.4},
    7.0,
)


def every(effort, most=60):
    ranges = [range(knob.least, most) for knob in effort.knobs.values()]
    return [dict(zip(effort.knobs, counts, strict=True)) for counts in itertools.product(*ranges)]


@pytest.mark.parametrize("seconds", [60.0, 120.0, 240.0])
def test_no_counts_of_that_time_have_a_smaller_error(seconds):
    chosen = EFFORT.within(seconds)
    best = min(EFFORT.error_V(counts) for counts in every(EFFORT) if EFFORT.seconds(counts) <= seconds)
    assert EFFORT.seconds(chosen) <= seconds
    # whole numbers lose a little; what buys nothing gets the least
    assert EFFORT.error_V(chosen) <= 1.03 * best
    assert chosen["c"] == 2


@pytest.mark.parametrize("error_V", [0.9, 0.7, 0.6])
def test_no_counts_of_that_error_take_less_time(error_V):
    chosen = EFFORT.reaching(error_V)
    best = min(EFFORT.seconds(counts) for counts in every(EFFORT) if EFFORT.error_V(counts) <= error_V)
    assert EFFORT.error_V(chosen) <= error_V
    assert EFFORT.seconds(chosen) <= 1.1 * best


def test_the_error_is_that_of_independent_causes_by_brute_force():
    rng = np.random.default_rng(0)
    counts = {"a": 4, "b": 3, "c": 2}
    means = [
        rng.normal(0, knob.variance_V2**0.5, (20000, counts[key])).mean(axis=1) for key, knob in EFFORT.knobs.items()
    ]
    fixed = [rng.normal(0, value, 20000) for value in EFFORT.fixed_V.values()]
    assert np.std(np.sum([*means, *fixed], axis=0)) == pytest.approx(EFFORT.error_V(counts), rel=0.02)


def test_an_error_below_what_no_count_reduces_is_not_reached():
    assert EFFORT.floor_V == pytest.approx(0.5)
    assert EFFORT.reaching(0.49) is None


def test_more_of_what_takes_time_is_written_as_keys_that_a_scene_accepts():
    scene = load_scene("reduced")
    counts = {"pad.cells": 40, "pad.draws": 17, "hardness.seeds": 3, "elastic.structures": 4}
    resolved = Scene.model_validate_json(json.dumps(settings_of(scene, counts)))
    assert (resolved.pad.cells, resolved.pad.draws, resolved.hardness.seeds) == (40, 17, (1, 2, 3))
    assert resolved.elastic.structures == 4
    assert resolved.elastic.tensor_structures <= 4


def test_contributions_add_up_to_the_spread_of_the_answer(tmp_path):
    answer = {
        "release_V": {"std": 0.5},
        "sensitivity": [{"name": "rms", "share_of_variance": 0.7}],
        "design": {"cells_error_V": 0.3, "response_error_V": 0.08, "points": 64, "draws": 24, "draws_error_V": 0.1},
    }
    file = tmp_path / "device/pad_switch.json"
    file.parent.mkdir()
    file.write_text(json.dumps({"cells_computed": 100, "answer": answer}))
    found = contributions(Results(tmp_path, [file], "mine"))
    effort = effort_of(load_scene("paper"), found, {"close_cells": 256.0, "close_draws": 24.0, "fit_law": 5.0})
    assert found["fixed_V"]["inputs"] ** 2 + found["variance_V2"]["pad.cells"] / 100 == pytest.approx(0.25)
    assert found["largest"] == ["rms", 0.7]
    assert effort.knobs["pad.cells"].seconds == pytest.approx(1.0)
    assert effort.fixed_s == 5.0
    assert found["variance_V2"]["pad.draws"] / 24 == pytest.approx(0.1**2)
    answer["design"]["draws_error_V"] = None  # too few draws to tell
    for unknown in (answer, None):
        file.write_text(json.dumps({"cells_computed": 100, "answer": unknown}))
        assert contributions(Results(tmp_path, [file], "mine")) is None


@pytest.mark.parametrize(("error_GPa", "known"), [(None, False), (1.5, True)])
def test_one_glass_says_nothing_of_how_glasses_scatter(tmp_path, error_GPa, known):
    answer = {
        "release_V": {"std": 0.5},
        "sensitivity": [{"name": "e_star", "share_of_variance": 0.1}],
        "design": {"cells_error_V": 0.3, "response_error_V": 0.08, "points": 64, "draws": 24, "draws_error_V": 0.1},
    }
    glasses = {"standard_error_of_mean_GPa": error_GPa, "std_GPa": 3.0, "structures_used": ["a01"]}
    files = [tmp_path / "device/pad_switch.json", tmp_path / "elastic/e_star.json"]
    for file, content in zip(files, ({"cells_computed": 100, "answer": answer}, glasses), strict=True):
        file.parent.mkdir()
        file.write_text(json.dumps(content))
    parts = contributions(Results(tmp_path, files, "mine"))
    assert parts is not None
    assert ("elastic.structures" in parts["counts"]) is known
    assert parts["counts"].keys() == parts["variance_V2"].keys()


def test_a_scene_that_has_not_run_has_the_contributions_of_the_shipped_one_it_extends(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    scene = load_scene("paper").model_copy(update={"name": "mine", "extends": "paper"})
    assert known_contributions(scene)[1] == "shipped scene paper"
    coupled = load_scene("diamond").model_copy(update={"name": "other"})
    assert known_contributions(coupled)[1] == "shipped scene reduced"


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--budget", "1s"], "--budget 1 s: the least it takes is "),
        (
            ["--error", "0.1V"],
            "--error 0.1V: no budget reaches it: 1.5 V are left by what no count reduces, 89% of it by",
        ),
    ],
)
def test_what_cannot_be_had_is_one_line(tmp_path, monkeypatch, capfd, options, words):
    monkeypatch.chdir(tmp_path)
    assert main(["plan", "paper", *options]) == 1
    (line,) = capfd.readouterr().err.splitlines()
    assert line.startswith(f"ERROR paper: {words}")
    assert not list(tmp_path.glob("*.yaml"))


def test_a_budget_is_kept_by_a_scene_that_states_its_counts(tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("os.execv", lambda program, arguments: None)
    main(["run", "paper", "--budget", "1h", "--cores", "2"])
    said = capfd.readouterr().out
    scene = load_scene("paper_budget.yaml")
    assert scene.extends == "paper"
    assert scene.pad.cells > 256  # of `paper`, which takes minutes
    assert scene.pad.draws >= LEAST["pad.draws"]
    assert "<- chosen" in said
    assert "<- an hour more" in said
    assert "the time goes to pad.cells " in said
