"""Narrow the rates of charging by a drift that was measured.

In: the table of drift (V, s), inputs.csv, pad/model.h5.  Out: lifetime/rates.csv (draws of the
posterior), lifetime/rates.json (before and after, and three draws that stand for it).
"""

from mesoscale.calibration.drift import drift_json, rate_rows, rates_by_drift
from mesoscale.calibration.measurements import load_measurements
from mesoscale.settings import LifetimeSettings, MeasurementsSettings
from workflow.files.results import write_csv, write_json
from workflow.run.job import job, settings_from_job
from workflow.run.pads import load_model, points_of_job

with job(snakemake) as run:
    points, _ = points_of_job(snakemake)
    settings = settings_from_job(LifetimeSettings, snakemake.params.lifetime)
    table = settings_from_job(MeasurementsSettings, snakemake.params.measurements).drift
    assert table is not None
    data = load_measurements(table, snakemake.input.drift)
    central = load_model([snakemake.input.model], points).central
    drift, guesses = rates_by_drift(data, central, points.on_grid, settings, run.progress)
    write_csv(snakemake.output.draws, rate_rows(drift))
    write_json(snakemake.output.rates, drift_json(drift, guesses), run.provenance)
