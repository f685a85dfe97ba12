"""Sample the posterior of the inputs, given the scene's measurements.

In: the tables of measurements, calibration/priors.csv, calibration/cycles/chunk_NNN.csv; with
voltages of switches calibration/pads/chunk_NNN.h5 (GPa against nm; V). Out:
calibration/posterior.json, samples.csv, summary.csv (prior and posterior of the inputs),
predictive.csv (what the next surface and switch show).
"""

from mesoscale.calibration.measurements import load_measurements
from mesoscale.calibration.observables import cycles_of_rows
from mesoscale.calibration.posterior import Model, calibrate
from mesoscale.calibration.summary import (
    checks,
    posterior_json,
    predictive_rows,
    sample_rows,
    summary_rows,
)
from mesoscale.calibration.voltages import fit_voltages
from mesoscale.inputs.table import from_rows
from mesoscale.settings import MeasurementsSettings
from workflow.files.results import load_csv, write_csv, write_json
from workflow.run.contact_settings import contact_settings
from workflow.run.job import job, settings_from_job
from workflow.run.pads import load_model, points_of_job

with job(snakemake) as run:
    settings = settings_from_job(MeasurementsSettings, snakemake.params.settings)
    contact = contact_settings(snakemake.params.contact, snakemake)
    tables = [load_measurements(table, snakemake.input[table.kind]) for table in settings.of_inputs]
    prior = from_rows(load_csv(snakemake.input.priors))
    rows = [row for path in snakemake.input.cycles for row in load_csv(path)]
    voltages = {}
    if pads := snakemake.input.get("pads"):
        voltages = fit_voltages(load_model(pads, points_of_job(snakemake)[0]), prior)
    model = Model(prior, cycles_of_rows(rows, prior.names), voltages, contact.max_force_nN)
    result = calibrate(tables, model, contact, run.progress)
    write_csv(snakemake.output.predictive, predictive_rows(result))
    write_csv(snakemake.output.summary, summary_rows(result))
    write_csv(snakemake.output.samples, sample_rows(result))
    agreement = checks(result) if result.chain.converged else {}
    write_json(snakemake.output.posterior, posterior_json(result, agreement), run.provenance)
