"""Error of the release on the pad against run time, one numerical choice at a time.

In: pad/inputs.csv, pad/model.h5.  Out: accuracy/pad.csv (V, s).
"""

from mesoscale.studies.pad_accuracy import accuracy_points
from workflow.checks import accuracy_rows
from workflow.job import job
from workflow.pad_files import load_model, points_of_job
from workflow.results import write_csv

with job(snakemake) as run:
    points, pad = points_of_job(snakemake)
    model = load_model([snakemake.input.model], points)
    rows = accuracy_points(model, points.table, points.contact, pad.point_cells, run.progress)
    write_csv(snakemake.output[0], accuracy_rows("pad", rows))
