"""A failing job says why in one line; the traceback is in its log."""

import time
from contextlib import suppress
from pathlib import Path
from types import SimpleNamespace

import pytest

from mesoscale.errors import InputError
from workflow.files.results import write_csv
from workflow.run.job import failures, job, package_versions, result_checksum


@pytest.fixture
def snakemake(tmp_path):
    return SimpleNamespace(
        rule="analyse_scan",
        wildcards={"scan": "a"},
        input=[],
        params={"settings": {}},
        log=[str(tmp_path / "logs/a.log")],
    )


def test_bad_input_is_one_line(snakemake, tmp_path, capsys):
    start = time.time() - 1
    with pytest.raises(SystemExit) as caught, job(snakemake):
        raise InputError("a.gwy: no physical size;\n give topography.size_nm")
    assert caught.value.code == 1
    line = "ERROR analyse_scan a: a.gwy: no physical size; give topography.size_nm"
    assert capsys.readouterr().err == line + "\n"
    assert failures(tmp_path / "logs", start) == [line]
    assert "Traceback" in (tmp_path / "logs/a.log").read_text()


def test_an_unforeseen_error_is_called_internal(snakemake, capsys):
    with pytest.raises(SystemExit), job(snakemake):
        raise ZeroDivisionError("division by zero")
    assert (
        "internal error (ZeroDivisionError: division by zero); details in"
        in capsys.readouterr().err
    )


def test_a_full_disk_is_named(snakemake, capsys):
    with pytest.raises(SystemExit), job(snakemake):
        raise OSError(28, "No space left on device", "results/a.h5")
    message = capsys.readouterr().err
    assert "No space left on device" in message
    assert "finished results are kept" in message


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs Linux")
def test_a_disk_too_full_for_the_log_shows_no_traceback(snakemake, tmp_path, capsys):
    (tmp_path / "logs").mkdir()
    (tmp_path / "logs/a.log").symlink_to("/dev/full")
    with pytest.raises(SystemExit), job(snakemake):
        raise OSError(28, "No space left on device", "results/a.h5")
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("ERROR analyse_scan a: [Errno 28] No space left on device")
    with job(snakemake) as run:
        run.log.write("lost, but the job ends well")


def test_provenance_depends_on_settings_and_inputs(snakemake, tmp_path):
    scan = tmp_path / "scan"
    scan.write_text("1")
    snakemake.input = [scan]
    hashes = []
    for value in (1, 2):
        snakemake.params = {"settings": {"value": value}}
        with job(snakemake) as run:
            hashes.append(run.provenance["inputs_hash"])
    scan.write_text("2")
    with job(snakemake) as run:
        hashes.append(run.provenance["inputs_hash"])
    assert len(set(hashes)) == 3


def test_a_table_of_the_user_may_have_any_encoding(snakemake, tmp_path):
    table = tmp_path / "stylus.csv"
    table.write_bytes("Radius: 2.5 \u00b5m,1\n".encode("latin-1"))
    snakemake.input = [table]
    with job(snakemake) as run:
        assert run.provenance["inputs_hash"]


def test_provenance_names_the_installed_packages_alone(monkeypatch):
    assert {"numpy", "openturns", "SurfaceTopography"} <= set(package_versions())
    monkeypatch.setattr("workflow.run.job.PACKAGES", ("numpy", "no-such-package"))
    assert set(package_versions()) == {"numpy"}


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("points.csv", "B_GPa,wall_s\n{result},{time}\n"),
        ("fit.json", '{{"B_GPa": {result}, "parts": [{{"cpu_s": {time}}}]}}'),
    ],
)
def test_a_checksum_is_of_the_results_and_not_of_the_times_they_took(tmp_path, name, text):
    path = tmp_path / name
    checksums = []
    for result, seconds in ((1, 1), (1, 2), (2, 2)):
        path.write_text(text.format(result=result, time=seconds))
        checksums.append(result_checksum(path))
    assert checksums[0] == checksums[1] != checksums[2]


def test_a_shared_job_is_done_once_for_two_scenes(snakemake, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("workflow.run.job.own_commit", lambda root: "abc")
    bodies = []
    for scene in ("first", "second"):
        snakemake.log = [str(tmp_path / scene / "logs/a.log")]
        snakemake.output = [str(tmp_path / scene / "topography/a.csv")]
        with suppress(SystemExit), job(snakemake, shared=True):
            bodies.append(scene)
            write_csv(snakemake.output[0], [{"q0": 0.02}])
    assert bodies == ["first"]
    assert "taken from" in capsys.readouterr().err
    assert result_checksum(snakemake.output[0]) == result_checksum(
        tmp_path / "first/topography/a.csv"
    )
