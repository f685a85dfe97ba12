"""Write the report page from the result files of the scene's stages, and record what the run
depends on.

In: result files of all stages that the scene needs. Out: report.html, self-contained; figures/, its
figures as SVG; scene.yaml with the resolved settings, package versions, git commit.
"""

from pathlib import Path

import yaml

from asperity.guards.bundle import ROOT
from workflow.files.results import write_text
from workflow.report.available import Results
from workflow.report.figures import figures_of
from workflow.report.render import render
from workflow.run.job import job, own_commit, package_versions

with job(snakemake) as run:
    scene = snakemake.params.scene
    root = Path(snakemake.output.page).parent
    record = {
        "scene": scene,
        "versions": package_versions(),
        "git_commit": own_commit(ROOT) or "not a git checkout",
    }
    write_text(
        snakemake.output.record,
        yaml.safe_dump(record, sort_keys=False, allow_unicode=True, width=100),
    )
    results = [path for path in snakemake.input if path not in set(snakemake.input.style)]
    results += [snakemake.output.record, *snakemake.params.studies]
    page = render(Results(root, results, scene["name"]))
    Path(snakemake.output.figures).mkdir(exist_ok=True)
    for name, picture in figures_of(page).items():
        write_text(f"{snakemake.output.figures}/{name}.svg", picture)
    write_text(snakemake.output.page, page)
