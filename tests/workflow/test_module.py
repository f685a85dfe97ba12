"""Asperity as a module of another workflow, which has a folder of its own and its own rules and
handlers.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest

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
        env = {
            **os.environ,
            "XDG_CACHE_HOME": str(tmp_path / "cache"),
        }  # Snakemake's own, where the home is read-only
        done = subprocess.run(
            command, cwd=tmp_path, env=env, capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout + done.stderr

    return run


@pytest.mark.parametrize("scene", ["ci", "paper"])
def test_a_host_workflow_plans_the_rules_of_the_module(host, scene):
    planned = host(scene, f"results/{scene}/report.html", "--dry-run", "--quiet", "rules")
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
