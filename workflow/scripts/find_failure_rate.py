"""Find how often the switch fails, down to one in a million, and the largest hold voltage that is allowed.

In: pad/inputs.csv, pad/grid.csv, pad/cells/*.h5 (nN), pad/draws/*.csv.
Out: device/failure.json, device/failure.csv (V).
"""

from mesoscale.device.failure import Population, failure_rate
from mesoscale.errors import InputError
from mesoscale.settings import DeviceSettings, FailureSettings
from workflow.contact_settings import contact_settings
from workflow.job import job, settings_from_job
from workflow.pad_files import load_spread
from workflow.results import write_csv, write_json

with job(snakemake) as run:
    asked = settings_from_job(FailureSettings, snakemake.params.failure)
    if asked.probability is None:
        raise InputError("failure.probability = null: give the share of the switches that may fail, such as 1e-6")
    contact = contact_settings(snakemake.params.contact, snakemake)
    device = settings_from_job(DeviceSettings, snakemake.params.device)
    pad = load_spread(snakemake, contact)
    population = Population(pad.inputs, device, pad.cutoffs_nm, pad.model, asked.release_V)
    rate, rows = failure_rate(population, pad.cells, pad.flats, asked.probability, contact.length_nm**2, run.progress)
    write_json(snakemake.output.rate, rate, run.provenance)
    write_csv(snakemake.output.table, rows)
