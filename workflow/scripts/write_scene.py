"""Record what a run depends on.  Out: scene.yaml with the resolved settings, package versions, git commit."""

import shutil
import subprocess

import yaml

from workflow.job import job, package_versions
from workflow.results import write_text
from workflow.scene import ROOT

with job(snakemake) as run:
    commit = ""
    # an installed wheel may lie in somebody else's repository; git is absent from slim container images
    if (ROOT / ".git").exists() and shutil.which("git"):
        command = ["git", "-C", str(ROOT), "-c", "core.fsmonitor=false", "-c", "core.hooksPath=/dev/null"]
        command += ["describe", "--always", "--dirty", "--abbrev=40"]
        commit = subprocess.run(command, capture_output=True, text=True, check=False).stdout.strip()
    record = {
        "scene": snakemake.params.scene,
        "versions": package_versions(),
        "git_commit": commit or "not a git checkout",
    }
    write_text(snakemake.output[0], yaml.safe_dump(record, sort_keys=False, allow_unicode=True, width=100))
