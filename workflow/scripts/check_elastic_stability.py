"""Elastic stage in hard cases.  In: material.  Out: stability/elastic.csv."""

from atomistic.elastic.networks import crystal
from atomistic.elastic.studies.stability import stability_checks
from atomistic.materials import load_material
from workflow.checks import stability_rows
from workflow.job import job
from workflow.results import write_csv

with job(snakemake) as run:
    material = load_material(snakemake.input.material)
    checks = stability_checks(crystal(material, "beta", (1, 1, 1)), material.part("network_glass"))
    write_csv(snakemake.output.table, stability_rows("elastic", checks, run.progress))
