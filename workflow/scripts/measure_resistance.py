"""Measure the electrical resistance of surfaces that close, open and close again, each with its own inputs.

In: inputs.csv.  Out: device/resistance.csv (nN, N/m, nm^2, Ohm).
"""

from mesoscale.device.resistance import resistance_rows
from mesoscale.inputs.table import from_rows
from mesoscale.settings import ResistanceSettings
from workflow.files.results import load_csv, write_csv
from workflow.run.contact_settings import contact_settings
from workflow.run.job import job, settings_from_job

with job(snakemake) as run:
    asked = settings_from_job(ResistanceSettings, snakemake.params.resistance)
    contact = contact_settings(snakemake.params.contact, snakemake)
    table = from_rows(load_csv(snakemake.input.inputs))
    write_csv(snakemake.output[0], resistance_rows(table, contact, asked, run.progress))
