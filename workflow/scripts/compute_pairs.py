"""Compute a chunk of direct runs with both mechanics of the contact.

In: inputs.csv, topography/parameters.json where the surface is measured.
Out: uq/model_form/pairs_NNN.csv (inputs, seed; by mechanics the outputs, pull-off, stiffness, cost).
"""

from mesoscale.inputs.table import from_rows
from mesoscale.settings import LawSettings
from mesoscale.uncertainty.designs import random_runs
from mesoscale.uncertainty.model_form import pair_rows
from workflow.contact_settings import contact_settings
from workflow.job import job, settings_from_job
from workflow.results import load_csv, write_csv

with job(snakemake) as run:
    runs = random_runs(from_rows(load_csv(snakemake.input.inputs)), *snakemake.params.bounds)
    contact = contact_settings(snakemake.params.contact, snakemake)
    law = settings_from_job(LawSettings, snakemake.params.law)
    write_csv(snakemake.output[0], pair_rows(runs, contact, law, run.progress))
