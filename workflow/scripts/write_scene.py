"""Record what a run depends on.  Out: scene.yaml with the resolved settings, package versions, git commit."""

import shutil
import subprocess

import yaml

from workflow.job import job, package_versions
from workflow.results import write_text
from workflow.scene import ROOT

with job(snakemake) as run:
    commit = ""
    if shutil.which("git"):  # absent from slim container images
        command = ["git", "-C", str(ROOT), "describe", "--always", "--dirty", "--abbrev=40"]
        commit = subprocess.run(command, capture_output=True, text=True, check=False).stdout.strip()
    record = {
        "scene": snakemake.params.scene,
        "versions": package_versions(),
        "git_commit": commit or "not a git checkout",
    }
    write_text(snakemake.output[0], yaml.safe_dump(record, sort_keys=False, allow_unicode=True, width=100))
