"""Rank what to measure next for the switch on the pad.

In: calibration/priors.csv, inputs.csv, pad/model.h5, calibration/cycles/chunk_NNN.csv,
calibration/local_cycles.csv.
Out: calibration/next_on_pad.csv (V), without rows where too few switches on the pad have an answer.
"""

from functools import partial

import numpy as np

from mesoscale.calibration.further import next_on_pad
from mesoscale.calibration.likelihood import posterior_of
from mesoscale.calibration.posterior import cycles_of_rows, expected_of, responses_of
from mesoscale.inputs.table import from_rows
from workflow.job import job
from workflow.pad_files import load_model, points_of_job
from workflow.results import load_csv, write_csv

SOLVED_TO_RANK = 0.5
"""Least share of the points with an answer; made-up data leave a tenth to a half of them with weight."""

with job(snakemake) as run:
    points, _ = points_of_job(snakemake)
    prior = from_rows(load_csv(snakemake.input.priors))
    rows = [row for path in (*snakemake.input.cycles, snakemake.input.local_cycles) for row in load_csv(path)]
    cycles = cycles_of_rows(rows, prior.names)
    model = load_model([snakemake.input.model], points)
    responses, laws = responses_of(prior, cycles)
    given = partial(
        posterior_of,
        prior,
        responses=responses,
        law_responses=laws,
        switch=None,
        max_force_nN=points.contact.max_force_nN,
        expected=expected_of(cycles),
    )
    ranked, volts = [], model.states("release_V")
    if len(volts) > SOLVED_TO_RANK * len(model.points):
        # how places differ is no input of a cell
        x = np.array([[model.points[k].point.values[name] for name in prior.names] for k in model.solved])
        ranked = next_on_pad(given, responses, x, volts, points.contact.max_force_nN)
        ranked = [{**row, "solved": len(volts), "refused": len(model.refused)} for row in ranked]
    write_csv(snakemake.output[0], ranked)
