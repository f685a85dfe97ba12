"""What a scene schedules: everything it needs and nothing else."""

import json
import os
import re
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

from asperity.guards.bundle import ROOT
from workflow.run.studies import STUDIES

HARDNESS = {"make_glass", "run_closing", "hardness"}
ELASTIC = {"make_amorphous", "scan_glass", "elastic"}
TOPOGRAPHY = {"write_synthetic_scans", "analyse_scans", "pool_spectra"}
MESOSCALE = {"inputs", "contact", "compute_runs", "law", "uncertainty"}
REPORT = {"answer", "report"}

LITERATURE = """
inputs:
  e_star: {origin: literature, distribution: normal, values: [91, 3.8]}
  h_prime: {origin: literature, values: [1.95, 14.8]}
"""


@pytest.fixture(scope="module")
def said(make_workflow, tmp_path_factory):
    """What the plan of a scene from nothing says, by scene and target."""
    workflow = make_workflow(tmp_path_factory.mktemp("plans"))

    @cache
    def words(scene: str, *targets: str) -> str:
        if scene == "literature":
            path = workflow.folder / "literature.yaml"
            path.write_text(LITERATURE)
            scene = str(path)
        return workflow.plan(scene, *targets)

    return words


@pytest.fixture(scope="module")
def plan(said, make_workflow):
    """Names of the rules that a scene would run from nothing, by scene and target."""
    return lambda scene, *targets: set(make_workflow.jobs(said(scene, *targets)))


@pytest.mark.parametrize("scene", ["ci", "reduced", "full"])
def test_these_scenes_run_from_atoms_and_scans_to_the_report(plan, scene):
    assert plan(scene) >= HARDNESS | ELASTIC | TOPOGRAPHY | MESOSCALE | REPORT


def test_scene_paper_runs_no_atomistic_and_no_afm_job(plan):
    assert not (HARDNESS | ELASTIC | TOPOGRAPHY) & plan("paper")
    assert plan("paper") >= MESOSCALE | {"report"}


def test_the_failure_rate_is_found_where_a_scene_asks_for_it(plan):
    assert "failure" not in plan("paper") | plan("ci")


def test_a_scene_computes_the_tails_that_it_wants(plan):
    assert not {"compute_runs", "law", "uncertainty"} & plan("diamond")
    assert "answer" in plan("diamond")
    assert not {"press_pads", "pad", "answer"} & plan("paper")


@pytest.mark.parametrize("scene", ["films", "titania", "nitride", "sizes", "history"])
def test_a_scene_without_tails_computes_what_it_is_for(plan, scene):
    planned = plan(scene)
    assert not {"contact", *MESOSCALE - {"inputs"}, "press_pads", "answer"} & planned
    assert planned >= {"report", "history" if scene == "history" else "run_closing"}
    # their surface may be steeper than all runs, which is nothing to a scene of hardness alone
    assert ("inputs" in planned) == (scene == "history")


def test_humidity_is_swept_where_a_scene_has_humid_air(plan):
    assert "humidity" not in plan("paper") | plan("ci") | plan("reduced")
    assert "humidity" in plan("humid") & plan("humid", "humidity")


def test_a_life_is_found_where_a_scene_asks_for_it(plan):
    assert "lifetime" not in plan("paper") | plan("ci") | plan("reduced") | plan("history")
    assert "lifetime" in plan("lifetime") & plan("lifetime", "lifetime")
    assert "narrow_rates" not in plan("lifetime")


def test_failures_of_a_plate_are_planned_without_the_circuit_that_it_has_not(workflow_in):
    path = workflow_in.folder / "plate.yaml"
    path.write_text("extends: ci\ndevice: {spring_N_per_m: 170}\nfailure: {probability: 1.0e-3}\n")
    planned = workflow_in.planned(str(path))
    assert "failure" in planned
    assert "circuit" not in planned
    asked = workflow_in.run(str(path), "circuit", options=("--dry-run",))
    assert asked.returncode == 1
    assert "device.spring_N_per_m: circuits are made of bending electrodes" in asked.stderr


