"""Rank the inputs: elementary effects beside the paper's Table 3, and Sobol' indices with intervals.

In: inputs.csv, law/parameters.csv, uq/direct/chunk_NNN.csv, uq/outputs.csv (the seeds' share of the
variance), the paper's Table 3.
Out: uq/sensitivity.csv.
"""

import numpy as np

from mesoscale.inputs.table import from_rows
from mesoscale.settings import UncertaintySettings
from mesoscale.uncertainty.paper_tables import table3
from mesoscale.uncertainty.propagation import nodes_of_rows
from mesoscale.uncertainty.sensitivity import sensitivity_rows
from mesoscale.uncertainty.validation import direct_runs_of_rows
from workflow.job import job, settings_from_job
from workflow.results import load_csv, write_csv

with job(snakemake) as run:
    settings = settings_from_job(UncertaintySettings, snakemake.params.settings)
    table = from_rows(load_csv(snakemake.input.inputs))
    paper = load_csv(snakemake.input.table3)
    rows = sensitivity_rows(
        nodes_of_rows(load_csv(snakemake.input.parameters)),
        table,
        settings,
        np.array([float(row["seed_share"] or "nan") for row in load_csv(snakemake.input.outputs)]),
        table3(paper),
        table3(paper, as_printed=True),
        direct_runs_of_rows(
            (row for path in snakemake.input.direct for row in load_csv(path)), table.names, settings.direct_runs
        ),
    )
    write_csv(snakemake.output[0], rows)
