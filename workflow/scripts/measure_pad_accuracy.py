"""Error of the release on the pad against run time, one numerical choice at a time.

In: pad/inputs.csv, pad/model.h5.  Out: accuracy/pad.csv (V, s).
"""

from mesoscale.device.accuracy import accuracy_points
from mesoscale.settings import DeviceSettings, PadSettings
from workflow.checks import accuracy_rows
from workflow.contact_settings import contact_settings
from workflow.job import job, settings_from_job
from workflow.pad_files import load_model, points_of
from workflow.results import write_csv

with job(snakemake) as run:
    contact = contact_settings(snakemake.params.contact, snakemake)
    device = settings_from_job(DeviceSettings, snakemake.params.device)
    pad = settings_from_job(PadSettings, snakemake.params.pad)
    points = points_of(snakemake.input.inputs, contact, device, pad.points)
    model = load_model([snakemake.input.model], points)
    rows = accuracy_points(model, points.table, contact, pad.point_cells, run.progress)
    write_csv(snakemake.output[0], accuracy_rows("pad", rows))
