"""Hardness, or the reason why there is none, of each closing run.

In:  curves, witnesses (GPa, nm) and summaries of the runs.  Out: points.csv.
"""

from atomistic.hardness.plateau import point
from atomistic.settings import HardnessSettings
from workflow.job import job
from workflow.results import read_json, read_numbers, write_csv

with job(snakemake) as run:
    files = zip(snakemake.input.curves, snakemake.input.witnesses, snakemake.input.summaries, strict=True)
    settings_of_runs = [HardnessSettings.model_validate(values) for values in snakemake.params.settings]
    labels = snakemake.params.get("labels") or [{}] * len(settings_of_runs)
    rows = []
    for (curve, witness, summary), settings, label in zip(files, settings_of_runs, labels, strict=True):
        row = point(read_numbers(curve), read_numbers(witness), read_json(summary), settings)
        rows.append({**label, **row})
    write_csv(snakemake.output.points, rows, list(dict.fromkeys(key for row in rows for key in row)))
