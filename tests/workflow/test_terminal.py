"""What a run says: its cost before, a line for each job, the time left."""

import logging
from types import SimpleNamespace

import h5py
import numpy as np
import pytest

from workflow.run.cost import Costs, refusal, wall_seconds
from workflow.run.progress import Terminal, duration, speak
from workflow.scene import Scene, load_scene


class OneSecondEach:
    """Costs of a scene in which every job takes a second; no job of the rule `unheard_of` ran here
    before.
    """

    def __init__(self):
        self.learned = []

    def seconds(self, rule, wildcards):
        return 1.0

    def known(self, rules):
        return "unheard_of" not in rules

    def learn(self, rule, wildcards, took):
        self.learned.append(rule)


class Job(SimpleNamespace):
    """A job of a plan, told from others by identity."""

    __hash__ = object.__hash__


def job(name, number=7):
    rule = SimpleNamespace(name=name, norun=False)
    return Job(rule=rule, wildcards_dict={}, priority=0, jobid=number, params=[], output=[])


RECORDED = SimpleNamespace(params=lambda path: None)  # nothing is known of former jobs


def send(terminal, event, **about):
    record = logging.makeLogRecord({"msg": "", "event": event, **about})
    terminal.emit(record)


@pytest.mark.parametrize("dry", [True, False])
def test_the_plan_comes_first_and_each_job_has_its_line(capsys, dry):
    jobs = [job("fit_law"), job("fit_law", 8), job("unheard_of", 9)]
    dag = SimpleNamespace(needrun_jobs=lambda: jobs, job_dependencies=lambda job: [])
    snakemake = SimpleNamespace(dryrun=dry, local_exec=True, cores=2, dag=dag, persistence=RECORDED)
    costs = OneSecondEach()
    terminal = Terminal(snakemake, costs, "nothing to do", 12)
    send(terminal, "run_info")
    send(terminal, "job_info", jobid=7, rule_name="fit_law", rule_msg="fit the law")
    send(terminal, "job_finished", job_id=7)
    said = capsys.readouterr().err
    assert "3 jobs, about 2 s on 2 cores, a guess until jobs of this scene have run here" in said
    assert ("fit_law         2        2 s" in said) == dry
    assert ("1 of 3  fit the law (1 s), 1 s left" in said) == (not dry)
    assert costs.learned == ([] if dry else ["fit_law"])


def test_the_time_left_follows_what_jobs_take(capsys, monkeypatch, tmp_path):
    # a machine of a tenth of the speed: after three jobs of eight seconds the rest is known to a
    # third
    clock, chunks = [0.0], [job("compute_direct_runs", number) for number in range(8)]
    monkeypatch.setattr("workflow.run.progress.time.monotonic", lambda: clock[0])
    dag = SimpleNamespace(needrun_jobs=lambda: chunks, job_dependencies=lambda job: [])
    snakemake = SimpleNamespace(
        dryrun=False, local_exec=True, cores=1, dag=dag, persistence=RECORDED
    )
    costs = Costs(load_scene("paper"), {}, tmp_path / "none.json")
    takes = 10 * costs.seconds("compute_direct_runs", {})
    terminal = Terminal(snakemake, costs, "nothing to do", 12)
    wall_s = terminal._wall_s
    send(terminal, "run_info")
    for number in range(3):
        send(
            terminal, "job_info", jobid=number, rule_name="compute_direct_runs", rule_msg="compute"
        )
        clock[0] += takes
        send(terminal, "job_finished", job_id=number)
    assert wall_s() == pytest.approx(5 * takes, rel=1 / 3)
    send(terminal, "job_info", jobid=3, rule_name="compute_direct_runs", rule_msg="compute")
    left = wall_s()
    clock[0] += takes / 2  # a job at work is counted by what is left of it
    assert wall_s() == pytest.approx(left - takes / 2)
    assert capsys.readouterr().err.count(" left") == 3


