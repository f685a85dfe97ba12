"""Extreme cases and random draws of the contact model, judged by invariants.  Out: stability/contact.csv."""

from mesoscale.contact.stability import COLUMNS, stability_rows
from mesoscale.settings import ContactSettings
from workflow.job import job
from workflow.results import write_csv

with job(snakemake) as run:
    settings = ContactSettings(**snakemake.params.settings)
    write_csv(snakemake.output[0], list(stability_rows(settings, run.progress)), COLUMNS)
