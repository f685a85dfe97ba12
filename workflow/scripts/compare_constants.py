"""Elastic constants beside published ones.  In: elastic/tensors/CRYSTAL.json.  Out: accuracy/elastic_constants.csv."""

from atomistic.elastic.studies.constants import beside_published
from atomistic.materials import load_material
from workflow.job import job
from workflow.results import load_json, write_csv

with job(snakemake) as run:
    crystals = {}
    for path in snakemake.input.materials:
        crystals |= load_material(path).crystals
    reports = [load_json(path) for path in snakemake.input.tensors]
    write_csv(
        snakemake.output.table,
        [row for report in reports for row in beside_published(report, crystals[report["structure"]])],
    )
