"""What a run says: its cost before, a line for each job, the time left."""

import logging
from operator import attrgetter
from types import SimpleNamespace

import pytest

from workflow.scene import load_scene
from workflow.terminal.cost import ENGINE_S, GROWS_BY, START_S, Costs, relative_speed, wall_seconds
from workflow.terminal.progress import Terminal, duration


class OneSecondEach:
    """Costs of a scene in which every job takes a second, but one that nobody has measured."""

    refusal = staticmethod(lambda seconds, wall_s, cores, hours: "too long" if wall_s > 3600 * hours else "")

    def __init__(self):
        self.learned = []

    def seconds(self, rule, wildcards):
        return None if rule == "unheard_of" else 1.0

    def learn(self, rule, wildcards, took):
        self.learned.append(rule)


class Job(SimpleNamespace):
    """A job of a plan, told from others by identity."""

    __hash__ = object.__hash__


def job(name, number=7):
    return Job(rule=SimpleNamespace(name=name, norun=False), wildcards_dict={}, priority=0, jobid=number)


def send(terminal, event, **about):
    record = logging.makeLogRecord({"msg": "", "event": event, **about})
    terminal.emit(record)


@pytest.mark.parametrize("dry", [True, False])
def test_the_plan_comes_first_and_each_job_has_its_line(capsys, dry):
    jobs = [job("fit_law"), job("fit_law", 8), job("unheard_of", 9)]
    dag = SimpleNamespace(needrun_jobs=lambda: jobs, job_dependencies=lambda job: [])
    snakemake = SimpleNamespace(dryrun=dry, local_exec=True, cores=2, dag=dag)
    costs = OneSecondEach()
    terminal = Terminal(snakemake, costs, "nothing to do", 12)
    send(terminal, "run_info")
    send(terminal, "job_info", jobid=7, rule_name="fit_law", rule_msg="fit the law")
    send(terminal, "job_finished", job_id=7)
    said = capsys.readouterr().err
    assert "3 jobs, about 1 s on 2 cores, and unheard_of, whose time nobody has measured" in said
    assert ("fit_law         2        2 s" in said) == dry
    assert ("1 of 3  fit the law (1 s), 1 s left" in said) == (not dry)
    assert costs.learned == ([] if dry else ["fit_law"])


def test_the_time_left_follows_what_jobs_take(capsys, development_machine, monkeypatch, tmp_path):
    # a machine of a tenth of the speed: after three jobs of eight seconds the rest is known to a third
    clock, chunks = [0.0], [job("compute_direct_runs", number) for number in range(8)]
    monkeypatch.setattr("workflow.terminal.progress.time.monotonic", lambda: clock[0])
    dag = SimpleNamespace(needrun_jobs=lambda: chunks, job_dependencies=lambda job: [])
    snakemake = SimpleNamespace(dryrun=False, local_exec=True, cores=1, dag=dag)
    costs = Costs(load_scene("paper"), {}, tmp_path / "none.json")
    takes = 10 * costs.seconds("compute_direct_runs", {})
    terminal = Terminal(snakemake, costs, "nothing to do", 12)
    wall_s = terminal._wall_s
    send(terminal, "run_info")
    for number in range(3):
        send(terminal, "job_info", jobid=number, rule_name="compute_direct_runs", rule_msg="compute")
        clock[0] += takes
        send(terminal, "job_finished", job_id=number)
    assert wall_s() == pytest.approx(5 * takes, rel=1 / 3)
    send(terminal, "job_info", jobid=3, rule_name="compute_direct_runs", rule_msg="compute")
    left = wall_s()
    clock[0] += takes / 2  # a job at work is counted by what is left of it
    assert wall_s() == pytest.approx(left - takes / 2)
    assert capsys.readouterr().err.count(" left") == 3


@pytest.mark.parametrize(("local", "hours", "refusal"), [(True, 12, ""), (True, 1e-4, "too long"), (False, 1e-4, "")])
def test_a_run_that_is_too_long_is_refused_unless_a_cluster_takes_it(local, hours, refusal):
    dag = SimpleNamespace(needrun_jobs=lambda: [job("fit_law")], job_dependencies=lambda job: [])
    snakemake = SimpleNamespace(dryrun=False, local_exec=local, cores=2, dag=dag)
    terminal = Terminal(snakemake, OneSecondEach(), "nothing to do", hours)
    send(terminal, "run_info")
    assert terminal.refusal == refusal


def test_nothing_to_do_names_the_report(capsys):
    terminal = Terminal(SimpleNamespace(dryrun=False), OneSecondEach(), "nothing to do; the report is there", 12)
    terminal.emit(logging.makeLogRecord({"msg": "Nothing to be done (all requested files are present)."}))
    assert capsys.readouterr().err == "nothing to do; the report is there\n"


def test_a_job_that_the_system_ended_is_named(capsys, tmp_path):
    terminal = Terminal(SimpleNamespace(dryrun=False), OneSecondEach(), "nothing to do", 12)
    killed, failed = tmp_path / "killed.log", tmp_path / "failed.log"
    killed.write_text("  compute_runs 000: 20%\n")
    failed.write_text("ERROR compute_runs 001: the reason\n")
    for log in (killed, failed):
        send(terminal, "job_error", rule_name="compute_runs", log=[str(log)])
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("ERROR compute_runs: ended by the system without a word, probably out of memory")


