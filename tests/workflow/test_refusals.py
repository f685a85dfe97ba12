"""What cannot run is refused in one line, before any job starts."""

import fcntl
import json

import pytest
import yaml

from evidence.attacks.runs import TRACE
from workflow.scene import Scene, SceneError, files_of, load_scene, locate
from workflow.scene.checks import mistakes


def errors(done):
    return [line for line in (done.stdout + done.stderr).splitlines() if line.startswith("ERROR")]


def test_an_unknown_scene(workflow_in):
    done = workflow_in.run("papre")
    assert done.returncode != 0
    (line,) = errors(done)
    assert "unknown scene" in line
    assert not TRACE.search(done.stderr)


@pytest.mark.parametrize(
    "said",
    [
        "x\nTraceback (most recent call last):",
        'PermissionError in file "common.smk", line 38:\n[Errno 13] Permission denied',
        '[Errno 13] Permission denied\n  File "common.smk", line 38, in <module>',
        "Error in rule inputs:",
        "Fatal Python error: init_import_site",
        "ERROR inputs: internal error (KeyError: 'x'); details in inputs.log",
    ],
)
def test_traces_without_the_word_are_found(said):
    assert TRACE.search(said)
    assert not TRACE.search(
        "ERROR mine.yaml: name = 3: an Error of yours\nasperity compare: error: no results"
    )


@pytest.mark.parametrize(
    ("target", "meant"),
    [
        ("lwa", "law"),
        ("results/paper/uncertainty/outputs.cs", "results/paper/uncertainty/outputs.csv"),
    ],
)
def test_a_mistyped_target_is_one_line_with_the_nearest_name(workflow_in, target, meant):
    done = workflow_in.run("paper", target)
    assert done.returncode != 0
    assert done.stderr.splitlines()[-1] == (
        f"ERROR {target}: no such target; did you mean {meant}? (asperity targets lists the stages)"
    )
    assert not TRACE.search(done.stderr)


def scans_of(scene):
    return locate(scene, "topography.scans", files_of(scene, load_scene(scene).topography.scans))


def test_names_that_would_act_on_a_terminal_or_are_too_long(workflow_in, monkeypatch):
    monkeypatch.chdir(workflow_in.folder)
    forged, long = "x\x1b]0;title\x07\u202e\nERROR y", "n" * 300
    (workflow_in.folder / f"{forged}.yaml").write_text("name: x")
    (workflow_in.folder / f"{forged}.gwy").write_text("")
    (workflow_in.folder / "scans").mkdir()
    (workflow_in.folder / f"scans/{forged}.gwy").write_text("")
    name = json.dumps(forged)[1:-1]
    for text, words in (
        (f'extends: "{name}.yaml"', "characters that do not print"),
        (
            f'{{compute: [topography], topography: {{scans: ["{name}.gwy"]}}}}',
            "characters that do not print",
        ),
        ("{compute: [topography], topography: {scans: [scans]}}", "characters that do not print"),
        (f"extends: {long}.yaml", "no such file"),
        (f"{{compute: [topography], topography: {{scans: [{long}]}}}}", "no such file"),
    ):
        (workflow_in.folder / "mine.yaml").write_text(text)
        with pytest.raises(SceneError, match=words) as error:
            scans_of("mine.yaml")
        assert str(error.value).isprintable()
    with pytest.raises(SceneError, match="characters that do not print"):
        load_scene(f"{forged}.yaml")


def test_contradictions_are_told_all_at_once(workflow_in):
    scene = workflow_in.folder / "mine.yaml"
    scene.write_text(
        "{uncertainty: {direct_runs: 1}, contact: {model: elastic}, history: {cycles: 2}}"
    )
    done = workflow_in.run(str(scene))
    assert done.returncode != 0
    for line, words in zip(
        errors(done), ("needs at least 14", "only plastic contacts"), strict=True
    ):
        assert line.startswith(f"ERROR {scene}: ")
        assert words in line


