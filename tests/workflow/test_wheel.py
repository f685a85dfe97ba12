"""The wheel in an environment that has never seen the checkout, as a module of another workflow."""

import os
import subprocess
from pathlib import Path

import pytest

HOST = """
from asperity.guards.bundle import ROOT

module asperity:
    snakefile: str(ROOT / "workflow/Snakefile")
    config: config

use rule * from asperity as asperity_*

use rule inputs from asperity as asperity_inputs with:
    message: "as the host says it"

rule count:
    default_target: True
    input: "results/{scene}/inputs.csv"
    output: "count.txt"
    shell: "wc -l < {{input}} > {{output}}"
"""


@pytest.fixture(scope="module")
def environment():
    """Python of an environment with the wheel and what it needs; nothing leads to the checkout."""
    python = os.environ.get("ASPERITY_WHEEL")
    if python is None:
        pytest.skip("needs an environment with the wheel; .ci/wheel makes one for this test")
    return Path(python)


@pytest.fixture
def host(environment, tmp_path):
    """Write a host workflow and run it in its own folder."""
    (tmp_path / "mine.yaml").write_text("extends: paper\nname: mine\n")

    def run(place: str, *options: str) -> subprocess.CompletedProcess[str]:
        path = tmp_path / place
        path.parent.mkdir(exist_ok=True)
        path.write_text(HOST.format(scene="mine"))
        variables = {
            name: value for name, value in os.environ.items() if not name.startswith("PYTHON")
        }
        command = [str(environment), "-m", "snakemake", "--cores", "1"]
        return subprocess.run(
            [*command, *options, "--config", "scene=mine.yaml"],
            cwd=tmp_path,
            env=variables | {"XDG_CACHE_HOME": str(tmp_path / "cache")},
            capture_output=True,
            text=True,
            check=False,
        )

    return run


def test_a_host_in_the_root_runs_a_rule_of_the_wheel_and_one_of_its_own(host, tmp_path):
    done = host("Snakefile")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "as the host says it" in done.stdout + done.stderr
    assert int((tmp_path / "count.txt").read_text()) > 5


def test_a_host_in_a_folder_of_our_name_plans_the_rules_of_the_wheel(host, tmp_path):
    """As snakedeploy lays a host out; it has modules in that folder, too."""
    (tmp_path / "workflow/helpers").mkdir(parents=True)
    (tmp_path / "workflow/helpers/__init__.py").write_text("")
    planned = host("workflow/Snakefile", "asperity_report", "--dry-run", "--quiet", "rules")
    said = planned.stdout + planned.stderr
    assert planned.returncode == 0, said
    assert "asperity_law" in said


def test_a_module_of_the_host_in_our_place_is_named(environment, tmp_path):
    (tmp_path / "workflow/run").mkdir(parents=True)
    (tmp_path / "workflow/run/__init__.py").write_text("")
    lines = [
        "import sys",
        f"sys.path.insert(0, {str(tmp_path)!r})",
        "import workflow.run",
        "from asperity.guards.bundle import bind_workflow",
        "bind_workflow()",
    ]
    done = subprocess.run(
        [str(environment), "-I", "-c", "\n".join(lines)],
        capture_output=True,
        text=True,
        check=False,
    )
    (line,) = done.stderr.splitlines()[-1:]
    assert "workflow.run: the host workflow has imported a module of this name" in line
