"""Record what a run depends on.  Out: scene.yaml with the resolved settings, package versions, git commit."""

import yaml

from workflow.job import job, own_commit, package_versions
from workflow.results import write_text
from workflow.scene import ROOT

with job(snakemake) as run:
    record = {
        "scene": snakemake.params.scene,
        "versions": package_versions(),
        "git_commit": own_commit(ROOT) or "not a git checkout",
    }
    write_text(snakemake.output[0], yaml.safe_dump(record, sort_keys=False, allow_unicode=True, width=100))
