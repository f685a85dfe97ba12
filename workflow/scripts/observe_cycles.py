"""Compute a chunk of contact cycles over the prior and keep what can be measured of them.

In: calibration/priors.csv.  Out: calibration/cycles/chunk_NNN.csv (inputs, seed, observables; nm,
nN, GPa).
"""

from mesoscale.calibration.observables import observe_runs
from mesoscale.calibration.posterior import FIRST_SEED
from mesoscale.inputs.table import from_rows
from mesoscale.uncertainty.designs import random_runs
from workflow.files.results import load_csv, write_csv
from workflow.run.contact_settings import contact_settings
from workflow.run.job import job

with job(snakemake) as run:
    table = from_rows(load_csv(snakemake.input.inputs))
    runs = random_runs(table, *snakemake.params.bounds, first_surface=FIRST_SEED)
    contact = contact_settings(snakemake.params.contact, snakemake)
    write_csv(snakemake.output[0], observe_runs(runs, contact, run.progress))
