"""Assemble the pad from its points.

In: inputs.csv, pad/points/*.h5 (GPa against nm; V). Out: pad/model.h5, pad/inputs.csv (with the
film's typical place, and how much places differ), pad/curves.csv (MPa against nm).
"""

from mesoscale.inputs.table import to_rows
from mesoscale.pad.pressed import curve_rows
from workflow.files.results import write_csv
from workflow.run.job import job
from workflow.run.pads import load_model, points_of_job, write_solved

with job(snakemake) as run:
    points, _ = points_of_job(snakemake)
    model = load_model(snakemake.input.chunks, points)
    pad = model.central.pressed
    write_csv(snakemake.output.inputs, to_rows(points.table))
    write_solved(
        snakemake.output.model,
        dict(enumerate((model.central, *model.points))),
        run.provenance,
        points.design,
    )
    write_csv(snakemake.output.table, curve_rows(pad))
