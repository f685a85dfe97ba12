"""Collect the table of uncertain inputs, each row from literature or from the stage that computes it.

In: hardness/fit.json, elastic/e_star.json, topography/parameters.json (those that the scene wants).
Out: inputs.csv.
"""

from mesoscale.inputs.table import COLUMNS, collect, to_rows
from mesoscale.settings import InputsSettings
from workflow.job import job
from workflow.results import read_json, write_csv

with job(snakemake) as run:
    settings = InputsSettings(**snakemake.params.settings)
    stages = {stage: read_json(path) for stage, path in snakemake.input.items()}
    files = {stage: "/".join(path.split("/")[-2:]) for stage, path in snakemake.input.items()}
    table = collect(settings, stages, files, snakemake.params.central_share)
    write_csv(snakemake.output[0], to_rows(table), COLUMNS)
