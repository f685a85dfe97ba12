"""The switch against humidity, at central inputs and over the points of the pad.

In: inputs.csv, pad/model.h5.  Out: humidity/humidity.csv (V, mJ/m^2, kPa).
"""

from mesoscale.answer.humidity import humidity_rows
from workflow.files.results import write_csv
from workflow.run.job import job
from workflow.run.pads import load_model, points_of_job

with job(snakemake) as run:
    points, pad = points_of_job(snakemake)
    model = load_model([snakemake.input.model], points)
    rows = humidity_rows(model, points.table, points.on_grid, pad.point_cells, run.progress)
    write_csv(snakemake.output[0], rows)
