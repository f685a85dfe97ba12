"""Measure the error of the regression against the direct runs behind it.

In: inputs.csv, uq/direct/chunk_NNN.csv.  Out: accuracy/uncertainty.csv.
"""

from mesoscale.inputs.table import from_rows
from mesoscale.settings import UncertaintySettings
from mesoscale.studies.law_accuracy import accuracy_points
from mesoscale.uncertainty.validation import direct_runs_of_rows
from workflow.checks import accuracy_rows
from workflow.contact_settings import contact_settings
from workflow.job import job, settings_from_job
from workflow.results import load_csv, write_csv

with job(snakemake) as run:
    settings = settings_from_job(UncertaintySettings, snakemake.params.settings)
    table = from_rows(load_csv(snakemake.input.inputs))
    rows = (row for path in snakemake.input.direct for row in load_csv(path))
    direct = direct_runs_of_rows(rows, table.names, settings.direct_runs)
    contact = contact_settings(snakemake.params.contact, snakemake)
    points = accuracy_points(direct, table, contact, settings)
    write_csv(snakemake.output[0], accuracy_rows("uncertainty", points))
