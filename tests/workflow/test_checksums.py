"""A damaged result is named and made again by a run, never used; a plan changes nothing."""

import os
import subprocess
import time
from types import SimpleNamespace

import pytest

from tests.workflow.conftest import listing
from workflow.files.checksums import UNFINISHED, is_damaged, is_late, record_of, recorded
from workflow.files.results import write_csv, write_text
from workflow.run.job import job


@pytest.fixture
def result(tmp_path):
    path = tmp_path / "law" / "table.csv"
    write_csv(path, [{"d_c_nm": 30.0 + k} for k in range(10)])
    return path


def empty(content):
    return b""


def halve(content):
    return content[: len(content) // 2]


def flip(content):
    return content[:-3] + bytes([content[-3] ^ 1]) + content[-2:]


@pytest.mark.parametrize("damage", [empty, halve, flip])
def test_a_damaged_result_is_known(tmp_path, result, damage):
    assert list(recorded(tmp_path)) == [result]
    assert not is_damaged(result)
    result.write_bytes(damage(result.read_bytes()))
    assert is_damaged(result)


def test_a_job_refuses_a_damaged_input_in_one_line(tmp_path, result, capsys):
    result.write_bytes(halve(result.read_bytes()))
    snakemake = SimpleNamespace(
        rule="propagate",
        wildcards={},
        input=[str(result)],
        params={},
        log=[str(tmp_path / "logs" / "a.log")],
    )
    with pytest.raises(SystemExit), job(snakemake):
        pytest.fail("the job's body ran")
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"ERROR propagate: {result}: damaged")
    assert "run again" in line


def test_files_of_the_user_have_no_checksum_and_are_left_alone(tmp_path):
    scan = tmp_path / "scan.gwy"
    scan.write_bytes(b"")
    assert not is_damaged(scan)
    assert list(recorded(tmp_path)) == []


def test_a_damaged_checksum_is_damage(result):
    record_of(result).write_text("")
    assert is_damaged(result)


def test_a_result_dated_in_the_future_is_known(result):
    assert not is_late(result)
    os.utime(result, (time.time() + 1e6,) * 2)
    assert is_late(result)


def test_a_result_written_again_is_whole(result):
    write_text(result, "new\n")
    assert not is_damaged(result)


def test_the_checksum_is_in_the_format_of_sha256sum(result):
    done = subprocess.run(
        ["sha256sum", "-c", record_of(result).name],
        cwd=result.parent,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stdout == "table.csv: OK\n"


SCENE = """
inputs:
  e_star: {origin: literature, distribution: normal, values: [91, 3.8]}
  h_prime: {origin: literature, values: [1.95, 14.8]}
  q0: {origin: literature, values: [0.015, 0.035]}
  hurst: {origin: literature, values: [0.5, 1.0]}
  rms: {origin: literature, distribution: samples, values: rms.csv}
"""


def test_the_next_run_makes_a_damaged_result_again_and_sees_changed_samples_not_touched_ones(
    workflow_in,
):
    folder = workflow_in.folder / "beside"
    folder.mkdir()
    scene, samples = folder / "mine.yaml", folder / "rms.csv"
    scene.write_text(SCENE)
    # above the megabyte that Snakemake would read
    samples.write_text("rms\n5\n6\n7\n" + "5.5000000\n" * 110_000)
    assert workflow_in.run(str(scene), "inputs").returncode == 0
    inputs = workflow_in.folder / "results/mine/inputs.csv"
    whole = inputs.read_bytes()

    os.utime(samples)
    assert workflow_in.planned(str(scene), "inputs") == {}

    strange = inputs.with_name("\x1b]0;title\x07\u202e\nERROR forged.csv")  # of nobody's rule
    planted = [
        inputs.with_name(name) for name in (".bashrc.original", "notes.csv", ".notes.csv.sha256")
    ]
    planted += [strange, record_of(strange)]
    for path in planted:
        path.write_text("x")
    os.utime(planted[1], (time.time() + 1e6,) * 2)
    inputs.write_bytes(halve(whole))
    before = listing(workflow_in.folder / "results")
    assert "results/mine/inputs.csv: damaged" in workflow_in.plan(str(scene), "inputs")
    assert listing(workflow_in.folder / "results") == before
    unfinished = inputs.with_name(f"{UNFINISHED}12345678.csv")
    unfinished.write_text("x")
    done = workflow_in.run(str(scene), "inputs")
    assert done.returncode == 0, done.stderr
    assert "results/mine/inputs.csv: damaged" in done.stderr
    assert not set(done.stderr) & set("\x1b\x07\u202e")
    assert inputs.read_bytes() == whole
    assert not unfinished.exists()
    after = listing(workflow_in.folder / "results")
    assert {path: after.get(path) for path in planted} == {path: before[path] for path in planted}

    samples.write_text("rms\n5\n6\n8\n")
    assert workflow_in.planned(str(scene), "inputs") == {"inputs": 1}