def test_a_film_softer_than_its_base():
    rows = {"h_film": [2, 10], "t_film": [4, 5], "k_film": [0.1, 0.5], "m_film": [1, 2]}
    inputs = {
        "hardness": "film",
        "h_prime": None,
        **{name: {"values": tuple(values)} for name, values in rows.items()},
    }
    (line,) = mistakes(Scene.model_validate({"inputs": inputs}), {})
    assert line.startswith("inputs.h_film reaches down to 2 GPa")
    assert "films softer than their base are not modelled" in line


def test_a_film_without_thickness():
    rows = {"h_film": [7, 10], "t_film": [0, 0], "k_film": [0.1, 0.5], "m_film": [1, 2]}
    inputs = {
        "hardness": "film",
        "h_prime": None,
        **{name: {"values": tuple(values)} for name, values in rows.items()},
    }
    (line,) = mistakes(Scene.model_validate({"inputs": inputs}), {})
    assert line.startswith("inputs.t_film = 0: without a film take inputs.hardness: paper")


def test_points_that_cannot_tell_causes_apart_are_refused_before_anything_runs():
    scene = Scene.model_validate({"extends": "table1", "pad": {"points": 30}})
    (line,) = [line for line in mistakes(scene, {}) if line.startswith("pad.points")]
    wanted = int(line.rpartition(" ")[2])
    assert line.startswith(
        f"pad.points = 30: {wanted // 2 - 1} inputs and properties of the device vary, whose parts"
    )
    plate = Scene.model_validate(
        {"extends": "table1", "pad": {"points": 4}, "device": {"spring_N_per_m": 10}}
    )
    said = [line for line in mistakes(plate, {}) if line.startswith("pad.points")]
    # 7 inputs, scatter of RMS, D0, and three of a plate
    assert said[0].startswith("pad.points = 4: 12 ")
    for points in (0, wanted):
        assert not mistakes(
            Scene.model_validate({"extends": "table1", "pad": {"points": points}}), {}
        )


@pytest.mark.parametrize(
    ("device", "words"),
    [
        (
            "{hold_voltage_V: 40, youngs_modulus_GPa: 89.3}",
            "device.hold_voltage_V = 40: never closes this switch, which pulls in at 75.62 V",
        ),
        ("{hold_voltage_V: 40, bow_nm: -2000, youngs_modulus_GPa: 89.3}", ""),
        (
            "{gap_um: 1, tilt_nm: 2100}",
            "at rest the electrode is -50 nm above what it lands on at its lowest",
        ),
        (
            "{gap_um: 1, tilt_nm: 1900, bow_nm: -700}",
            "",
        ),  # the middle and the end that are low are not one place
    ],
)
def test_a_switch_that_never_closes_or_is_never_open(device, words):
    scene = Scene.model_validate({"device": yaml.safe_load(device)})
    found = [line for line in mistakes(scene, {}) if line.startswith("device")]
    assert [words in line for line in found] == [True] * bool(words)


def test_bodies_whose_bases_have_another_modulus():
    bodies = [[{"young_GPa": 250, "poisson": 0.25}]]
    scene = Scene.model_validate(
        {
            "contact": {"mechanics": "coupled", "bodies": bodies},
            "inputs": {"e_star": {"origin": "literature", "values": [90, 92], "source": "test"}},
        }
    )
    (line,) = [line for line in mistakes(scene, {}) if line.startswith("contact.bodies")]
    assert "E* = 266.7 GPa, inputs.e_star reaches from 90 to 92" in line


@pytest.mark.parametrize(
    "humid",
    [{"inputs": {"humidity": {"values": [0, 0.8]}}}, {"contact": {"air": {"humidity": 0.8}}}],
)
def test_humid_air_in_a_vacuum(humid):
    scene = Scene.model_validate({**humid, "device": {"gas_kPa": 0.001}})
    (line,) = [line for line in mistakes(scene, {}) if line.startswith("device.gas_kPa")]
    assert "air of 80% humidity has 1.87 kPa of vapour alone at 20 C; a vacuum is dry" in line
    assert not [line for line in mistakes(Scene.model_validate(humid), {}) if "gas_kPa" in line]


