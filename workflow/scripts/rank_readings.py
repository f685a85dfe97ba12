"""Rank the readings of the paper by their distance to its Tables 2 and 3.

In: inputs.csv, audit/runs/*.csv, the paper's Tables 2 and 3.  Out: audit/ranking.csv.
"""

from mesoscale.inputs.table import from_rows
from mesoscale.uncertainty.paper_tables import table2, table3
from mesoscale.uncertainty.studies.audit import rank
from workflow.job import job
from workflow.results import load_csv, write_csv

with job(snakemake) as run:
    rows = [row for path in snakemake.input.runs for row in load_csv(path)]
    two, three = load_csv(snakemake.input.table2), load_csv(snakemake.input.table3)
    ranked = rank(
        rows,
        from_rows(load_csv(snakemake.input.inputs)),
        snakemake.params.central_share,
        [table2(two), table2(two, exchanged=True)],
        [table3(three), table3(three, exchange_changes=True)],
    )
    write_csv(snakemake.output[0], ranked)
