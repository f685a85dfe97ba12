"""A damaged result is named, removed and made again; it is never used."""

import os
import subprocess
import time
from types import SimpleNamespace

import pytest

from workflow.checksums import is_damaged, record_of, redate, remove_damaged
from workflow.job import job
from workflow.results import write_csv, write_text


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
def test_a_damaged_result_is_removed_and_named(tmp_path, result, damage):
    assert remove_damaged(tmp_path) == []
    result.write_bytes(damage(result.read_bytes()))
    assert remove_damaged(tmp_path) == [result]
    assert list(result.parent.iterdir()) == []


def test_a_job_refuses_a_damaged_input_in_one_line(tmp_path, result, capsys):
    result.write_bytes(halve(result.read_bytes()))
    snakemake = SimpleNamespace(
        rule="propagate", wildcards={}, input=[str(result)], params={}, log=[str(tmp_path / "logs" / "a.log")]
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
    assert remove_damaged(tmp_path) == []
    assert scan.exists()


def test_the_checksum_of_a_file_that_is_gone_goes_too(result):
    result.unlink()
    assert remove_damaged(result.parent) == []
    assert list(result.parent.iterdir()) == []


def test_a_damaged_checksum_makes_its_result_again(result):
    record_of(result).write_text("")
    assert remove_damaged(result.parent) == [result]


def test_a_result_dated_in_the_future_is_dated_now(tmp_path, result):
    os.utime(result, (time.time() + 1e6,) * 2)
    assert redate(tmp_path) == [result]
    assert result.stat().st_mtime <= time.time()
    assert redate(tmp_path) == []


def test_a_result_written_again_is_whole(result):
    write_text(result, "new\n")
    assert not is_damaged(result)


def test_the_checksum_is_in_the_format_of_sha256sum(result):
    done = subprocess.run(
        ["sha256sum", "-c", record_of(result).name], cwd=result.parent, capture_output=True, text=True, check=False
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


def test_the_next_run_makes_a_damaged_result_again_and_sees_a_changed_file_of_samples(workflow_in):
    folder = workflow_in.folder / "beside"
    folder.mkdir()
    scene, samples = folder / "mine.yaml", folder / "rms.csv"
    scene.write_text(SCENE)
    samples.write_text("rms\n5\n6\n7\n")
    assert workflow_in.run(str(scene), "inputs").returncode == 0
    inputs = workflow_in.folder / "results/mine/inputs.csv"
    whole = inputs.read_bytes()

    inputs.write_bytes(halve(whole))
    done = workflow_in.run(str(scene), "inputs")
    assert done.returncode == 0, done.stderr
    assert "results/mine/inputs.csv: damaged" in done.stderr
    assert inputs.read_bytes() == whole

    samples.write_text("rms\n5\n6\n8\n")
    assert workflow_in.planned(str(scene), "inputs") == {"inputs": 1}
