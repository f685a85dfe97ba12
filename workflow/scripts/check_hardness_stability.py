"""Molecular dynamics in hard cases.  In: potentials, materials (YAML).  Out: stability/hardness.csv."""

import shutil
from pathlib import Path

from atomistic.hardness.studies.stability import stability_checks
from atomistic.materials import load_material, oxide_glasses
from atomistic.potentials import load_potential
from workflow.checks import stability_rows
from workflow.job import job
from workflow.results import write_csv

with job(snakemake) as run:
    potentials = [load_potential(path) for path in snakemake.input.potentials]
    oxides = oxide_glasses(map(load_material, snakemake.input.materials))
    work = Path(snakemake.params.work)
    checks = stability_checks(potentials, oxides, work)
    write_csv(snakemake.output.table, stability_rows("hardness", checks, run.progress))
    shutil.rmtree(work)
