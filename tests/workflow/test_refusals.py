"""What cannot run is refused in one line, before any job starts."""

import fcntl

import pytest


def errors(done):
    return [line for line in (done.stdout + done.stderr).splitlines() if line.startswith("ERROR")]


def test_an_unknown_scene(workflow_in):
    done = workflow_in.run("papre")
    assert done.returncode != 0
    (line,) = errors(done)
    assert "unknown scene" in line
    assert "Traceback" not in done.stderr


def test_a_mistake_in_a_scene(workflow_in):
    scene = workflow_in.folder / "mine.yaml"
    scene.write_text("contact: {pixels: 1}")
    done = workflow_in.run(str(scene))
    assert done.returncode != 0
    (line,) = errors(done)
    assert "contact.pixels = 1" in line


@pytest.mark.parametrize(
    ("scene", "words"),
    [
        ("inputs: {rms: {a: -2, b: 15}}", "inputs.rms: spans -2 .. 15 nm; accepted is"),
        ("inputs: {gap_cutoff: {a: 0.15, b: 30}}", "inputs.gap_cutoff: spans 0.15 .. 30 nm; accepted is"),
        (
            "{inputs: {gap_cutoff: {a: 0.15, b: 0.3}}, contact: {gap_cutoff_nm: 0.2}}",
            "contact.gap_cutoff_nm and inputs.gap_cutoff give the same number",
        ),
        ("{contact: {pixels: 64}, inputs: {q0: {a: 0.5, b: 0.9}}}", "inputs.q0.b = 0.9 1/nm lies beyond what the grid"),
        (
            "uncertainty: {audit_readings: [zzz]}",
            "uncertainty.audit_readings: 'zzz' is no reading; accepted: all, mended",
        ),
        ("elastic: {dft: {basis: sto-3g}}", 'elastic.dft.basis = "sto-3g": accepted is text of the form ^gth-'),
        ("contact: {nominal_loads_nN: [-1]}", "contact.nominal_loads_nN.0 = -1: accepted is"),
        (
            "hardness: {asperities: [{name: a, tiles: 2, amplitude_nm: 0.4}, {name: a, tiles: 3, amplitude_nm: 0.6}]}",
            "asperities: two have the same name",
        ),
        (
            "inputs: {correlations: [{first: rms, second: q0, rank: 0.9}, {first: q0, second: hurst, rank: 0.9}, "
            "{first: rms, second: hurst, rank: -0.9}]}",
            "correlation",
        ),
    ],
)
def test_inputs_that_contradict_physics_or_each_other_or_do_not_exist(workflow_in, scene, words):
    path = workflow_in.folder / "mine.yaml"
    path.write_text(scene)
    done = workflow_in.run(str(path))
    assert done.returncode != 0
    (line,) = errors(done)
    assert words in line


def test_no_permission_to_write(workflow_in):
    # a file where the folder of results should be stops everybody, the superuser of a CI machine included
    (workflow_in.folder / "results").write_text("")
    done = workflow_in.run("paper")
    assert done.returncode != 0
    (line,) = errors(done)
    assert "cannot write" in line


def test_results_of_another_scene_of_the_same_name(workflow_in):
    scene = workflow_in.folder / "mine.yaml"
    scene.write_text("")
    results = workflow_in.folder / "results/mine"
    results.mkdir(parents=True)
    (results / ".scene").write_text("/elsewhere/mine.yaml\n")
    done = workflow_in.run(str(scene))
    assert done.returncode != 0
    (line,) = errors(done)
    assert f"results of /elsewhere/mine.yaml, not of {scene}; give one of them another name" in line


def test_two_runs_of_one_scene(workflow_in):
    results = workflow_in.folder / "results/paper"
    results.mkdir(parents=True)
    with (results / ".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        done = workflow_in.run("paper")
    assert done.returncode != 0
    (line,) = errors(done)
    assert "another run of this scene" in line


def test_a_base_that_would_be_felt(workflow_in):
    scene = workflow_in.folder / "mine.yaml"
    scene.write_text("hardness: {closing: {base_over_contact: 0.8}}")
    done = workflow_in.run(str(scene))
    assert done.returncode != 0
    (line,) = errors(done)
    assert "hardness.closing.base_over_contact = 0.8: a base thinner than 1 of the largest contact is felt" in line
