"""Close and open the pads of a chunk of draws of the inputs.

In: inputs.csv.  Out: pad/draws/chunk_NNN.csv (MPa against nm).
"""

from mesoscale.device.release import DEVIATIONS, pressure_to_compute
from mesoscale.inputs.table import from_rows
from mesoscale.pad.draws import close_draws, draw_rows, plan_draws
from mesoscale.settings import DeviceSettings, PadSettings
from workflow.contact_settings import contact_settings
from workflow.job import job
from workflow.results import load_csv, write_csv

with job(snakemake) as run:
    contact = contact_settings(snakemake.params.contact, snakemake)
    pad = PadSettings(**snakemake.params.pad)
    draws = plan_draws(from_rows(load_csv(snakemake.input.inputs)), contact, pad)[slice(*snakemake.params.bounds)]
    wanted = pressure_to_compute(DeviceSettings(**snakemake.params.device), DEVIATIONS)
    laws = close_draws(draws, contact, pad, wanted, run.progress)
    write_csv(
        snakemake.output[0],
        [row for draw, law in zip(draws, laws, strict=True) for row in draw_rows(draw, law)],
    )
