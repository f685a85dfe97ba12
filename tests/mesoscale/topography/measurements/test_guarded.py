"""A reader that never ends, grows or breaks costs its file alone."""

import os
import signal
import sys
import tempfile
import time

import pytest

from mesoscale.errors import InputError
from mesoscale.topography.measurements import guarded as guard
from mesoscale.topography.measurements.guarded import guarded
from mesoscale.topography.measurements.loading import load_measurements

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="limits are set on Linux")


@pytest.fixture
def file(tmp_path, monkeypatch):
    monkeypatch.setattr(guard, "CPU_S", 1.0)
    monkeypatch.setattr(guard, "MEMORY_MB", 200.0)
    path = tmp_path / "scan.tiff"
    path.write_bytes(b"x")
    return path


def endless():
    while True:
        pass


def growing():
    kept = []
    while True:
        kept.append(bytearray(10**7))


def loud():
    while True:
        print("y" * 1000)


@pytest.mark.parametrize(
    ("read", "words"),
    [
        (endless, "more than 1 s"),
        (lambda: time.sleep(100), "more than 1 s"),
        (loud, "more than 1 s"),
        (lambda: os.kill(os.getpid(), signal.SIGKILL), "ended without a word"),
        (lambda: os._exit(3), "ended without a word"),
        (lambda: [][1], "IndexError"),
        (lambda: sys.exit(3), "SystemExit"),
    ],
)
def test_a_reader_that_misbehaves_is_refused_in_one_line(file, capfd, read, words):
    with pytest.raises(InputError, match=words) as error:
        guarded(file, read)
    assert str(file) in str(error.value)
    assert "\n" not in str(error.value)
    assert capfd.readouterr() == ("", "")


def test_a_reader_that_grows_is_refused_in_one_line(file, monkeypatch):
    # of a busy machine, on which a second is not enough to grow
    monkeypatch.setattr(guard, "CPU_S", 60.0)
    with pytest.raises(InputError, match="more than 200 MB") as error:
        guarded(file, growing)
    assert "\n" not in str(error.value)


def test_a_good_reader_gives_its_result_and_leaves_nothing(file, tmp_path, monkeypatch):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "t"))
    (tmp_path / "t").mkdir()

    def read():
        tempfile.mkdtemp()
        return {"a": 1}

    assert guarded(file, read) == {"a": 1}
    assert list((tmp_path / "t").iterdir()) == []


def test_a_refusal_passes_as_it_is(file):
    def read():
        raise InputError("x: no such channel")

    with pytest.raises(InputError, match=r"^x: no such channel$"):
        guarded(file, read)


def test_a_file_of_gigabytes_is_not_begun(file):
    with file.open("wb") as stream:
        stream.truncate(50 * 2**30)
    with pytest.raises(InputError, match="at most 4000 MB"):
        load_measurements(file)