def test_a_script_that_cannot_start_is_not_taken_for_missing_memory(capsys, tmp_path):
    terminal = Terminal(SimpleNamespace(dryrun=False), OneSecondEach(), "nothing to do", 12)
    send(terminal, "job_error", rule_name="compute_runs", log=[str(tmp_path / "none.log")])
    assert "ERROR compute_runs: ended before it began" in capsys.readouterr().err


def test_a_full_disk_is_not_taken_for_missing_memory(capsys, monkeypatch):
    monkeypatch.setattr("workflow.terminal.progress.disk_usage", lambda folder: SimpleNamespace(free=0))
    terminal = Terminal(SimpleNamespace(dryrun=False), OneSecondEach(), "nothing to do", 12)
    send(terminal, "job_error", rule_name="compute_runs", log=[])
    assert capsys.readouterr().err.startswith("ERROR compute_runs: no space left on the disk of ")


@pytest.fixture
def development_machine(monkeypatch):
    monkeypatch.setattr("workflow.terminal.cost.relative_speed", lambda: 1.0)


def test_costs_grow_with_what_a_job_does(development_machine, tmp_path):
    paper = load_scene("paper")
    coarse = paper.model_copy(update={"contact": paper.contact.model_copy(update={"pixels": 512})})
    small, large = (Costs(scene, {}, tmp_path / "none.json") for scene in (coarse, paper))
    start = START_S + ENGINE_S
    assert large.seconds("compute_runs", {}) - start > 2 * (small.seconds("compute_runs", {}) - start)
    assert small.seconds("no_such_rule", {}) is None


def test_a_plan_learns_from_what_jobs_took(development_machine, tmp_path):
    paper, times = load_scene("paper"), tmp_path / ".snakemake/times.json"
    costs = Costs(paper, {}, times)
    guess, at_first = costs.seconds("fit_law", {}), costs.seconds("pool_spectra", {})
    for _ in range(round(1000 / guess)):  # a machine of a third of the speed, long enough to be believed
        costs.learn("fit_law", {}, 3 * guess)
    later = Costs(paper, {}, times)
    assert later.seconds("fit_law", {}) == pytest.approx(3 * guess, rel=0.1)
    # what has not run here is as slow as the rest
    assert later.seconds("pool_spectra", {}) == pytest.approx(3 * at_first, rel=0.2)
    times.write_text("{")  # a run was killed while it wrote
    assert Costs(paper, {}, times).seconds("fit_law", {}) == guess


def test_what_takes_the_time_is_named_with_its_key_and_number(development_machine, tmp_path):
    paper = load_scene("paper")
    million = paper.uncertainty.model_copy(update={"direct_runs": 10**6})
    costs = Costs(paper.model_copy(update={"uncertainty": million}), {}, tmp_path / "none.json")
    hours = 10**4 * costs.seconds("compute_direct_runs", {}) / 3600
    assert 10 < hours < 100
    said = costs.refusal({"compute_direct_runs": hours * 3600, "fit_law": 2.0}, hours * 1800, 2, 5)
    assert said.startswith("uncertainty.direct_runs = 1000000: takes ")
    assert "hours on 2, and a run on one machine may take 5; ask for less, allow it (--hours " in said
    assert costs.refusal({"compute_direct_runs": hours * 3600}, hours * 1800, 2, 100) == ""


def test_the_keys_that_are_named_are_keys_of_a_scene():
    for key in GROWS_BY.values():
        attrgetter(key)(load_scene("reduced"))


def test_jobs_side_by_side_take_no_less_than_the_longest():
    alone = [[], [], [], []]
    assert wall_seconds([1.0, 1.0, 1.0, 1.0], alone, cores=2) == 2.0
    assert wall_seconds([5.0, 1.0], alone[:2], cores=2) == 5.0


def test_jobs_wait_for_what_they_need():
    chain = [[], [0], [1], []]
    assert wall_seconds([1.0, 2.0, 3.0, 4.0], chain, cores=2) == 6.0
    assert wall_seconds([1.0, 2.0, 3.0, 4.0], chain, cores=1) == 10.0
    assert wall_seconds([1.0, 1.0, 5.0], [[], [], [0, 1]], cores=2) == 6.0


def test_the_longest_jobs_go_first_where_they_have_priority():
    alone = [[], [], []]
    assert wall_seconds([1.0, 1.0, 4.0], alone, cores=2) == 5.0
    assert wall_seconds([1.0, 1.0, 4.0], alone, cores=2, priorities=[0, 0, 1]) == 4.0


def test_speed_is_a_positive_number():
    assert 0.01 < relative_speed() < 100


def test_durations_as_people_say_them():
    assert [duration(seconds) for seconds in (0.2, 8, 89, 160, 720, 9000)] == [
        "1 s",
        "8 s",
        "89 s",
        "2 min 40 s",
        "12 min",
        "2.5 h",
    ]
