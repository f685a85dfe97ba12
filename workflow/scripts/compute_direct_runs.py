"""Compute a chunk of direct contact cycles and keep their law.

In: inputs.csv.  Out: uncertainty/direct/chunk_NNN.csv, or chunk_again.csv with the same inputs on
other surfaces (inputs, seed, parameters of both branches, statuses).
"""

from mesoscale.inputs.table import from_rows
from mesoscale.uncertainty.designs import FIRST_RANDOM_SEED, FIRST_SECOND_SURFACE, random_runs
from mesoscale.uncertainty.runs import compute_rows
from workflow.files.results import load_csv, write_csv
from workflow.run.contact_settings import contact_settings
from workflow.run.job import job

with job(snakemake) as run:
    runs = random_runs(
        from_rows(load_csv(snakemake.input.inputs)),
        *snakemake.params.bounds,
        first_surface=FIRST_SECOND_SURFACE
        if snakemake.wildcards.chunk == "again"
        else FIRST_RANDOM_SEED,
    )
    contact = contact_settings(snakemake.params.contact, snakemake)
    write_csv(snakemake.output[0], compute_rows(runs, contact, run.progress))
