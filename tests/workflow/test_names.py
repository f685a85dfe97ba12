"""One name a stage: target, rule file, results, room, page, section of the report, tests."""

import re
from pathlib import Path

import pytest

from asperity.__main__ import targets
from asperity.guards.bundle import ROOT
from evidence.__main__ import RENAMED, studies
from evidence.record import DATA, ended
from workflow.files.results import write_text
from workflow.report.stages import PARTS
from workflow.scene.renamed import MOVED, SCENES, STAGES, TAILS, place_now

NAMES = (
    "hardness",
    "elastic",
    "topography",
    "inputs",
    "contact",
    "law",
    "uncertainty",
    "pad",
    "answer",
    "failure",
    "circuit",
    "humidity",
    "history",
    "lifetime",
    "calibration",
)
OF_ALL_STAGES = {"accuracy", "stability", "report"}
ALIASES = {"sensitivity"}
OTHER_FILES = {  # results that stand in no folder of their stage
    "inputs": {"inputs.csv"},
}
PARTS_OF_ROOMS = {"humidity": "answer", "lifetime": "charging"}
"""Stages that are a module of a room, not a room."""
OTHER_ROOMS_OF_EVIDENCE = {"attacks", "predictions", "switch"}
"""The door, all stages together, and a room of `mesoscale` that no stage has the name of."""
PARTS_OF_PAGE = {"budget": "answer", "sensitivity": "uncertainty"}
"""Sections beside that of their stage."""


def rule_file(stage: str) -> str:
    """The text of a stage's rule file."""
    return (ROOT / "workflow/rules" / f"{stage}.smk").read_text(encoding="utf-8")


def outputs(rules: str) -> set[str]:
    """Results that the rules of a file write, inside `results/<scene>/`."""
    blocks = re.findall(r"^ +output:\n(.*?)^ +log:", rules, re.MULTILINE | re.DOTALL)
    return {path for block in blocks for path in re.findall(r'\{RESULTS\}/([^"]+)"', block)}


def test_targets_are_the_stages():
    assert set(targets()) == {*NAMES, *OF_ALL_STAGES, *ALIASES}


def test_each_stage_has_a_rule_file_and_nothing_else_has():
    files = {path.stem for path in (ROOT / "workflow/rules").glob("*.smk")}
    assert files == {*NAMES, "common", "studies", "report"}


@pytest.mark.parametrize("stage", NAMES)
def test_the_target_of_a_stage_stands_in_its_rule_file_and_writes_to_its_folder(stage):
    rules = rule_file(stage)
    assert re.search(rf"^rule {stage}:$", rules, re.MULTILINE)
    written = outputs(rules) - OTHER_FILES.get(stage, set())
    assert {path.partition("/")[0] for path in written} <= {stage}


@pytest.mark.parametrize("stage", NAMES)
def test_a_stage_has_a_room_with_tests(stage):
    room = PARTS_OF_ROOMS.get(stage, stage)
    (package,) = (name for name in ("atomistic", "mesoscale") if (ROOT / name / room).is_dir())
    assert list((ROOT / "tests" / package / room).glob("test_*.py"))
    if room != stage:
        assert (ROOT / package / room / f"{stage}.py").is_file()


@pytest.mark.parametrize("stage", [*NAMES, "report"])
def test_a_stage_has_a_page_that_the_index_lists(stage):
    assert (ROOT / "docs" / f"{stage}.md").is_file()
    index = (ROOT / "docs/index.md").read_text(encoding="utf-8")
    assert re.search(rf"^{stage}$", index, re.MULTILINE)


def test_the_report_has_a_section_a_stage():
    modules = [module.__name__.rpartition(".")[2] for _, _, part in PARTS for module in part]
    assert {name for name in modules if name not in PARTS_OF_PAGE} == set(NAMES)
    assert set(PARTS_OF_PAGE) <= set(modules)
    assert set(PARTS_OF_PAGE.values()) <= set(NAMES)


def test_rooms_of_evidence_have_the_names_of_stages():
    rooms = {name.partition(".")[0] for name in studies()}
    assert rooms <= {*NAMES, *OTHER_ROOMS_OF_EVIDENCE}


def test_every_command_of_a_table_of_evidence_leads_to_a_study():
    known = {*studies(), *ended(), *RENAMED}
    assert set(RENAMED.values()) <= set(studies())
    assert not set(RENAMED) & set(studies())
    for table in DATA.glob("*.csv"):
        commands = re.findall(r"python -m evidence ([\w.]+)", table.read_text(encoding="utf-8"))
        assert {name for name in commands if name not in known} == set(), table.name


def test_names_of_before_lead_to_names_of_now():
    assert set(STAGES.values()) <= set(NAMES)
    assert not set(STAGES) & set(NAMES)
    assert {path.partition("/")[0] for path in MOVED.values()} <= set(NAMES)
    assert set(SCENES.values()) <= {path.stem for path in (ROOT / "config/scenes").glob("*.yaml")}
    assert TAILS == {"pad": "switch"}


@pytest.mark.parametrize(
    ("before", "now"),
    [
        ("uq/outputs.csv", "uncertainty/outputs.csv"),
        ("uq/direct/chunk_000.csv", "uncertainty/direct/chunk_000.csv"),
        ("device/pad_switch.json", "answer/pad_switch.json"),
        ("device/loop.csv", "circuit/loop.csv"),
        ("device/circuit/central.sub", "circuit/models/central.sub"),
        ("curves/runs/chunk_000.h5", "law/runs/chunk_000.h5"),
        ("curves/nominal.h5", "contact/nominal.h5"),
        ("law/parameters.csv", ""),
        ("inputs.csv", ""),
        ("", ""),
    ],
)
def test_a_result_of_before_has_a_place_now(before, now):
    assert place_now(before) == now


@pytest.mark.parametrize(
    ("target", "words"),
    [
        ("uq", "`uq` is `uncertainty` since 0.3.0"),
        (
            "results/paper/device/failure.json",
            "`results/paper/device/failure.json` is `results/paper/failure/failure.json` since"
            " 0.3.0",
        ),
    ],
)
def test_a_target_of_before_gives_one_line(workflow_in, target, words):
    done = workflow_in.run("paper", target)
    assert done.returncode != 0
    assert done.stderr.splitlines()[-1] == f"ERROR {words}"


def test_a_tail_of_before_gives_one_line(workflow_in):
    (workflow_in.folder / "mine.yaml").write_text("tails: [law, pad]\n")
    done = workflow_in.run("mine.yaml", "inputs")
    (line,) = (line for line in done.stderr.splitlines() if line.startswith("ERROR"))
    assert line == "ERROR mine.yaml: tails: `pad` is `switch` since 0.3.0; write `switch`"


def test_results_of_before_are_told_by_a_line_a_folder_and_stay(workflow_in):
    results = workflow_in.folder / "results/paper"
    old = [results / name for name in ("uq/outputs.csv", "uq/samples.csv", "device/budget.csv")]
    for path in old:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_text(path, "old\n")
    (results / ".scene").write_text("shipped scene paper\n")
    done = workflow_in.run("paper", "inputs")
    assert done.returncode == 0, done.stderr
    said = " ".join(done.stdout.split())
    assert said.count("results/paper/uq is `uncertainty` since 0.3.0") == 1
    assert said.count("results/paper/device is `answer` since 0.3.0") == 1
    assert all(Path(path).read_text() == "old\n" for path in old)
