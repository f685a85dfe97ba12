"""Unusual inputs, failing runs and awkward outputs of the propagation.  Out: stability/uncertainty.csv."""

from mesoscale.uncertainty.studies.stability import stability_checks
from workflow.checks import stability_rows
from workflow.job import job
from workflow.results import write_csv

with job(snakemake) as run:
    write_csv(snakemake.output[0], stability_rows("uncertainty", stability_checks(), run.progress))