@pytest.mark.parametrize(
    ("local", "hours", "begin"),
    [(True, 12, ""), (True, 1e-4, "jobs fit_law take"), (False, 1e-4, "")],
)
def test_a_run_that_is_too_long_is_refused_unless_a_cluster_takes_it(local, hours, begin):
    dag = SimpleNamespace(needrun_jobs=lambda: [job("fit_law")], job_dependencies=lambda job: [])
    snakemake = SimpleNamespace(
        dryrun=False, local_exec=local, cores=2, dag=dag, persistence=RECORDED
    )
    terminal = Terminal(snakemake, OneSecondEach(), "nothing to do", hours)
    send(terminal, "run_info")
    assert terminal.refusal.startswith(begin)
    assert bool(terminal.refusal) == bool(begin)


def test_a_changed_file_comes_first_with_what_it_renews_and_asks_for_hours_as_long_runs_do(capsys):
    glass, closing, other = job("make_glass", 1), job("run_closing", 2), job("pool_spectra", 3)
    glass.params, glass.output = [{"mine.yaml": "b" * 64}], ["glass.data"]
    recorded = SimpleNamespace(params=lambda path: [repr({"mine.yaml": "a" * 64})])
    needs = {closing: [glass]}
    dag = SimpleNamespace(
        needrun_jobs=lambda: [glass, closing, other],
        job_dependencies=lambda job: needs.get(job, []),
    )
    snakemake = SimpleNamespace(
        dryrun=False, local_exec=True, cores=1, dag=dag, persistence=recorded
    )
    terminal = Terminal(snakemake, OneSecondEach(), "nothing to do", 1e-4)
    send(terminal, "run_info")
    first, second, third = capsys.readouterr().err.splitlines()
    assert (
        first == "mine.yaml: changed since results were made of it; renews make_glass, run_closing"
    )
    assert second.strip() == "(jobs: 2, about 2 s)"
    assert third.startswith("3 jobs, about 3 s on 1 cores")
    assert "--hours" in terminal.refusal


def test_the_release_is_told_as_switches_are_solved(capsys, tmp_path):
    """By the quantiles of the answer, over the points that are there: those of an earlier run,
    too.
    """
    jobs = []
    for number, release_V in enumerate(([9.0], [0.0, 4.0, np.nan], [5.0] * 18)):
        jobs.append(job("press_pads", number))
        jobs[-1].output = [str(tmp_path / f"{number}.h5")]
        with h5py.File(jobs[-1].output[0], "w") as file:
            for point, value in enumerate(release_V, number):  # the first is the central one
                file.create_group(f"point_{point:04d}").attrs["release_V"] = value
    dag = SimpleNamespace(jobs=jobs, needrun_jobs=lambda: jobs[1:], job_dependencies=lambda job: [])
    snakemake = SimpleNamespace(
        dryrun=False, local_exec=True, cores=1, dag=dag, persistence=RECORDED
    )
    terminal = Terminal(snakemake, OneSecondEach(), "", 12)
    send(terminal, "run_info")
    for number in (1, 2):
        send(terminal, "job_info", jobid=number, rule_name="press_pads", rule_msg="press")
        send(terminal, "job_finished", job_id=number)
    first, second = (line for line in capsys.readouterr().err.splitlines() if "so far" in line)
    few, enough = "least: sticks; largest: 4.00 V", "5 %: 3.80 V; 95 %: 5.00 V"
    assert first == f"  release of 2 switches so far: 2.00 V ({few}); 50% stick"
    assert second == f"  release of 20 switches so far: 5.00 V ({enough}); 5% stick"


