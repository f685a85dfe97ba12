"""What is published agrees with itself, and passes the checkers of package indexes."""

import json
import re
import subprocess
import sys
import tarfile
import tomllib
from pathlib import Path

import pytest
import yaml

ROOT = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
CITATION = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
ZENODO = json.loads((ROOT / ".zenodo.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def recipe():
    """The conda recipe as rattler-build, the tool that builds it, understands it."""
    rattler_build = pytest.importorskip("rattler_build")
    return rattler_build.Stage0Recipe.from_file(ROOT / "recipe.yaml").render()[0].recipe.to_dict()


@pytest.fixture(scope="module")
def archives(tmp_path_factory):
    """Wheel and source archive."""
    folder = tmp_path_factory.mktemp("dist")
    build = [sys.executable, "-m", "hatchling", "build", "-d", str(folder)]
    subprocess.run(build, cwd=ROOT, check=True, capture_output=True)
    return sorted(folder.iterdir())


def test_the_recipe_is_that_of_the_package(recipe):
    assert recipe["package"] == {"name": PROJECT["name"], "version": PROJECT["version"]}
    needs = {re.sub(r"\s", "", need) for need in recipe["requirements"]["run"]}
    stated = {need.replace(" ", "") for need in PROJECT["dependencies"]}
    assert needs == stated | {f"python{PROJECT['requires-python']}"}
    scripts = [f"{name} = {place}" for name, place in PROJECT["scripts"].items()]
    assert recipe["build"]["python"]["entry_points"] == scripts
    assert recipe["about"]["summary"] == PROJECT["description"]
    assert recipe["about"]["license"] == PROJECT["license"]


def test_a_wrong_recipe_is_refused():
    rattler_build = pytest.importorskip("rattler_build")
    text = (ROOT / "recipe.yaml").read_text(encoding="utf-8")
    with pytest.raises(rattler_build.RattlerBuildError):
        rattler_build.Stage0Recipe.from_yaml(text.replace("requirements:", "requirement:"))


def test_citation_and_zenodo_agree_with_the_package():
    assert CITATION["version"] == PROJECT["version"]
    assert CITATION["license"] == ZENODO["license"] == PROJECT["license"]
    assert CITATION["title"] == ZENODO["title"]
    assert CITATION["keywords"] == ZENODO["keywords"]
    names = []
    for author in CITATION["authors"]:
        both = (author.get("family-names"), author.get("given-names"))
        names.append(author.get("name") or ", ".join(both))
    assert [creator["name"] for creator in ZENODO["creators"]] == names
    (paper,) = ZENODO["related_identifiers"]
    assert paper["identifier"] == CITATION["preferred-citation"]["doi"]


def test_all_pages_state_the_same_pythons():
    first, beyond = re.fullmatch(r">=3\.(\d+),<3\.(\d+)", PROJECT["requires-python"]).groups()
    versions = [f"3.{minor}" for minor in range(int(first), int(beyond))]
    label = "Programming Language :: Python :: "
    classified = [text.removeprefix(label) for text in PROJECT["classifiers"] if label in text]
    assert classified == versions
    for page in ("README.md", "docs/tutorial.md"):
        text = (ROOT / page).read_text(encoding="utf-8")
        assert f"`python3` {versions[0]} to {versions[-1]}" in text, page


def test_the_archives_pass_twine(archives):
    pytest.importorskip("twine")
    command = [sys.executable, "-m", "twine", "check", "--strict", *map(str, archives)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_wheel_passes_check_wheel_contents(archives):
    pytest.importorskip("check_wheel_contents")
    (wheel,) = (file for file in archives if file.suffix == ".whl")
    command = [sys.executable, "-m", "check_wheel_contents", str(wheel)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_source_archive_has_what_a_build_needs_and_nothing_else_of_the_folder(archives):
    (archive,) = (file for file in archives if file.suffixes[-2:] == [".tar", ".gz"])
    with tarfile.open(archive) as opened:
        names = {name.partition("/")[2] for name in opened.getnames()}
    assert {"pyproject.toml", "recipe.yaml", "CITATION.cff", "workflow/Snakefile"} <= names
    assert not any(name.startswith((".venv", "results", ".uv")) for name in names)
