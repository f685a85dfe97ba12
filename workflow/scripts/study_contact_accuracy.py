"""Error of the contact curve against run time, one numerical knob at a time.  Out: accuracy/contact.csv."""

from mesoscale.contact.studies.accuracy import COLUMNS, accuracy_rows
from mesoscale.contact.studies.stability import MIDDLE
from mesoscale.settings import ContactSettings
from workflow.job import job
from workflow.results import write_csv

with job(snakemake) as run:
    settings = ContactSettings(**snakemake.params.settings)
    write_csv(snakemake.output[0], list(accuracy_rows(MIDDLE, settings, run.progress)), COLUMNS)
