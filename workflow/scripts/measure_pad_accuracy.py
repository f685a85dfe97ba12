"""Error of the release on the pad against run time, one numerical choice at a time.

In: pad/inputs.csv, pad/grid.csv, pad/cells/*.h5 (nN).  Out: accuracy/pad.csv (V, s).
"""

from mesoscale.device.accuracy import accuracy_points
from mesoscale.inputs.contact import contact_of
from mesoscale.inputs.table import medians
from mesoscale.pad.cells import FIRST_SEED
from mesoscale.settings import DeviceSettings
from workflow.checks import accuracy_rows
from workflow.contact_settings import contact_settings
from workflow.job import job, settings_from_job
from workflow.pad_files import load_cells
from workflow.results import load_csv, write_csv

with job(snakemake) as run:
    inputs, contact = contact_of(
        medians(load_csv(snakemake.input.inputs)), contact_settings(snakemake.params.contact, snakemake)
    )
    cells = load_cells(snakemake.input.grid, snakemake.input.chunks, contact.length_nm**2)
    device = settings_from_job(DeviceSettings, snakemake.params.device)
    seeds = range(FIRST_SEED, FIRST_SEED + cells.count)
    write_csv(
        snakemake.output[0],
        accuracy_rows("pad", accuracy_points(cells, inputs, contact, device, seeds, run.progress)),
    )
