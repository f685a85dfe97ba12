"""Asperity as a module of another workflow, which has a folder of its own and its own rules and
handlers.
"""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from workflow.files.results import load_csv

ROOT = Path(__file__).resolve().parents[2]
HOST = """
module asperity:
    snakefile: {snakefile!r}
    config: config["asperity"]

use rule * from asperity as asperity_*

rule all:
    default_target: True
    input: {target!r}
    output: "answer.txt"
    shell: "cp {{input}} {{output}}"

rule run:  # named and with a wildcard like one of the module's, but not bound by its constraints
    output: "glass_{{glass}}.txt"
    shell: "touch {{output}}"

onstart:
    print("the host starts")

onsuccess:
    print("the host is done")
"""


SWEEP = """
SCENES = [f"gap_{{number}}" for number in range(12)]

module film:
    snakefile: {snakefile!r}
    config: {{"scene": "film.yaml"}}

use rule * from film as film_*

for scene in SCENES:
    module:
        name: scene
        snakefile: {snakefile!r}
        config: {{"scene": f"{{scene}}.yaml"}}

    use rule * from scene exclude hardness, elastic as scene*

rule share:
    input: "results/film/{{file}}"
    output: "results/{{scene}}/{{file}}"
    wildcard_constraints:
        scene="gap_.+",
        file="hardness/fit.json|elastic/e_star.json",
    shell: "cp {{input}} {{output}}"

rule all:
    default_target: True
    input: expand("results/{{scene}}/report.html", scene=SCENES)
"""
OWN_HARDNESS = """
module asperity:
    snakefile: {snakefile!r}
    config: {{"scene": "mine.yaml"}}

use rule * from asperity exclude hardness as asperity_*

rule indentation:
    input: "indentation.json"
    output: "results/mine/hardness/fit.json"
    shell: "cp {{input}} {{output}}"
"""


@pytest.fixture
def run_host(tmp_path):
    """Run Snakemake on a host's text in its root."""

    def run(text: str, *options: str) -> subprocess.CompletedProcess[str]:
        snakefile = str(ROOT / "workflow" / "Snakefile")
        (tmp_path / "Snakefile").write_text(text.format(snakefile=snakefile))
        snakemake = str(Path(sys.executable).with_name("snakemake"))
        return subprocess.run(
            [snakemake, *options, "--cores", "1"],
            cwd=tmp_path,
            env={**os.environ, "XDG_CACHE_HOME": str(tmp_path / "cache")},
            capture_output=True,
            text=True,
            check=False,
        )

    return run


