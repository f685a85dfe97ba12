"""Compute the nodes of one surface under one reading of the contact model and all readings of the law.

In: inputs.csv.  Out: audit/runs/READING_SEED.csv.
"""

from mesoscale.inputs.table import from_rows
from mesoscale.settings import LawSettings, UncertaintySettings
from mesoscale.uncertainty.chunks import node_count
from mesoscale.uncertainty.designs import collocation_runs
from mesoscale.uncertainty.studies.audit import AUDIT_COLUMNS, audit_rows
from workflow.contact_settings import contact_settings
from workflow.job import job
from workflow.results import load_csv, write_csv

with job(snakemake) as run:
    table = from_rows(load_csv(snakemake.input.inputs))
    count = node_count(len(table.rows), 1)
    first = int(snakemake.wildcards.seed) * count
    runs = collocation_runs(table, UncertaintySettings(**snakemake.params.uncertainty), first, first + count)
    rows = audit_rows(
        snakemake.wildcards.reading,
        runs,
        contact_settings(snakemake.params.contact, snakemake),
        LawSettings(**snakemake.params.law),
        run.progress,
    )
    write_csv(snakemake.output[0], rows, AUDIT_COLUMNS)
