"""Molecular dynamics in hard cases.  In: potentials (YAML).  Out: stability/hardness.csv."""

from pathlib import Path

from atomistic.hardness.studies.stability import COLUMNS, stability_rows
from atomistic.potentials import load_potential
from workflow.job import job
from workflow.results import write_csv

with job(snakemake) as run:
    potentials = [load_potential(path) for path in snakemake.input.potentials]
    write_csv(snakemake.output.table, stability_rows(potentials, Path(snakemake.params.work), run.progress), COLUMNS)
