"""Set every way to propagate the uncertainty against direct cycles as truth.

In: inputs.csv, law/parameters.csv, uq/direct, uq/replicate, uq/morris (chunks of runs), the paper's Table 3.
Out: uq/work_precision.csv, uq/bias.csv, uq/indices.csv, uq/morris.csv, accuracy/uncertainty.csv.
"""

import resource

import numpy as np

from mesoscale.inputs.table import from_rows
from mesoscale.settings import UncertaintySettings
from mesoscale.uncertainty.collocation import elementary_effects
from mesoscale.uncertainty.paper_tables import table3
from mesoscale.uncertainty.propagation import read_nodes
from mesoscale.uncertainty.reference import reference
from mesoscale.uncertainty.runs import OUTPUTS, short_name
from mesoscale.uncertainty.studies.brute_force import bias_rows, index_rows, morris_rows
from mesoscale.uncertainty.studies.precision import accuracy_rows, precision_rows
from mesoscale.uncertainty.validation import read_direct_runs
from workflow.job import job
from workflow.results import read_csv, write_csv


def read_runs(paths, names, count):
    """Inputs and law of the first `count` runs in files of chunks."""
    return read_direct_runs((row for path in paths for row in read_csv(path)), names, count)


with job(snakemake) as run:
    settings = UncertaintySettings(**snakemake.params.settings)
    table = from_rows(read_csv(snakemake.input.inputs))
    inputs = len(table.rows)
    nodes = read_nodes(read_csv(snakemake.input.parameters))
    direct = read_runs(snakemake.input.direct, table.names, settings.study_runs)
    _, replicates = read_runs(snakemake.input.replicate, table.names, settings.study_replicates)
    _, along = read_runs(snakemake.input.morris, table.names, settings.morris_trajectories * (inputs + 1))
    timings = [row for path in snakemake.input.timing for row in read_csv(path)]
    per_call = sum(float(row["engine_cpu_s"]) for row in timings) / sum(int(row["cycles"]) for row in timings)
    truth = reference(*direct, replicates)

    write_csv(snakemake.output.bias, bias_rows(nodes, direct, truth, table, settings))
    write_csv(snakemake.output.indices, index_rows(nodes, direct, truth, table, settings))
    stars = nodes.paper_outputs[:, : 2 * inputs + 1]
    one_star = {
        (output, name): float(np.nanmean([elementary_effects(line, inputs)[i] for line in stars[:, :, k]]))
        for k, output in enumerate(OUTPUTS)
        for i, name in enumerate(table.names)
    }
    printed = table3(read_csv(snakemake.input.table3))
    paper = {(output, name): value for output in OUTPUTS for name, value in printed.get(short_name(output), {}).items()}
    write_csv(snakemake.output.morris, morris_rows(along, table, settings, one_star, paper))
    rows = precision_rows(nodes, direct, truth, table, settings, per_call, run.progress)
    write_csv(snakemake.output.precision, rows)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    write_csv(snakemake.output.accuracy, list(accuracy_rows(rows, truth, peak)))
