"""Error of the contact curve against run time, one numerical knob at a time, and what cut-off and grid do to the law.

In: inputs.csv.  Out: accuracy/contact.csv, uq/cutoff.csv (means; nm, GPa nm, GPa, nN).
"""

from mesoscale.contact.studies.accuracy import accuracy_points
from mesoscale.inputs.contact import contact_of
from mesoscale.inputs.table import medians
from mesoscale.settings import LawSettings
from mesoscale.uncertainty.cutoff import scene_rows
from workflow.checks import accuracy_rows
from workflow.contact_settings import contact_settings
from workflow.job import job
from workflow.results import load_csv, write_csv

with job(snakemake) as run:
    central = medians(load_csv(snakemake.input.inputs))
    inputs, settings = contact_of(central, contact_settings(snakemake.params.settings, snakemake))
    points = accuracy_points(inputs, settings, run.progress)
    write_csv(snakemake.output.accuracy, accuracy_rows("contact", points))
    law = LawSettings(**snakemake.params.law)
    write_csv(snakemake.output.cutoff, scene_rows(inputs, settings, law, run.progress))
