"""Error of the release on the pad against run time, one numerical choice at a time.

In: inputs.csv, pad/grid.csv, pad/cells/*.h5 (nN), pad/draws/*.csv.  Out: accuracy/pad.csv (V, s).
"""

from mesoscale.device.studies.accuracy import accuracy_points
from mesoscale.inputs.contact import contact_of
from mesoscale.inputs.table import from_rows
from mesoscale.settings import DeviceSettings, PadSettings
from workflow.checks import accuracy_rows
from workflow.contact_settings import contact_settings
from workflow.job import job
from workflow.pad_files import load_cells, load_draws
from workflow.results import load_csv, write_csv

with job(snakemake) as run:
    table = from_rows(load_csv(snakemake.input.inputs))
    scene = contact_settings(snakemake.params.contact, snakemake)
    pad = PadSettings(**snakemake.params.pad)
    inputs, contact = contact_of(table.medians(), scene)
    points = accuracy_points(
        load_cells(snakemake.input.grid, snakemake.input.chunks, contact.length_nm**2),
        load_draws(snakemake.input.draws, table, scene, pad) if pad.draws else [],
        table,
        inputs,
        contact,
        DeviceSettings(**snakemake.params.device),
        range(pad.first_seed, pad.first_seed + snakemake.params.cells),
        run.progress,
    )
    write_csv(snakemake.output[0], accuracy_rows("pad", points))
