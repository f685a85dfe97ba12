"""Hardness against loading rate, time step, wall, temperature and thickness of the base.

In:  accuracy/hardness/VARIATION/RUN.{csv,witness.csv,json}.  Out: accuracy/hardness.csv.
"""

from pathlib import Path

from atomistic.hardness.studies import compare
from atomistic.settings import ClosingSettings
from workflow.files.results import load_json, load_numbers, write_csv
from workflow.run.job import job, settings_from_job
from workflow.run.studies import accuracy_rows

with job(snakemake) as run:
    paths = {Path(path).parent.name: Path(path) for path in snakemake.input.summaries}
    points = compare(
        {name: load_numbers(path.with_suffix(".csv")) for name, path in paths.items()},
        {name: load_numbers(path.with_suffix(".witness.csv")) for name, path in paths.items()},
        {name: load_json(path) for name, path in paths.items()},
        settings_from_job(ClosingSettings, snakemake.params.closing),
    )
    write_csv(snakemake.output.table, accuracy_rows("hardness", points))
