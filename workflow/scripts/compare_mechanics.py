"""What it changes that asperities feel each other.  In: uq/model_form/pairs_*.csv.  Out: uq/model_form.csv."""

from mesoscale.uncertainty.model_form import shift_rows
from workflow.job import job
from workflow.results import load_csv, write_csv

with job(snakemake) as run:
    rows = [row for chunk in snakemake.input for row in load_csv(chunk)]
    write_csv(snakemake.output[0], shift_rows(rows))
