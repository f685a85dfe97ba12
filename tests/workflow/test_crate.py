"""A run packed as a crate: its files, what it says, what is refused, and the validator's word."""

import json
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from asperity.guards.bundle import ROOT
from tests.workflow.made_up_results import write_all
from workflow.crate import _stage_of, main
from workflow.files.checksums import file_checksum, record_of

pytest.importorskip("rocrate", reason="optional extra crate is not installed")
SCENE = """extends: table1
name: tiny
inputs: {rms: {distribution: samples, values: data/rms.csv, source: made up}}
"""


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    """A folder with a scene, a file that it names and made-up results."""
    folder = tmp_path_factory.mktemp("crate")
    (folder / "tiny.yaml").write_text(SCENE)
    (folder / "data").mkdir()
    (folder / "data/rms.csv").write_text("rms\n" + "4.0\n5.0\n" * 20)
    write_all(folder / "results/tiny")
    times = folder / ".snakemake/asperity_seconds.json"
    times.parent.mkdir()
    times.write_text('{"tiny": {"press_pads": [12.5, 3.0], "pad": [1.5, 1.0]}}')
    return folder


@pytest.fixture
def here(ran, tmp_path, monkeypatch):
    """A copy of it, as the working folder."""
    shutil.copytree(ran, tmp_path / "here")
    monkeypatch.chdir(tmp_path / "here")
    return tmp_path / "here"


@pytest.fixture
def packed(here):
    """The crate of the scene."""
    assert main(["tiny.yaml"]) == 0
    return here / "tiny.crate.zip"


def entities_of(crate: Path) -> dict[str, dict]:
    with zipfile.ZipFile(crate) as archive:
        graph = json.loads(archive.read("ro-crate-metadata.json"))["@graph"]
    return {entity["@id"]: entity for entity in graph}


def changed(crate: Path, name: str, content: bytes | None) -> Path:
    """A copy of a crate with another file of this name, or none."""
    copy = crate.with_name("changed.crate.zip")
    with zipfile.ZipFile(crate) as old, zipfile.ZipFile(copy, "w") as new:
        for entry in old.namelist():
            if entry != name:
                new.writestr(entry, old.read(entry))
        if content is not None:
            new.writestr(name, content)
    return copy


def test_a_crate_holds_scene_inputs_and_all_results(packed, here):
    with zipfile.ZipFile(packed) as archive:
        assert archive.read("tiny.yaml").decode() == SCENE
        assert archive.read("data/rms.csv") == (here / "data/rms.csv").read_bytes()
        in_crate = {name for name in archive.namelist() if name.startswith("computed/")}
    results = here / "results/tiny"
    files = [path for path in results.rglob("*") if path.is_file() and path.name[0] != "."]
    assert in_crate == {f"computed/{path.relative_to(results)}" for path in files}
    entity = entities_of(packed)["computed/pad/curves.csv"]
    assert entity["sha256"] == file_checksum(results / "pad/curves.csv")


def test_each_stage_is_a_step_with_its_results_and_its_time(packed):
    entities = entities_of(packed)
    made = entities["#job-pad"]["result"]
    assert made == {"@id": "computed/pad/curves.csv"} or {"@id": "computed/pad/curves.csv"} in made
    seconds = {
        entities[usage["@id"]]["name"]: float(entities[usage["@id"]]["value"])
        for usage in entities["#job-pad"]["resourceUsage"]
    }
    assert seconds == {
        "wall seconds of rule press_pads": 12.5,
        "wall seconds of rule pad": 1.5,
    }
    assert "resourceUsage" not in entities["#job-contact"], "not recorded"
    steps = [reference["@id"] for reference in entities["workflow/Snakefile"]["step"]]
    assert "#step-pad" in steps
    assert entities["#numpy"]["softwareVersion"] == "2.4"


@pytest.mark.parametrize(
    ("place", "stage"),
    [
        ("inputs.csv", "inputs"),
        ("pad/inputs.csv", "pad"),
        ("report.html", "report"),
        ("figures/law.svg", "report"),
        ("scene.yaml", "report"),
    ],
)
def test_a_result_belongs_to_its_stage(place, stage):
    assert _stage_of(Path(place)) == stage


def test_a_crate_as_it_was_written_passes(packed, capsys):
    assert main([str(packed)]) == 0
    assert "as they were written" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("computed/pad/curves.csv", b"other", "computed/pad/curves.csv: was changed"),
        ("tiny.yaml", None, "tiny.yaml: is missing"),
        ("computed/more.csv", b"a,b\n", "computed/more.csv: was added"),
        ("ro-crate-metadata.json", None, "no crate of a run"),
        ("ro-crate-metadata.json", b"[1]", "no crate of a run"),
    ],
)
def test_a_changed_crate_is_refused_in_one_line(packed, capsys, name, content, says):
    assert main([str(changed(packed, name, content))]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert says in line


def test_a_file_that_is_no_archive_is_refused_in_one_line(here, capsys):
    Path("plain.zip").write_text("plain")
    assert main(["plain.zip"]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert "no sound zip archive" in line


def test_a_scene_that_has_not_run_is_refused_in_one_line(here, capsys):
    Path("bare.yaml").write_text("extends: table1\nname: bare\n")
    assert main(["bare.yaml"]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert "asperity run bare.yaml" in line


def test_a_damaged_result_is_not_packed(here, capsys):
    curves = here / "results/tiny/pad/curves.csv"
    assert record_of(curves).is_file()
    curves.write_text("damaged")
    assert main(["tiny.yaml"]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert "curves.csv: differs from its checksum" in line
    assert not Path("tiny.crate.zip").exists()


def test_an_input_from_elsewhere_is_refused_in_one_line(here, capsys):
    scene = SCENE.replace("data/rms.csv", str(here / "data/rms.csv"))
    Path("tiny.yaml").write_text(scene)
    assert main(["tiny.yaml"]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert "lies elsewhere" in line


def validated(folder: Path) -> subprocess.CompletedProcess[str]:
    """What the validator says of an unpacked crate."""
    validator = shutil.which("rocrate-validator")
    if validator is None:
        pytest.skip("rocrate-validator is not on the path; .ci/crate installs it for this test")
    python = Path(validator).with_name("python")
    script = ROOT / "tests/workflow/crate_validator.py"
    return subprocess.run([python, script, folder], capture_output=True, text=True, check=False)


def test_the_validator_passes_a_crate_and_refuses_one_without_steps(packed, tmp_path):
    """All required checks of Provenance Run Crate 0.5, with contexts that are written down."""
    folder = tmp_path / "crate"
    with zipfile.ZipFile(packed) as archive:
        archive.extractall(folder)
    done = validated(folder)
    assert done.returncode == 0, done.stdout + done.stderr
    metadata = folder / "ro-crate-metadata.json"
    content = json.loads(metadata.read_text())
    for entity in content["@graph"]:
        entity.pop("step", None)
    metadata.write_text(json.dumps(content))
    assert "HowToStep must be referred to" in validated(folder).stdout


def test_a_receiver_reads_the_scene_of_a_crate(packed, tmp_path, monkeypatch):
    """Unpacked anywhere, its scene is one that runs there."""
    with zipfile.ZipFile(packed) as archive:
        archive.extractall(tmp_path / "received")
    monkeypatch.chdir(tmp_path / "received")
    listed = subprocess.run(
        [sys.executable, "-m", "asperity", "plan", "tiny.yaml", "inputs"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert listed.returncode == 0, listed.stdout + listed.stderr