@pytest.fixture(scope="module")
def every_plan(tmp_path_factory):
    """Words by scene and target: none of a plan that stands, else the last line of its refusal."""
    folder = tmp_path_factory.mktemp("every_plan")
    command = [sys.executable, str(Path(__file__).with_name("plan_everything.py"))]
    places = {"PYTHONPATH": str(ROOT), "XDG_CACHE_HOME": str(folder / "cache")}
    done = subprocess.run(
        command, cwd=folder, env=os.environ | places, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return {(scene, target): words for scene, target, words in json.loads(done.stdout)}


def test_every_target_of_every_scene_is_planned_or_refused_for_a_true_reason(every_plan):
    reasons = {
        "humidity": "the air is dry; give inputs.humidity or contact.air",
        "history": "history.cycles = 0: give the cycles of each surface",
        "calibration": (
            "measurements.tables: none; name the tables of measurements (docs/calibration.md)"
        ),
        "lifetime": "lifetime.years = null: give the life that is asked for, such as 10",
        "failure": (
            "failure.probability = null: give the share of the switches that may fail, such as 1e-6"
        ),
    }
    serves = {("humid", "humidity"), ("history", "history"), ("made_up", "calibration")}
    serves |= {("lifetime", "lifetime")}
    refused = {pair: words for pair, words in every_plan.items() if words}
    expected = {
        (scene, target): f"ERROR {scene}: {reasons[target]}"
        for scene, target in every_plan
        if target in reasons and (scene, target) not in serves
    }
    assert refused == expected
    assert len(every_plan) > 200


def test_a_target_runs_whatever_the_tails_of_the_scene_say(every_plan):
    for pair in (
        ("paper", "pad"),
        ("diamond", "law"),
        ("sizes", "sensitivity"),
        ("films", "answer"),
    ):
        assert every_plan[pair] == ""


def test_an_input_from_literature_schedules_no_job_that_would_compute_it(plan):
    assert not (HARDNESS | ELASTIC) & plan("literature")
    assert plan("literature") >= TOPOGRAPHY | MESOSCALE | REPORT


def test_a_target_runs_its_stage_and_what_that_needs(plan):
    rules = plan("paper", "law")
    assert {"inputs", "compute_runs", "law"} <= rules
    assert not REPORT & rules


def test_only_scenes_with_measurements_schedule_a_calibration(plan):
    calibration = {"collect_priors", "observe_cycles", "calibration"}
    for scene in ("ci", "paper", "reduced", "full", "literature"):
        assert not calibration & plan(scene)
    assert plan("made_up") >= calibration | MESOSCALE | REPORT
    assert "press_prior_pads" not in plan("made_up")


def test_voltages_of_switches_are_compared_with_pads_over_the_prior(make_workflow, tmp_path):
    workflow = make_workflow(tmp_path)
    (tmp_path / "volts.csv").write_text("release_V,release_error_V\n12,0.5\n")
    (tmp_path / "mine.yaml").write_text(
        "measurements: {tables: [{kind: release, file: volts.csv}]}"
    )
    jobs = set(workflow.jobs(workflow.plan(str(tmp_path / "mine.yaml"), "calibration")))
    assert jobs >= {"collect_priors", "press_prior_pads", "calibration"}
    assert not jobs & {"press_pads", "inputs"}


def test_a_drift_narrows_the_rates_and_presses_nothing_for_it(make_workflow, tmp_path):
    workflow = make_workflow(tmp_path)
    rows = "60,1,0.2,0.05\n70,1,0.9,0.05\n"
    (tmp_path / "drift.csv").write_text(f"hold_V,time_s,shift_V,shift_error_V\n{rows}")
    (tmp_path / "mine.yaml").write_text(
        "extends: lifetime\nmeasurements: {tables: [{kind: drift, file: drift.csv}]}"
    )
    jobs = set(workflow.jobs(workflow.plan(str(tmp_path / "mine.yaml"), "lifetime")))
    assert jobs >= {"narrow_rates", "lifetime", "press_pads"}
    assert not jobs & {"calibration", "observe_cycles", "press_prior_pads"}
    (tmp_path / "drift.csv").write_text(
        "hold_V,time_s,shift_V,shift_error_V\n60,1,0.2,0.05\n60,10,0.3,0.05\n"
    )
    refused = workflow.run(str(tmp_path / "mine.yaml"), "lifetime", options=("--dry-run",))
    assert refused.returncode == 1
    assert "one voltage does not tell injection from emission" in refused.stderr


def test_studies_run_only_where_they_are_asked_for(plan):
    for scene in ("ci", "paper", "reduced", "full"):
        assert not [
            rule for rule in plan(scene) if rule.endswith(("accuracy", "stability", "study"))
        ]


def test_studies_of_a_scene_leave_out_the_stages_it_does_not_use(plan):
    studied = plan("paper", "accuracy", "stability")
    assert "study" in studied
    assert not (HARDNESS | ELASTIC | TOPOGRAPHY) & studied
    foreign = ("hardness", "elastic", "topography", "closing")
    assert not [rule for rule in studied if any(word in rule for word in foreign)]


def test_studies_of_a_scene_cover_every_stage_it_uses(said):
    """Hardness, elastic, topography, contact, uncertainty, pad, answer and circuit, each in
    both.
    """
    assert re.search(r"^study +16 ", said("ci", "accuracy", "stability"), re.MULTILINE)


def test_every_study_that_a_rule_promises_exists():
    rules = (ROOT / "workflow/rules/studies.smk").read_text(encoding="utf-8")
    stages = re.findall(r'^    "(\w+)": \(', rules, re.MULTILINE)
    assert set(STUDIES) == {(kind, stage) for kind in ("accuracy", "stability") for stage in stages}


def test_every_file_that_a_scene_makes_is_asked_for_so_that_a_lost_one_is_made_again(
    make_workflow, tmp_path
):
    workflow = make_workflow(tmp_path)
    table = workflow.run("ci", options=("--summary",)).stdout.splitlines()
    made = {line.split("\t")[0] for line in table[1:]}
    plan = workflow.run("ci", options=("--dry-run",))
    (asked,) = (
        line for line in (plan.stdout + plan.stderr).splitlines() if line.startswith("    input: ")
    )
    assert len(made) > 50
    assert made <= set(asked.removeprefix("    input: ").split(", "))
