"""Narrow the properties of the device by what was measured of it.

In: nothing but the scene. Out: pad/measured.h5 (draws of the posterior).
"""

from mesoscale.settings import DeviceSettings
from workflow.run.job import job, settings_from_job
from workflow.run.measured_device import write_measured

with job(snakemake) as run:
    device = settings_from_job(DeviceSettings, snakemake.params.device)
    posterior = write_measured(snakemake.output[0], device, run.provenance)
    if posterior.doubt:
        run.say(posterior.doubt)
