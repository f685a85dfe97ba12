"""Find how often the switch fails, down to one in a million, and the largest hold voltage that is allowed.

In: pad/inputs.csv, pad/grid.csv, pad/cells/*.h5 (nN), pad/draws/*.csv.
Out: device/failure.json, device/failure.csv (V).
"""

from mesoscale.device.failure import Population, failure_rate
from mesoscale.device.release import cutoff_range, model_of
from mesoscale.errors import InputError
from mesoscale.inputs.contact import contact_of
from mesoscale.inputs.table import from_rows
from mesoscale.pad.memory import flats_of
from mesoscale.settings import DeviceSettings, FailureSettings
from workflow.contact_settings import contact_settings
from workflow.job import job, settings_from_job
from workflow.pad_files import load_cells, load_draws
from workflow.results import load_csv, write_csv, write_json

with job(snakemake) as run:
    asked = settings_from_job(FailureSettings, snakemake.params.failure)
    if asked.probability is None:
        raise InputError("failure.probability = null: give the share of the switches that may fail, such as 1e-6")
    contact = contact_settings(snakemake.params.contact, snakemake)
    device = settings_from_job(DeviceSettings, snakemake.params.device)
    inputs = from_rows(load_csv(snakemake.input.inputs))
    middle, central = contact_of(inputs.medians(), contact)
    flats, cutoff, area = flats_of(middle, central), central.gap_cutoff_nm, contact.length_nm**2
    cells = load_cells(snakemake.input.grid, snakemake.input.chunks, area)
    draws = load_draws(snakemake.input.draws, inputs, contact, *snakemake.params.design)
    model = model_of(cells, draws, inputs, flats, cutoff)
    population = Population(inputs, device, cutoff_range(cutoff, draws), model, asked.release_V)
    rate, rows = failure_rate(population, cells, flats, asked.probability, area, run.progress)
    write_json(snakemake.output.rate, rate, run.provenance)
    write_csv(snakemake.output.table, rows)
