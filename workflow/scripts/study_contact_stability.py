"""Extreme cases and random draws of the contact model, judged by invariants.

In: stability/contact_draws/chunk_*.csv.  Out: stability/contact.csv, stability/contact_draws.csv (all draws).
"""

from mesoscale.contact.studies import draws
from mesoscale.contact.studies.stability import stability_checks
from mesoscale.settings import ContactSettings
from workflow.checks import stability_rows
from workflow.job import job
from workflow.results import load_csv, write_csv

with job(snakemake) as run:
    settings = ContactSettings(**snakemake.params.settings)
    drawn = [row for chunk in snakemake.input.draws for row in load_csv(chunk)]
    checks = stability_checks(settings, drawn)
    write_csv(snakemake.output.table, stability_rows("contact", checks, run.progress))
    write_csv(snakemake.output.draws, drawn, draws.COLUMNS)
