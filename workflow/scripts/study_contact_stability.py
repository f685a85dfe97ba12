"""Extreme cases and random draws of the contact model, judged by invariants.

In: stability/contact_draws/chunk_*.csv.  Out: stability/contact.csv, stability/contact_draws.csv (all draws).
"""

from mesoscale.contact.studies import draws
from mesoscale.contact.studies.stability import COLUMNS, stability_rows
from mesoscale.settings import ContactSettings
from workflow.job import job
from workflow.results import read_csv, write_csv

with job(snakemake) as run:
    settings = ContactSettings(**snakemake.params.settings)
    drawn = [row for chunk in snakemake.input.draws for row in read_csv(chunk)]
    write_csv(snakemake.output.table, list(stability_rows(settings, drawn, run.progress)), COLUMNS)
    write_csv(snakemake.output.draws, drawn, draws.COLUMNS)
