"""Random draws of Table 1 on three surfaces each, judged by invariants.  Out: stability/contact_draws/chunk_*.csv."""

from mesoscale.contact.studies.draws import COLUMNS, draw_rows
from mesoscale.settings import ContactSettings
from workflow.job import job
from workflow.results import write_csv

with job(snakemake) as run:
    settings = ContactSettings(**snakemake.params.settings)
    rows = draw_rows(int(snakemake.wildcards.draws), settings, run.progress)
    write_csv(snakemake.output[0], list(rows), COLUMNS)
