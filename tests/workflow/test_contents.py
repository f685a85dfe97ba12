"""Results follow the content of every file that a scene names, whatever its date; a touched file
renews nothing.
"""

import ast
import json
import os
import re
import shutil
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from mesoscale.topography.measurements.cleaning import Scan
from mesoscale.topography.measurements.loading import write_gwy
from workflow.files import checksums
from workflow.files.checksums import UNREADABLE, content_checksums, file_checksum
from workflow.run.changed_files import changed_files, renewed_by
from workflow.scene import Scene

ROOT = Path(__file__).resolve().parents[2]
LONG_AGO = 1_500_000_000

# Keys of a scene that hold text. The first have paths, and `renewed` has a file for each of them.
PATHS = {
    "extends",
    "topography.scans",
    "hardness.potential",
    "measurements.tables.file",
    "inputs.values",
    "device.spread.values",
}
# names of shipped files of materials, whose content counts, too
MATERIALS = {
    "hardness.material",
    "hardness.base",
    "elastic.material",
    "elastic.counter_body",
    "elastic.crystals",
}
OTHER_TEXT = {
    "name",
    "inputs.source",
    "inputs.correlations",
    "device.spread.source",
    "measurements.tables.source",
    "hardness.asperities.name",
    "topography.instruments.files",
    "topography.instruments.channel",
    "topography.channel",
}

SCENE = """
extends: parent.yaml
tails: [law]
topography: {scans: [alone.gwy, film]}
measurements: {tables: [{kind: release, file: volts.csv}]}
inputs:
  hamaker: {origin: literature, distribution: samples, values: hamaker.csv}
device: {spread: {gap_um: {distribution: samples, values: gaps.csv, relative: true}}}
"""
FILES = {  # a rule that reads each, and one that must not run again
    "alone.gwy": ("analyse_scans", "make_glass"),
    "film/second.gwy": ("analyse_scans", "make_glass"),
    "mine_potential.yaml": ("make_glass", "analyse_scans"),
    "volts.csv": ("calibration", "inputs"),
    "hamaker.csv": ("inputs", "make_glass"),
    "gaps.csv": ("press_prior_pads", "inputs"),
}


def map_of(seed):
    return Scan(np.random.default_rng(seed).standard_normal((64, 64)), (1000.0, 1000.0), "map")


def change(path):
    """Other content of the same kind under the same name, of an older date."""
    if path.suffix == ".gwy":
        write_gwy(path, map_of(7))
    else:
        path.write_text(
            path.read_text()
            .replace("0.2", "0.3")
            .replace("12,", "13,")
            .replace("source:", "source:  ")
        )
    os.utime(path, (LONG_AGO, LONG_AGO))


@pytest.fixture(scope="module")
def finished(make_workflow, tmp_path_factory):
    """A scene that names a file of every kind, and empty results that count as made of them."""
    folder = tmp_path_factory.mktemp("contents")
    (folder / "film").mkdir()
    write_gwy(folder / "alone.gwy", map_of(1))
    write_gwy(folder / "film/second.gwy", map_of(2))
    shutil.copy(ROOT / "config/potentials/pmmcs.yaml", folder / "mine_potential.yaml")
    (folder / "parent.yaml").write_text("hardness: {potential: mine_potential.yaml}\n")
    (folder / "volts.csv").write_text("release_V,release_error_V\n12,0.5\n")
    (folder / "hamaker.csv").write_text("hamaker\n0.1\n0.2\n0.4\n")
    (folder / "gaps.csv").write_text("gap_um\n-0.1\n0.0\n0.2\n")
    scene = folder / "mine.yaml"
    scene.write_text(SCENE)
    workflow = make_workflow(folder)
    summary = workflow.run(str(scene), options=("--summary",)).stdout.splitlines()
    made = [folder / line.split("\t")[0] for line in summary[1:]]
    for path in made:
        path.parent.mkdir(parents=True, exist_ok=True)
        if path.suffix:
            path.touch()
        else:
            path.mkdir()
    (folder / "results/mine/.scene").write_text(f"{scene}\n")
    workflow.run(str(scene), options=("--touch", "--forceall"))
    return workflow, str(scene)


def test_every_input_that_no_job_makes_is_followed_by_its_content(finished):
    """From what Snakemake records of each result: its inputs, and the parameters that it
    compares.
    """
    workflow, _ = finished
    recorded = [
        json.loads(path.read_text()) for path in (workflow.folder / ".snakemake/metadata").iterdir()
    ]
    assert len(recorded) > 100
    read = set()
    for result in recorded:
        sources = {path for path in result["input"] if not path.startswith("results/")}
        followed = {}
        for text in result["params"]:
            if (
                "'mine" in text
                or ".gwy'" in text
                or ".csv'" in text
                or ".yaml'" in text
                or ".css'" in text
            ):
                value = ast.literal_eval(text)
                followed |= value if isinstance(value, dict) and sources & value.keys() else {}
        assert sources == followed.keys(), result["rule"]
        read |= sources
    named = {Path(name).name for name in FILES} - {"gaps.csv"}  # which settings name, and no rule
    assert {Path(path).name for path in read} >= named | {
        "silicon_dioxide.yaml",
        "silicon_nitride.yaml",
        "style.css",
    }


