"""Find how often the switch fails, down to one in a million, and what is allowed of hold voltage, film and spring.

In: inputs.csv, pad/model.h5.  Out: device/failure.json, device/failure.csv (V).
"""

import numpy as np

from mesoscale.device.points import press_pad, surfaces_of
from mesoscale.failure.population import Population
from mesoscale.failure.rate import failure_rate
from mesoscale.settings import FailureSettings
from workflow.files.results import write_csv, write_json
from workflow.run.job import job, settings_from_job
from workflow.run.pads import load_model, points_of_job

with job(snakemake) as run:
    asked = settings_from_job(FailureSettings, snakemake.params.failure)
    points, pad = points_of_job(snakemake)
    model = load_model([snakemake.input.model], points)

    def press(point, times, number):
        surfaces = surfaces_of(100_000 + number)  # beyond those of the points of an answer
        return press_pad(point, points.on_grid, times * pad.point_cells, surfaces)

    pads = {k: one.pad for k, one in enumerate(model.points) if one.pad}
    known = points.design.probability[np.array(list(pads), int)], list(pads.values())
    population = Population(points.table, points.device, points.cutoffs_nm, asked.release_V, press, known)
    rate, rows = failure_rate(population, asked.probability, run.progress)
    write_json(snakemake.output.rate, rate, run.provenance)
    write_csv(snakemake.output.table, rows)
