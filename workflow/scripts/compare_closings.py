"""Hardness against loading rate, time step, wall, temperature, thickness and the definition of area.

In:  accuracy/hardness/VARIATION/RUN.{csv,witness.csv,json}.  Out: accuracy/hardness.csv.
"""

from pathlib import Path

from atomistic.hardness.studies.variations import compare
from atomistic.settings import HardnessSettings
from workflow.checks import accuracy_rows
from workflow.job import job
from workflow.results import load_json, load_numbers, write_csv

with job(snakemake) as run:
    paths = {Path(path).parent.name: Path(path) for path in snakemake.input.summaries}
    points = compare(
        {name: load_numbers(path.with_suffix(".csv")) for name, path in paths.items()},
        {name: load_numbers(path.with_suffix(".witness.csv")) for name, path in paths.items()},
        {name: load_json(path) for name, path in paths.items()},
        HardnessSettings(**snakemake.params.settings),
    )
    write_csv(snakemake.output.table, accuracy_rows("hardness", points))
