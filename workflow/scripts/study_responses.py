"""Set every way to propagate the uncertainty against direct cycles as truth.

In: inputs.csv, law/parameters.csv, uq/direct, uq/replicate, uq/morris (chunks of runs), the paper's Table 3.
Out: uq/work_precision.csv, uq/bias.csv, uq/indices.csv, uq/morris.csv, accuracy/uncertainty.csv.
"""

from mesoscale.inputs.table import from_rows
from mesoscale.settings import UncertaintySettings
from mesoscale.uncertainty.paper_tables import table3
from mesoscale.uncertainty.propagation import nodes_of_rows
from mesoscale.uncertainty.studies.comparison import compare_with_direct_runs
from mesoscale.uncertainty.validation import direct_runs_of_rows
from workflow.checks import accuracy_rows
from workflow.job import job
from workflow.results import load_csv, write_csv


def rows_of(paths):
    """Rows of all chunks of a design."""
    return [row for path in paths for row in load_csv(path)]


with job(snakemake) as run:
    settings = UncertaintySettings(**snakemake.params.settings)
    table = from_rows(load_csv(snakemake.input.inputs))
    steps = settings.morris_trajectories * (len(table.rows) + 1)
    tables = compare_with_direct_runs(
        nodes_of_rows(load_csv(snakemake.input.parameters)),
        direct_runs_of_rows(rows_of(snakemake.input.direct), table.names, settings.study_runs),
        direct_runs_of_rows(rows_of(snakemake.input.replicate), table.names, settings.study_replicates)[1],
        direct_runs_of_rows(rows_of(snakemake.input.morris), table.names, steps)[1],
        rows_of(snakemake.input.timing),
        table,
        settings,
        table3(load_csv(snakemake.input.table3)),
        run.progress,
    )
    tables["accuracy"] = list(accuracy_rows("uncertainty", tables["accuracy"]))
    for name, rows in tables.items():
        write_csv(snakemake.output[name], rows)
