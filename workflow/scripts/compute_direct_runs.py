"""Compute a chunk of direct contact cycles, each with its own inputs and surface, and keep their law.

In: inputs.csv.  Out: uq/direct/chunk_NNN.csv (inputs, seed, parameters of both branches, statuses).
"""

from mesoscale.settings import ContactSettings, LawSettings, UncertaintySettings
from mesoscale.uncertainty.inputs import from_rows
from mesoscale.uncertainty.runs import compute_rows, random_runs
from workflow.job import job
from workflow.results import read_csv, write_csv

with job(snakemake) as run:
    runs = random_runs(
        from_rows(read_csv(snakemake.input.inputs)),
        UncertaintySettings(**snakemake.params.uncertainty),
        *snakemake.params.bounds,
    )
    rows = compute_rows(
        runs, ContactSettings(**snakemake.params.contact), LawSettings(**snakemake.params.law), run.progress
    )
    write_csv(snakemake.output[0], rows)
