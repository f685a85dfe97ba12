"""Close and open surfaces again and again at the medians of the inputs, held closed under creep if
asked.

In: inputs.csv.  Out: history/cycles.csv (nm, nN), history/dwell.csv (s, nm).
"""

from mesoscale.history.cycles import cycle_row, dwell_rows, follow_all
from mesoscale.inputs.contact import contact_of
from mesoscale.inputs.table import medians
from mesoscale.settings import HistorySettings
from workflow.files.results import load_csv, write_csv
from workflow.run.contact_settings import contact_settings
from workflow.run.job import job, settings_from_job

with job(snakemake) as run:
    settings = settings_from_job(HistorySettings, snakemake.params.settings)
    contact = contact_settings(snakemake.params.contact, snakemake)
    inputs, contact = contact_of(medians(load_csv(snakemake.input.inputs)), contact)
    cycles = []
    dwell = []
    for seed, held in follow_all(inputs, contact, settings, run.progress):
        cycles.append(cycle_row(seed, held))
        dwell += dwell_rows(seed, held, contact, settings)
    write_csv(snakemake.output.cycles, cycles)
    write_csv(snakemake.output.dwell, dwell)
