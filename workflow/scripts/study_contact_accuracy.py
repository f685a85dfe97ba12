"""Error of the contact curve against run time, one numerical knob at a time.  Out: accuracy/contact.csv."""

from mesoscale.contact.studies.accuracy import accuracy_points
from mesoscale.contact.studies.stability import MIDDLE
from mesoscale.settings import ContactSettings
from workflow.checks import accuracy_rows
from workflow.job import job
from workflow.results import write_csv

with job(snakemake) as run:
    settings = ContactSettings(**snakemake.params.settings)
    points = accuracy_points(MIDDLE, settings, run.progress)
    write_csv(snakemake.output[0], accuracy_rows("contact", points))