def test_a_humidity_that_is_given_twice():
    scene = Scene.model_validate(
        {
            "inputs": {"humidity": {"values": [0, 0.8]}},
            "contact": {"air": {"humidity": 0.5, "film_nm": 0.3}},
        }
    )
    assert (
        "contact.air.humidity and inputs.humidity give the same number; leave one out"
        in mistakes(scene, {})
    )


def test_an_attraction_that_the_grid_does_not_resolve():
    scene = Scene.model_validate(
        {
            "contact": {"mechanics": "adhesive", "gap_cutoff_nm": 0.165, "pixels": 512},
            "inputs": {
                "e_star": {"origin": "literature", "values": [90, 92], "source": "test"},
                "hamaker": {"origin": "literature", "values": [0.18, 0.25], "source": "test"},
            },
        }
    )
    (line,) = [line for line in mistakes(scene, {}) if line.startswith("contact.mechanics")]
    assert "take contact.pixels >= 670, a larger D0" in line


def test_a_run_of_weeks_is_planned_with_its_time_and_refused(workflow_in):
    scene = workflow_in.folder / "mine.yaml"
    scene.write_text(
        "{contact: {mechanics: coupled, pixels: 2048}, uncertainty: {direct_runs: 100000}}"
    )
    said = workflow_in.plan(str(scene), "uncertainty")
    assert "a run is refused: jobs compute_direct_runs take " in said
    assert said.split(" jobs, about ")[1].split()[1] == "h"
    done = workflow_in.run(str(scene), "uncertainty")
    assert done.returncode != 0
    (line,) = errors(done)
    assert line.startswith(f"ERROR {scene}: jobs compute_direct_runs take ")
    assert not (workflow_in.folder / "results").exists()


def test_a_table_of_measurements_that_cannot_be_used(workflow_in):
    scene = workflow_in.folder / "mine.yaml"
    (workflow_in.folder / "forces.csv").write_text("pull_off,pull_off_error_nN\n200,20\n")
    scene.write_text("measurements: {tables: [{kind: pull_off, file: forces.csv}]}")
    done = workflow_in.run(str(scene), "calibration")
    assert done.returncode != 0
    (line,) = errors(done)
    assert "forces.csv: column pull_off has no unit" in line


def test_a_broken_potential_is_told_by_the_plan(workflow_in):
    scene = workflow_in.folder / "mine.yaml"
    (workflow_in.folder / "mine.pot.yaml").write_text("species: {Si: {mass_u: !!int x}}\n")
    scene.write_text("{compute: [hardness], hardness: {potential: mine.pot.yaml}}")
    done = workflow_in.run(str(scene), "hardness", options=("--dry-run",))
    assert done.returncode != 0
    (line,) = errors(done)
    assert "mine.pot.yaml" in line
    assert "tag" in line


def test_no_permission_to_write(workflow_in):
    # a file where the folder of results should be stops everybody, the superuser of a CI machine
    # included
    (workflow_in.folder / "results").write_text("")
    done = workflow_in.run("paper")
    assert done.returncode != 0
    (line,) = errors(done)
    assert "cannot write" in line


def test_a_link_of_results_that_leads_nowhere(workflow_in):
    (workflow_in.folder / "results").symlink_to("/nowhere/at/all")
    done = workflow_in.run("paper")
    assert done.returncode != 0
    (line,) = errors(done)
    assert "results: a link to /nowhere/at/all, which is not there" in line


def test_two_runs_of_one_scene(workflow_in):
    results = workflow_in.folder / "results/paper"
    results.mkdir(parents=True)
    with (results / ".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        done = workflow_in.run("paper")
    assert done.returncode != 0
    (line,) = errors(done)
    assert "another run of this scene" in line