def test_the_page_before_the_end_brings_no_warning():
    """Snakemake warns where a file came that no job of its plan had made."""
    logger, heard = logging.Logger("snakemake"), []
    handler = logging.Handler()
    handler.emit = heard.append
    logger.addHandler(handler)
    snakemake = SimpleNamespace(dryrun=False, output_settings=SimpleNamespace(verbose=False))
    speak(snakemake, logger, Costs(load_scene("paper"), {}), "nothing to do", 12)
    for rule in ("report", "answer"):
        logger.warning(
            f"Warning: the following output files of rule {rule} were not present when the DAG was"
            " created:"
        )
    assert [" of rule answer " in record.getMessage() for record in heard] == [True]


def test_nothing_to_do_names_the_report(capsys):
    terminal = Terminal(
        SimpleNamespace(dryrun=False), OneSecondEach(), "nothing to do; the report is there", 12
    )
    terminal.emit(
        logging.makeLogRecord({"msg": "Nothing to be done (all requested files are present)."})
    )
    assert capsys.readouterr().err == "nothing to do; the report is there\n"


def test_a_job_that_the_system_ended_is_named(capsys, tmp_path):
    terminal = Terminal(SimpleNamespace(dryrun=False), OneSecondEach(), "nothing to do", 12)
    killed, failed = tmp_path / "killed.log", tmp_path / "failed.log"
    killed.write_text("  compute_runs 000: 20%\n")
    failed.write_text("ERROR compute_runs 001: the reason\n")
    for log in (killed, failed):
        send(terminal, "job_error", rule_name="compute_runs", log=[str(log)])
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(
        "ERROR compute_runs: ended by the system without a word, probably out of memory"
    )


def test_a_script_that_cannot_start_is_not_taken_for_missing_memory(capsys, tmp_path):
    terminal = Terminal(SimpleNamespace(dryrun=False), OneSecondEach(), "nothing to do", 12)
    send(terminal, "job_error", rule_name="compute_runs", log=[str(tmp_path / "none.log")])
    assert "ERROR compute_runs: ended before it began" in capsys.readouterr().err


def test_a_full_disk_is_not_taken_for_missing_memory(capsys, monkeypatch):
    monkeypatch.setattr("workflow.run.progress.disk_usage", lambda folder: SimpleNamespace(free=0))
    terminal = Terminal(SimpleNamespace(dryrun=False), OneSecondEach(), "nothing to do", 12)
    send(terminal, "job_error", rule_name="compute_runs", log=[])
    assert capsys.readouterr().err.startswith("ERROR compute_runs: no space left on the disk of ")


def test_costs_grow_with_what_a_job_does(tmp_path):
    paper = load_scene("paper")
    coarse = paper.model_copy(update={"contact": paper.contact.model_copy(update={"pixels": 512})})
    small, large = (Costs(scene, {"a": 7.0}, tmp_path / "none.json") for scene in (coarse, paper))
    assert large.seconds("compute_runs", {}) > 2 * small.seconds("compute_runs", {})
    assert large.seconds("run_closing", {"run": "a"}) == 7
    assert small.seconds("no_such_rule", {}) < 10


BRIDGE = {
    "length_um": 300.0,
    "width_um": 100.0,
    "thickness_um": 1.0,
    "gap_um": 1.5,
    "youngs_modulus_GPa": 70.3,
    "residual_stress_MPa": 40.0,
    "dielectric_nm": 150.0,
    "permittivity": 7.0,
    "hold_voltage_V": 35.0,
}


def test_pads_cost_by_their_cells_points_and_device(tmp_path):
    contact = {
        "mechanics": "coupled",
        "attraction": "offset",
        "pixels": 512,
        "q1_per_nm": 0.5,
    }
    stated = {"extends": "table1", "contact": contact, "device": BRIDGE}
    plate = stated | {"device": {"spring_N_per_m": 800.0}}
    small = stated | {"pad": {"cells": 16, "points": 40, "point_cells": 4}}

    def seconds(content, rule, **wildcards):
        scene = Scene.model_validate(content)
        return Costs(scene, {}, tmp_path / "none.json").seconds(rule, wildcards)

    # 46 s and 14 s of a busy core were measured, about twice those of an idle one
    assert 20.0 < seconds(stated, "press_pads", chunk="000") < 46.0
    assert 7.0 < seconds(small, "press_pads", chunk="000") < 28.0
    assert seconds(plate, "press_pads", chunk="000") > 4 * seconds(
        stated, "press_pads", chunk="000"
    )
    assert seconds(small, "answer") < 0.6 * seconds(stated, "answer")
    assert seconds(stated, "press_pads", chunk="central") < 20.0


