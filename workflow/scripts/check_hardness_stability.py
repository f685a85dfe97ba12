"""Molecular dynamics in hard cases.  In: potentials (YAML).  Out: stability/hardness.csv."""

import shutil
from pathlib import Path

from atomistic.hardness.studies.stability import stability_checks
from atomistic.potentials import load_potential
from workflow.checks import stability_rows
from workflow.job import job
from workflow.results import write_csv

with job(snakemake) as run:
    potentials = [load_potential(path) for path in snakemake.input.potentials]
    work = Path(snakemake.params.work)
    write_csv(snakemake.output.table, stability_rows("hardness", stability_checks(potentials, work), run.progress))
    shutil.rmtree(work)
