"""Hardness, or the reason why there is none, of each closing run.

In:  curves, witnesses (GPa, nm) and summaries of the runs.  Out: points.csv.
"""

from itertools import zip_longest

from atomistic.hardness import point
from atomistic.settings import HardnessSettings
from workflow.job import job
from workflow.results import read_csv, read_json, write_csv


def numbers(path):
    return [{name: float(value or "nan") for name, value in row.items()} for row in read_csv(path)]


with job(snakemake) as run:
    files = zip(snakemake.input.curves, snakemake.input.witnesses, snakemake.input.summaries, strict=True)
    own_settings = [HardnessSettings.model_validate(values) for values in snakemake.params.settings]
    rows = []
    for (curve, witness, summary), settings, label in zip_longest(
        files, own_settings, snakemake.params.get("labels", []), fillvalue={}
    ):
        row = point(numbers(curve), numbers(witness), read_json(summary), settings)
        rows.append({**label, **row})
    write_csv(snakemake.output.points, rows)
