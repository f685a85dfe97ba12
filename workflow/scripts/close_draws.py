"""Close and open the pads of a chunk of draws of the inputs.

In: pad/inputs.csv.  Out: pad/draws/chunk_NNN.csv (MPa against nm).
"""

from mesoscale.device.pressing import LargestPressure
from mesoscale.inputs.table import from_rows
from mesoscale.pad.draws import close_draws, draw_rows, plan_draws
from workflow.contact_settings import contact_settings
from workflow.job import job
from workflow.results import load_csv, write_csv

with job(snakemake) as run:
    contact = contact_settings(snakemake.params.contact, snakemake)
    table, design = from_rows(load_csv(snakemake.input.inputs)), snakemake.params.design
    draws = plan_draws(table, contact, *design)[slice(*snakemake.params.bounds)]
    laws = close_draws(draws, contact, LargestPressure(**snakemake.params.pressure), run.progress)
    write_csv(
        snakemake.output[0],
        [row for draw, law in zip(draws, laws, strict=True) for row in draw_rows(draw, law)],
    )
