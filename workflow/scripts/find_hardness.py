"""Hardness, or the reason why there is none, of each closing run.

In:  curves, witnesses (GPa, nm) and summaries of the runs.  Out: points.csv.
"""

from itertools import zip_longest

from atomistic.hardness.plateau import point
from atomistic.settings import HardnessSettings
from workflow.job import job
from workflow.results import read_json, read_numbers, write_csv

with job(snakemake) as run:
    files = zip(snakemake.input.curves, snakemake.input.witnesses, snakemake.input.summaries, strict=True)
    own_settings = [HardnessSettings.model_validate(values) for values in snakemake.params.settings]
    rows = []
    for (curve, witness, summary), settings, label in zip_longest(
        files, own_settings, snakemake.params.get("labels", []), fillvalue={}
    ):
        row = point(read_numbers(curve), read_numbers(witness), read_json(summary), settings)
        rows.append({**label, **row})
    write_csv(snakemake.output.points, rows, list(dict.fromkeys(key for row in rows for key in row)))
