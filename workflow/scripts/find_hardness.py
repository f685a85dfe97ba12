"""Hardness, or the reason why there is none, of each closing run.

In:  curves, witnesses (GPa, nm) and summaries of the runs.  Out: points.csv.
"""

from atomistic.hardness.plateau import point
from atomistic.settings import HardnessSettings
from workflow.job import job
from workflow.results import load_json, load_numbers, write_csv

with job(snakemake) as run:
    files = zip(snakemake.input.curves, snakemake.input.witnesses, snakemake.input.summaries, strict=True)
    settings_of_runs = [HardnessSettings.model_validate(values) for values in snakemake.params.settings]
    labels = snakemake.params.get("labels") or [{}] * len(settings_of_runs)
    rows = []
    for (curve, witness, summary), settings, label in zip(files, settings_of_runs, labels, strict=True):
        row = point(load_numbers(curve), load_numbers(witness), load_json(summary), settings)
        rows.append({**label, **row})
    write_csv(snakemake.output.points, rows, list(dict.fromkeys(key for row in rows for key in row)))
