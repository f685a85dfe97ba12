"""Error of the contact curve against run time, one numerical choice at a time.

In: inputs.csv.  Out: accuracy/contact.csv.
"""

from mesoscale.inputs.contact import contact_of
from mesoscale.inputs.table import medians
from mesoscale.studies.contact_accuracy import accuracy_points
from workflow.checks import accuracy_rows
from workflow.contact_settings import contact_settings
from workflow.job import job
from workflow.results import load_csv, write_csv

with job(snakemake) as run:
    central = medians(load_csv(snakemake.input.inputs))
    inputs, settings = contact_of(central, contact_settings(snakemake.params.settings, snakemake))
    points = accuracy_points(inputs, settings, run.progress)
    write_csv(snakemake.output[0], accuracy_rows("contact", points))
