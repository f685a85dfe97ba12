"""Elastic stage in hard cases.  In: material.  Out: stability/elastic.csv."""

from pathlib import Path

import yaml

from atomistic.elastic.networks import crystal
from atomistic.elastic.studies.stability import stability_checks
from workflow.checks import stability_rows
from workflow.job import job
from workflow.results import write_csv

with job(snakemake) as run:
    material = yaml.safe_load(Path(snakemake.input.material).read_text(encoding="utf-8"))
    beta = {**material["crystals"]["beta"], "supercell": [1, 1, 1]}
    cell = crystal({**material, "crystals": {"beta": beta}}, "beta")
    checks = stability_checks(cell, material["glass"])
    write_csv(snakemake.output.table, stability_rows("elastic", checks, run.progress))
