"""Hardness, or the reason why there is none, of each closing run.

In:  curves, witnesses (GPa, nm) and summaries of the runs.  Out: points.csv.
"""

from atomistic.hardness.plateau import point
from atomistic.settings import ClosingSettings
from workflow.job import job, settings_from_job
from workflow.results import load_json, load_numbers, write_csv

with job(snakemake) as run:
    closing = settings_from_job(ClosingSettings, snakemake.params.closing)
    files = zip(snakemake.input.curves, snakemake.input.witnesses, snakemake.input.summaries, strict=True)
    rows = [
        point(load_numbers(curve), load_numbers(witness), load_json(summary), closing, snakemake.params.potential)
        for curve, witness, summary in files
    ]
    write_csv(snakemake.output.points, rows)