def test_touched_files_renew_nothing(finished):
    workflow, scene = finished
    for name in FILES:
        os.utime(workflow.folder / name)
    assert "nothing to do" in workflow.plan(scene)


@pytest.mark.parametrize("name", FILES)
def test_another_content_of_an_older_date_renews_what_reads_it(finished, name):
    workflow, scene = finished
    path = workflow.folder / name
    before = path.read_bytes()
    reader, other = FILES[name]
    try:
        change(path)
        assert path.read_bytes() != before
        said = workflow.plan(scene).splitlines()
    finally:
        path.write_bytes(before)
    lines = [line for line in said if not line.startswith("Using workflow")]
    begin, _, renewed = " ".join(" ".join(lines).split()).partition("; renews ")
    assert begin == f"{name}: changed since results were made of it"
    assert reader in renewed.partition(" (jobs")[0].split(", ")
    assert " about " in " ".join(lines[:3])
    jobs = workflow.jobs("\n".join(said))
    assert jobs.keys() >= {reader, "report"}
    assert other not in jobs


def test_files_that_are_as_they_were_again_renew_nothing(finished):
    """After the tests above."""
    workflow, scene = finished
    assert "nothing to do" in workflow.plan(scene)


def test_keys_of_an_included_scene_count_whatever_its_date(finished):
    workflow, scene = finished
    parent = workflow.folder / "parent.yaml"
    before = parent.read_text()
    try:
        parent.write_text(before + "# a note\n")
        assert "nothing to do" in workflow.plan(scene)
        parent.write_text(before + "elastic: {seed: 77}\n")
        os.utime(parent, (LONG_AGO, LONG_AGO))
        assert "make_amorphous" in workflow.planned(scene)
    finally:
        parent.write_text(before)


def texts(model, place=""):
    """Names of the fields of settings that hold text, those of lists and mappings too."""
    for name, field in model.model_fields.items():
        yield from texts_of(field.annotation, f"{place}{name}")


def texts_of(annotation, place):
    if annotation is str:
        yield place
    if isinstance(annotation, type) and hasattr(annotation, "model_fields"):
        rows = re.match(r"inputs\.|device\.spread\.", place)  # one class for all rows of these
        yield from texts(annotation, rows[0] if rows else f"{place}.")
    for part in getattr(annotation, "__args__", ()):
        yield from texts_of(part, place)


def test_every_key_that_may_hold_a_path_is_in_one_of_the_lists():
    assert set(texts(Scene)) == PATHS | MATERIALS | OTHER_TEXT


def test_a_file_is_read_again_only_where_size_dates_or_inode_changed(tmp_path, monkeypatch):
    path, remembered = tmp_path / "scan.gwy", tmp_path / "cache" / "contents.json"
    path.write_bytes(b"first")
    monkeypatch.setattr(checksums, "SETTLED_S", -1e9)  # written just now
    read = []

    def counted(path):
        read.append(str(path))
        return file_checksum(path)

    monkeypatch.setattr(checksums, "file_checksum", counted)
    first = content_checksums([path], remembered)
    assert first == content_checksums([path], remembered) == {str(path): file_checksum(path)}
    assert len(read) == 1
    date = path.stat().st_mtime_ns
    path.write_bytes(b"other")  # of the same size
    os.utime(path, ns=(date, date))
    assert content_checksums([path], remembered) != first
    assert len(read) == 2


def test_a_file_that_changed_just_now_is_read_again(tmp_path):
    """A second change within the tick of a clock would have the same dates."""
    path, remembered = tmp_path / "scan.gwy", tmp_path / "contents.json"
    path.write_bytes(b"first")
    content_checksums([path], remembered)
    assert not remembered.exists()


@pytest.mark.parametrize("content", ["", "[1]", "{", '{"x": 3}', "\xff"])
def test_a_damaged_memory_of_checksums_is_none(tmp_path, content):
    path, remembered = tmp_path / "scan.gwy", tmp_path / "contents.json"
    path.write_bytes(b"first")
    remembered.write_text(content, encoding="latin-1")
    assert content_checksums([path], remembered) == {str(path): file_checksum(path)}


def test_a_file_that_cannot_be_read_is_left_to_its_job(tmp_path):
    assert content_checksums([tmp_path / "gone.gwy"], tmp_path / "c.json") == {
        str(tmp_path / "gone.gwy"): UNREADABLE
    }


def test_the_jobs_that_wait_for_a_reader_are_renewed():
    assert renewed_by([2], {1: [], 2: [1], 3: [2], 4: [3, 1], 5: [1]}) == {2, 3, 4}


def test_files_that_are_new_to_a_result_did_not_change():
    now = {"a.gwy": "1" * 64, "b.gwy": "2" * 64}
    made_of = {"a.gwy": "0" * 64, "c.gwy": "3" * 64}
    reader = SimpleNamespace(jobid=4, output=["x.h5"], params=[now, "text"])
    settings = repr({"detrend": "auto", "limit": float("inf"), "scans": ["a.gwy"]})
    assert changed_files([reader], lambda result: [settings, repr(made_of)]) == {"a.gwy": {4}}
    assert changed_files([reader], lambda result: None) == {}
