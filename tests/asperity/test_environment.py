"""What a stranger's working folder may not do: be taken for packages or settings, redirect, or name
a scene wrongly.
"""

import getpass
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from asperity.__main__ import main
from asperity.guards.environment import READ, UnsafeFolder, secure
from asperity.guards.foreign_text import as_cell, as_word, from_word, shown
from asperity.guards.foreign_yaml import MistakenYaml, load_mapping, parse

ASPERITY = str(Path(sys.executable).with_name("asperity"))
VARIABLES = (
    "PYTHONSAFEPATH",
    "PYTHONPATH",
    "PYSCF_CONFIG_FILE",
    "NUMBA_CACHE_DIR",
    "XDG_CACHE_HOME",
    "MPLCONFIGDIR",
)


@pytest.fixture(autouse=True)
def _as_before(monkeypatch):
    """Environment of the other tests."""
    for name in VARIABLES:
        monkeypatch.setenv(name, os.environ.get(name, ""))
        monkeypatch.delenv(name)


def started(folder, code):
    """What Python says that is started after `secure`, in a folder, as jobs and workers are."""
    secure()
    return subprocess.run(
        [sys.executable, "-c", code], cwd=folder, capture_output=True, text=True, check=True
    ).stdout


@pytest.mark.parametrize("name", ["yaml", "random", "types", "pickle", "workflow/__init__"])
def test_no_module_of_the_folder_is_run(tmp_path, name):
    planted = tmp_path / f"{name}.py"
    planted.parent.mkdir(exist_ok=True)
    planted.write_text("print('ran')\n")
    assert started(tmp_path, "import yaml, random, types, pickle, workflow") == ""
    script = tmp_path / "job.py"
    script.write_text("import yaml, random, types, pickle, workflow")
    said = subprocess.run(
        [sys.executable, str(script)], cwd="/", capture_output=True, text=True, check=True
    ).stdout
    assert said == ""


@pytest.mark.parametrize("name", ["argparse", "ast", "pathlib", "pydantic"])
@pytest.mark.parametrize("given", [":", "/nowhere:", ".", "::/nowhere"])
def test_an_empty_entry_of_pythonpath_runs_no_module_of_the_folder(tmp_path, given, name):
    """Python itself puts the working folder there, before its own modules."""
    (tmp_path / f"{name}.py").write_text("open('ran', 'w')\nraise SystemExit(7)\n")
    environment = {**os.environ, "PYTHONPATH": given}
    done = subprocess.run(
        [ASPERITY, "targets"], cwd=tmp_path, env=environment, capture_output=True, text=True
    )
    assert (done.returncode, (tmp_path / "ran").exists()) == (0, False), done.stderr
    assert "circuit" in done.stdout


def test_pyscf_runs_no_settings_of_the_folder(tmp_path):
    (tmp_path / ".pyscf_conf.py").write_text("print('ran')\n")
    assert started(tmp_path, "import pyscf.__config__") == ""


