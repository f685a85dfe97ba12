"""Choose the separations and depths that all cells of the pad share.  In: pad/inputs.csv.  Out: pad/grid.csv (nm)."""

from mesoscale.device.electrode import presser
from mesoscale.device.pressing import pressure_to_compute
from mesoscale.inputs.contact import contact_of
from mesoscale.inputs.table import medians
from mesoscale.pad.cells import plan_grid
from mesoscale.settings import DeviceSettings, PadGridSettings
from workflow.contact_settings import contact_settings
from workflow.job import job, settings_from_job
from workflow.results import load_csv, write_csv

with job(snakemake) as run:
    inputs, contact = contact_of(
        medians(load_csv(snakemake.input.inputs)), contact_settings(snakemake.params.contact, snakemake)
    )
    settings = settings_from_job(PadGridSettings, snakemake.params.grid)
    device = settings_from_job(DeviceSettings, snakemake.params.device)
    grid = plan_grid(inputs, contact, settings, pressure_to_compute(device), pressed_GPa=presser(device))
    depths = set(grid.depths.tolist())
    rows = [
        {"separation_nm": float(separation), "opened_from": int(place in depths)}
        for place, separation in enumerate(grid.separation_nm)
    ]
    write_csv(snakemake.output[0], rows)