def test_a_plan_learns_from_what_jobs_took(tmp_path):
    paper, times = load_scene("paper"), tmp_path / ".snakemake/times.json"
    costs = Costs(paper, {}, times)
    guess, at_first = costs.seconds("uncertainty", {}), costs.seconds("topography", {})
    for _ in range(100):  # a machine of a third of the speed, long enough to be believed
        costs.learn("uncertainty", {}, 3 * guess)
    later = Costs(paper, {}, times)
    assert later.seconds("uncertainty", {}) == pytest.approx(3 * guess)
    assert later.known(["uncertainty"])
    # what has not run here is as slow as the rest
    assert later.seconds("topography", {}) == pytest.approx(3 * at_first, rel=0.2)
    assert not later.known(["uncertainty", "topography"])
    other = Costs(load_scene("ci"), {}, times)
    assert other.seconds("uncertainty", {}) == guess


SHAPES = [
    "{",
    "[]",
    "3",
    "null",
    "[" * 100_000,
    '{"uncertainty": [3, 4]}',
    '{"paper": 1}',
    '{"paper": {"uncertainty": {"1": 2}}}',
]
PAIRS = ["[1]", '["x", 2]', "[1, 0]", "[NaN, 1]", "[-1, 1]", "[1e999, 1]", "null"]


@pytest.mark.parametrize(
    "content", [*SHAPES, *(f'{{"paper": {{"uncertainty": {pair}}}}}' for pair in PAIRS)]
)
def test_times_of_another_shape_are_forgotten(tmp_path, content):
    times, paper = tmp_path / "times.json", load_scene("paper")
    times.write_text(content)
    assert Costs(paper, {}, times).seconds("uncertainty", {}) == Costs(
        paper, {}, tmp_path / "none.json"
    ).seconds("uncertainty", {})
    times.write_bytes(b"\xff\x00")
    assert not Costs(paper, {}, times).known(["uncertainty"])


def test_what_takes_the_time_is_named_with_what_to_do():
    said = refusal({"compute_direct_runs": 36000.0, "law": 2.0}, 18000.0, 2, 4)
    assert said.startswith(
        "jobs compute_direct_runs take 10 of the 10 hours of one core, 5 hours on 2, "
    )
    assert "a run on one machine may take 4; ask for less, allow it (--hours 6, " in said
    assert refusal({"compute_direct_runs": 36000.0}, 18000.0, 2, 100) == ""


def test_jobs_side_by_side_take_no_less_than_the_longest():
    assert wall_seconds(dict.fromkeys(range(4), 1.0), dict.fromkeys(range(4), ()), cores=2) == 2
    assert wall_seconds({1: 5.0, 2: 1.0}, {1: (), 2: ()}, cores=2) == 5
    assert wall_seconds({}, {}, cores=2) == 0


def test_jobs_wait_for_what_they_need():
    seconds, chain = {1: 1.0, 2: 2.0, 3: 3.0, 4: 4.0}, {1: [], 2: [1], 3: [2, 99], 4: []}
    assert wall_seconds(seconds, chain, cores=2) == 6
    assert wall_seconds(seconds, chain, cores=1) == 10


def test_durations_as_people_say_them():
    assert [duration(seconds) for seconds in (0.2, 8, 89, 160, 720, 9000)] == [
        "1 s",
        "8 s",
        "89 s",
        "2 min 40 s",
        "12 min",
        "2.5 h",
    ]
