"""Compute a chunk of direct runs with both mechanics of the contact.

In: inputs.csv.  Out: uq/model_form/pairs_NNN.csv (inputs, seed; by mechanics the outputs, pull-off, stiffness, cost).
"""

from mesoscale.inputs.table import from_rows
from mesoscale.settings import ContactSettings, LawSettings, UncertaintySettings
from mesoscale.uncertainty.designs import random_runs
from mesoscale.uncertainty.studies.model_form import pair_rows
from workflow.job import job
from workflow.results import load_csv, write_csv

with job(snakemake) as run:
    runs = random_runs(
        from_rows(load_csv(snakemake.input.inputs)),
        UncertaintySettings(**snakemake.params.uncertainty),
        *snakemake.params.bounds,
    )
    rows = pair_rows(
        runs, ContactSettings(**snakemake.params.contact), LawSettings(**snakemake.params.law), run.progress
    )
    write_csv(snakemake.output[0], list(rows))
