"""The cluster profile on a real Slurm: the same results as on one machine. `.ci/slurm` starts one
where it can.
"""

import importlib.util
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]

TARGETS = ("inputs", "contact")
SLURM = ("--seconds-between-status-checks", "2", "--latency-wait", "5")


def answers():
    """Does a Slurm controller answer here, with a node that takes jobs?"""
    if shutil.which("sinfo") is None:
        return False
    done = subprocess.run(
        ["sinfo", "-h", "-o", "%t"], capture_output=True, text=True, timeout=30, check=False
    )
    return done.returncode == 0 and any(state in done.stdout for state in ("idle", "mix", "alloc"))


pytestmark = [
    pytest.mark.skipif(
        importlib.util.find_spec("snakemake_executor_plugin_slurm") is None,
        reason="the optional extra cluster is not installed",
    ),
]


@pytest.mark.skipif(
    not answers(), reason="no Slurm answers here; .ci/slurm starts one on a machine for tests"
)
def test_results_do_not_depend_on_where_a_job_ran(make_workflow, tmp_path):
    files = ("inputs.csv", "contact/nominal.h5")
    found = []
    for place in ("local", "slurm"):
        folder = tmp_path / place
        folder.mkdir()
        workflow = make_workflow(folder, profile=place)
        done = workflow.run("ci", *TARGETS, options=SLURM if place == "slurm" else ())
        assert done.returncode == 0, done.stdout + done.stderr
        found.append([(folder / "results/ci" / name).read_bytes() for name in files])
    assert found[0] == found[1]


@pytest.mark.skipif(
    not answers(), reason="no Slurm answers here; .ci/slurm starts one on a machine for tests"
)
def test_more_ready_jobs_than_may_wait_all_run(tmp_path):
    """Arrays of the plugin lose jobs then, and the run hangs."""
    rule = "rule one:\n    output: '{k}.txt'\n    shell: 'touch {output}'\n"
    (tmp_path / "Snakefile").write_text(
        f"rule all:\n    input: expand('{{k}}.txt', k=range(6))\n{rule}"
    )
    command = [
        sys.executable,
        "-m",
        "snakemake",
        "--workflow-profile",
        str(ROOT / "workflow/profiles/slurm"),
    ]
    done = subprocess.run(
        [*command, *SLURM, "--jobs", "2"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert len(list(tmp_path.glob("*.txt"))) == 6


@pytest.mark.parametrize("scene", ["ci", "paper", "reduced", "full"])
def test_the_cluster_profile_plans_every_scene(make_workflow, tmp_path, scene):
    assert make_workflow(tmp_path, profile="slurm").planned(scene)