@pytest.mark.parametrize("name", [name.replace("*", "dzvp-molopt-sr") for name in READ])
def test_a_folder_with_settings_that_cannot_be_left_aside_is_refused(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    secure()
    (tmp_path / name).parent.mkdir(exist_ok=True)
    (tmp_path / name).write_text("x")
    with pytest.raises(UnsafeFolder, match="move it away"):
        secure()


@pytest.mark.parametrize("name", [".snakemake", ".snakemake/log", ".snakemake/metadata/eA=="])
def test_snakemake_writes_through_no_link(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "outside").mkdir()
    (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
    (tmp_path / name).symlink_to(tmp_path / "outside")
    with pytest.raises(UnsafeFolder, match="remove it"):
        secure()


def test_what_snakemake_may_not_read_is_refused(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    # root may read everything
    monkeypatch.setattr("os.access", lambda path, mode: Path(path).name != "metadata")
    (tmp_path / ".snakemake/metadata").mkdir(parents=True)
    with pytest.raises(
        UnsafeFolder, match=r"^\.snakemake/metadata: may not be read and written; change its permi"
    ):
        secure()


def test_packages_of_other_workflows_may_hold_links(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    library = tmp_path / ".snakemake/conda/1234_/lib/libz.so"
    library.parent.mkdir(parents=True)
    library.symlink_to("libz.so.1")
    secure()


@pytest.mark.parametrize("command", [["plan"], ["compare", "a", "b"], ["serve"]])
def test_the_command_refuses_such_a_folder_in_one_line(tmp_path, monkeypatch, capsys, command):
    monkeypatch.chdir(tmp_path)
    (tmp_path / ".numba_config.yaml").write_text("cache_dir: .\n")
    assert main(command) == 1
    said = capsys.readouterr().err
    assert said.startswith("ERROR .numba_config.yaml")
    assert said.count("\n") == 1


def test_a_home_that_is_read_only_costs_nothing(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", "/proc/nowhere")
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr("tempfile.tempdir", None)
    secure()
    folder = Path(os.environ["XDG_CACHE_HOME"])
    assert folder.parent == tmp_path
    assert folder.stat().st_mode & 0o077 == 0
    assert os.environ["MPLCONFIGDIR"] == os.environ["NUMBA_CACHE_DIR"] == str(folder)


def test_a_user_whom_the_system_does_not_know_gets_name_and_home(tmp_path, monkeypatch):
    """As in a container that runs under the number of another machine's user."""

    def unknown(number):
        raise KeyError(number)

    for variable in ("HOME", "USER", "LOGNAME", "LNAME", "USERNAME"):
        monkeypatch.delenv(variable, raising=False)
    monkeypatch.setattr("pwd.getpwuid", unknown)
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr("tempfile.tempdir", None)
    secure()
    assert Path.home().parent == tmp_path
    assert getpass.getuser() == str(os.getuid())


def test_set_up_needs_no_installed_locale_and_no_home(tmp_path):
    """Python does not start in a folder with letters beyond ASCII else, and uv has no place for its
    cache.
    """
    given = {**os.environ, "LC_ALL": "xx_XX.UTF-8", "HOME": str(tmp_path / "nowhere")}
    given.pop("UV_CACHE_DIR", None)
    command = ["make", "--dry-run", "--print-data-base", "setup"]
    done = subprocess.run(
        command,
        cwd=Path(__file__).parents[2],
        env=given,
        capture_output=True,
        text=True,
        check=True,
    )
    assert "\nLC_ALL := C.UTF-8\n" in done.stdout
    assert "\nUV_CACHE_DIR := " in done.stdout


def test_a_cache_that_somebody_else_made_is_not_used(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", "/proc/nowhere")
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    (tmp_path / f"asperity-cache-{os.getuid()}").symlink_to(tmp_path / "elsewhere")
    secure()
    assert Path(os.environ["XDG_CACHE_HOME"]).is_dir()
    assert not (tmp_path / "elsewhere").exists()


def test_the_command_sets_its_environment_before_numba_is_imported():
    code = "import sys, asperity.__main__; print('numba' in sys.modules)"
    said = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    ).stdout
    assert said.split() == ["False"]


@pytest.mark.parametrize(
    "option", [["--cores", "0"], ["--cores", "-1"], ["--cores", "\x1b[31m"], ["--hours", "nan"]]
)
def test_an_odd_number_of_cores_or_hours_is_refused(option, capsys):
    with pytest.raises(SystemExit):
        main(["plan", f"{option[0]}={option[1]}"])
    assert "\x1b" not in capsys.readouterr().err


def test_the_scene_reaches_snakemake_as_it_is_called(monkeypatch):
    """A name such as `ci #2.yaml` would be read as `ci`."""
    given = []
    monkeypatch.setattr("os.execv", lambda program, arguments: given.append(arguments))
    for name in (
        "ci #2.yaml",
        "a: b.yaml",
        'it\'s "x".yaml',
        "!x",
        "- y.yaml",
        "null",
        "12",
        "paper",
        "$(x)",
    ):
        main(["plan", name])
        word = next(word for word in given[-1] if word.startswith("scene=")).removeprefix("scene=")
        assert from_word(word) == name
        assert not set(word) & set("'\"$`\\ \n#!")
    assert as_word("my/paper-2.yaml") == "my/paper-2.yaml"


@pytest.mark.skipif(sys.platform != "linux", reason="needs /proc")
def test_signals_to_the_command_reach_the_workflow(tmp_path):
    """No process of it lives on; the command and Snakemake are one. Both runs work at once."""
    command = [ASPERITY, "run", "paper", "--cores", "1", "contact"]
    runs = {}
    for number in (signal.SIGTERM, signal.SIGKILL):
        folder = tmp_path / number.name
        folder.mkdir()
        environment = {
            **os.environ,
            "ASPERITY_TEST": str(tmp_path),
            "XDG_CACHE_HOME": str(folder / "cache"),
        }
        said = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        runs[number] = subprocess.Popen(command, cwd=folder, env=environment, **said)
    deadline = time.monotonic() + 120
    for number, process in runs.items():
        while (
            not (tmp_path / number.name / "results/paper/.lock").exists()
            and time.monotonic() < deadline
        ):
            time.sleep(0.1)
        assert process.poll() is None
        process.send_signal(number)
    for process in runs.values():
        process.wait(30)

    def left():
        mark = f"ASPERITY_TEST={tmp_path}".encode()
        return [path for path in Path("/proc").glob("[0-9]*/environ") if _holds(path, mark)]

    while left() and time.monotonic() < deadline + 30:
        time.sleep(0.2)
    assert left() == []


def _holds(path, mark):
    try:
        return mark in path.read_bytes().split(b"\0")
    except OSError:
        return False


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a: &a [x, x]\nb: [*a, *a]", "alias"),
        ('pixels: !!int ""', "tag"),
        ("pixels: !!bool x", "tag"),
        ("pixels: ! 5", "tag"),
        ("x: !!python/tuple [1, 2]", "tag"),
        ("x: [" + "1," * 60_000 + "]", "more than 50000 values"),
        ("x: " + "[" * 5000, "nested"),
        ("x: " + "9" * 5000, "not valid"),
        ("x: 1\nx: 2", "twice"),
        ("# comment\u2028x: 1", "hidden"),
        ("# comment\x85x: 1", "hidden"),
        ("# comment\rx: 1", "hidden"),
    ],
)
def test_yaml_of_a_stranger_is_plain_or_refused(text, words):
    with pytest.raises(MistakenYaml, match=words):
        parse(text)


def test_containers_may_have_tuples_and_nothing_else():
    assert parse("x: !!python/tuple [1, 2.5]", tuples=True) == {"x": (1, 2.5)}
    for text in ("x: !!python/name:os.system", "x: !!int 5", "x: !!python/tuple {a: 1}"):
        with pytest.raises(MistakenYaml, match="tag"):
            parse(text, tuples=True)


def test_a_file_is_read_no_further_than_its_cap(tmp_path):
    path = tmp_path / "x.yaml"
    with path.open("wb") as stream:
        stream.truncate(20 * 2**30)
    with pytest.raises(MistakenYaml, match="bytes"):
        load_mapping(path, "scene")


def test_text_of_a_stranger_is_shown_without_control_characters():
    assert shown("a\x1b[31mb\nc\u202ed é µ") == "a\\x1b[31mb\\nc\\u202ed é µ"
    # a spreadsheet may separate by ;
    assert as_cell("a;=HYPERLINK(1);-1;b\n@x") == "a;'=HYPERLINK(1);'-1;b\n'@x"
    assert [as_cell(text) for text in ("=HYPERLINK(1)", "+1+1", "@x", "-x", "-1.5", "a=b", "")] == [
        "'=HYPERLINK(1)", "'+1+1", "'@x", "'-x", "-1.5", "a=b", "",
    ]  # fmt: skip
    # as the Excel of East Asia computes them
    full_width = ("\uff1d1+1", "\uff0b1", "\uff20x", "\uff0dx")
    assert [as_cell(text) for text in full_width] == [f"'{text}" for text in full_width]
    assert as_cell("a;\uff1d1") == "a;'\uff1d1"
