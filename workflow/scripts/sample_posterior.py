"""Sample the posterior of the inputs, given the scene's measurements.

In: the tables of measurements, calibration/priors.csv, calibration/cycles/chunk_NNN.csv.
Out: calibration/posterior.json, and what it means: samples.csv, summary.csv (prior and posterior of the inputs),
learned.csv (bits, contradictions), next.csv (what to measure), predictive.csv, responses.csv (their error),
local_cycles.csv (where the posterior lies).
"""

from mesoscale.calibration.further import next_measurements
from mesoscale.calibration.learning import check_range, learned, outliers
from mesoscale.calibration.measurements import load_measurements
from mesoscale.calibration.posterior import calibrate, cycles_of_rows, response_remarks
from mesoscale.calibration.summary import posterior_json, predictive_rows, sample_rows, summary_rows
from mesoscale.calibration.switches import SwitchModel
from mesoscale.inputs.table import from_rows
from mesoscale.settings import DeviceSettings, MeasurementsSettings
from workflow.contact_settings import contact_settings
from workflow.job import job, settings_from_job
from workflow.results import load_csv, write_csv, write_json

with job(snakemake) as run:
    settings = settings_from_job(MeasurementsSettings, snakemake.params.settings)
    contact = contact_settings(snakemake.params.contact, snakemake)
    tables = [load_measurements(table, snakemake.input[table.kind]) for table in settings.tables]
    prior = from_rows(load_csv(snakemake.input.priors))
    rows = [row for path in snakemake.input.cycles for row in load_csv(path)]
    cycles = cycles_of_rows(rows, prior.names)
    device = settings_from_job(DeviceSettings, snakemake.params.device)
    switch = SwitchModel.of(device, contact.length_nm**2)
    check_range(tables, prior, cycles, contact.max_force_nN, switch)
    result = calibrate(prior, tables, cycles, contact, device, settings, run.progress)

    write_csv(snakemake.output.responses, result.checks)
    write_csv(snakemake.output.local_cycles, result.added)
    converged = result.chain.converged
    lessons = learned(result, tables, contact.max_force_nN) if converged else []
    write_csv(snakemake.output.learned, lessons)
    further = next_measurements(result, contact.max_force_nN) if converged else []
    write_csv(snakemake.output.next, further)
    write_csv(snakemake.output.predictive, predictive_rows(result, contact.max_force_nN))
    write_csv(snakemake.output.summary, summary_rows(result))
    write_csv(snakemake.output.samples, sample_rows(result))
    remarks = [*outliers(result), *response_remarks(result)] if converged else []
    content = posterior_json(result, tables, lessons, remarks)
    write_json(snakemake.output.posterior, content, run.provenance)
