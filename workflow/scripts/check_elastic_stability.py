"""Elastic stage in hard cases.  In: material.  Out: stability/elastic.csv."""

from atomistic.elastic.networks import crystal
from atomistic.elastic.studies import stability_checks
from atomistic.materials import load_material
from atomistic.settings import DftSettings
from workflow.files.results import write_csv
from workflow.run.job import job, settings_from_job
from workflow.run.studies import stability_rows

with job(snakemake) as run:
    material = load_material(snakemake.input.material)
    dft = settings_from_job(DftSettings, snakemake.params.dft)
    cell = crystal(material, next(iter(material.crystals), ""), (1, 1, 1))
    checks = stability_checks(cell, material.part("network_glass"), dft)
    write_csv(snakemake.output.table, stability_rows("elastic", checks, run.progress))