@pytest.fixture
def host(tmp_path):
    """Run the host workflow in its own folder; `target` is the file of the module that it needs."""

    def run(scene: str, target: str, *options: str) -> str:
        (tmp_path / "workflow").mkdir(exist_ok=True)  # a host has such a folder too
        snakefile = str(ROOT / "workflow" / "Snakefile")
        (tmp_path / "workflow" / "Snakefile").write_text(
            HOST.format(snakefile=snakefile, target=target)
        )
        (tmp_path / "config.yaml").write_text(f"asperity: {{scene: {scene}}}")
        snakemake = str(Path(sys.executable).with_name("snakemake"))
        command = [snakemake, *options, "--cores", "1", "--configfile", "config.yaml"]
        # Snakemake's own, where the home is read-only
        env = {**os.environ, "XDG_CACHE_HOME": str(tmp_path / "cache")}
        done = subprocess.run(
            command, cwd=tmp_path, env=env, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout + done.stderr

    return run


def test_a_host_workflow_plans_the_rules_of_the_module(host):
    planned = host("paper", "results/paper/report.html", "--dry-run", "--quiet", "rules")
    for rule in ("asperity_inputs", "asperity_law", "asperity_report", "all"):
        assert rule in planned


def test_a_host_workflow_runs_the_module_in_its_own_folder(host, tmp_path):
    paper = (ROOT / "config" / "scenes" / "paper.yaml").read_text()
    (tmp_path / "mine.yaml").write_text(paper.replace("name: paper", "name: mine"))
    said = host("mine.yaml", "results/mine/inputs.csv", "all", "glass_amber.txt")
    assert (tmp_path / "answer.txt").read_text() == (
        tmp_path / "results/mine/inputs.csv"
    ).read_text()
    assert (tmp_path / "glass_amber.txt").exists()
    assert "the host starts" in said
    assert "the host is done" in said
    assert "results are in" not in said  # Asperity's own last line
    again = host("mine.yaml", "results/mine/inputs.csv", "all", "--dry-run")
    assert "Nothing to be done" in again


def test_a_sweep_of_twelve_scenes_makes_the_atoms_once(run_host, tmp_path):
    """The scenes differ in their gap alone; hardness and modulus are those of one film."""
    (tmp_path / "film.yaml").write_text("extends: ci\nname: film\n")
    for number in range(12):
        scene = f"extends: ci\nname: gap_{number}\ndevice: {{gap_um: {2 + 0.1 * number}}}\n"
        (tmp_path / f"gap_{number}.yaml").write_text(scene)
    done = run_host(SWEEP, "--dry-run", "--quiet", "rules")
    assert done.returncode == 0, done.stderr
    counted = re.findall(r"^(\w+) +(\d+)$", done.stdout + done.stderr, re.MULTILINE)
    jobs = {rule: int(count) for rule, count in counted}
    atoms = ("make_glass", "run_closing", "hardness", "make_amorphous", "scan_glass", "elastic")
    of_ci = {"run_closing": 2}  # two energies
    for rule in atoms:
        assert jobs.pop(f"film_{rule}") == of_ci.get(rule, 1)
        assert not [name for name in jobs if name.endswith(rule)]
    assert jobs["share"] == 24
    assert len([name for name in jobs if name.endswith("answer")]) == 12


def test_a_host_brings_its_own_hardness(run_host, tmp_path):
    content = {
        "gate": {"passed": True},
        "inputs": {"h_prime": {"distribution": "uniform", "a": 3.0, "b": 9.0}},
        "twins": [],
    }
    (tmp_path / "indentation.json").write_text(json.dumps(content))
    origin = "inputs: {h_prime: {origin: hardness}}"
    (tmp_path / "mine.yaml").write_text(f"extends: table1\nname: mine\n{origin}\n")
    done = run_host(OWN_HARDNESS, "results/mine/inputs.csv")
    assert done.returncode == 0, done.stdout + done.stderr
    rows = {row["parameter"]: row for row in load_csv(tmp_path / "results/mine/inputs.csv")}
    found = rows["h_prime"]
    assert found["origin"] == "hardness"
    assert (float(found["a"]), float(found["b"])) == (3.0, 9.0)


def test_a_host_that_asks_for_no_scene_is_refused_in_one_line(run_host):
    done = run_host(OWN_HARDNESS, "--dry-run")
    assert done.returncode != 0
    (line,) = done.stderr.splitlines()[-1:]
    assert line.startswith("ERROR scene=mine.yaml: no such file")


def test_jobs_go_to_the_image_with_apptainer(workflow_in):
    """With a stand-in that notes its arguments and needs no image; nobody has tried a real one."""
    folder = workflow_in.folder
    stand_in = folder / "bin/apptainer"
    stand_in.parent.mkdir()
    stand_in.write_text(
        "#!/usr/bin/env bash\n"
        f'echo "$*" >>{folder}/calls.txt\n'
        'if [ "$1" = --version ]; then echo "apptainer version 1.4.1"; exit; fi\n'
        'exec bash -c "${@: -1}"\n'
    )
    stand_in.chmod(0o755)
    (folder / "asperity.sif").touch()
    workflow_in.environment["PATH"] = f"{stand_in.parent}:{os.environ['PATH']}"
    done = workflow_in.run("paper", "inputs", options=("--sdm", "apptainer"))
    assert done.returncode == 0, done.stdout + done.stderr
    calls = (folder / "calls.txt").read_text()
    assert re.search(r"^exec --home .* asperity\.sif bash -c ", calls, re.MULTILINE)
    assert (folder / "results/paper/inputs.csv").is_file()
