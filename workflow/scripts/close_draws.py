"""Close and open the pads of a chunk of draws of the inputs.

In: pad/inputs.csv.  Out: pad/draws/chunk_NNN.csv (MPa against nm).
"""

from mesoscale.device.electrode import presser
from mesoscale.device.pressing import hardest, pressure_to_compute
from mesoscale.inputs.table import from_rows
from mesoscale.pad.draws import close_draws, draw_rows, plan_draws
from mesoscale.settings import DeviceSettings
from workflow.contact_settings import contact_settings
from workflow.job import job, settings_from_job
from workflow.results import load_csv, write_csv

with job(snakemake) as run:
    contact = contact_settings(snakemake.params.contact, snakemake)
    table, design = from_rows(load_csv(snakemake.input.inputs)), snakemake.params.design
    draws = plan_draws(table, contact, *design)[slice(*snakemake.params.bounds)]
    device = hardest(settings_from_job(DeviceSettings, snakemake.params.device))
    laws = close_draws(draws, contact, pressure_to_compute(device), presser(device), run.progress)
    write_csv(
        snakemake.output[0],
        [row for draw, law in zip(draws, laws, strict=True) for row in draw_rows(draw, law)],
    )
